ikgen 1
class "6R spherical shoulder, axes 2 and 3 parallel (from the tip)"
variables 6
free []
snap 0.0
slack 0.0
{
  # the place of the wrist centre
  # axes parallel: the height along them does not depend on the turn of the second
  let t0 = r21 * 0.3
  let t1 = r01 * px + r11 * py + r21 * pz
  let t2 = t0 - t1
  let t3 = 0.3 * r22 - (px * r02 + py * r12 + pz * r22)
  let t4 = t1 - t0
  let t5 = px * r00 + py * r10 + pz * r20 - 0.3 * r20 + 0.16499999999999998
  let t6 = 0.46 * t5
  let t7 = -0.016987500000000016 + -0.5 * (0.0009000000000000016 + (t3 * t3 + t2 * t2 + t5 * t5))
  let t8 = t3 * -0.030000000000000027
  let t9 = -0.030000000000000027 * t4
  circle(t2, t3, 0.0) -> c6 s6 {
    let t12 = 0.030000000000000027 + t3 * c6 + t4 * s6
    let t13 = r01 * s6 - r02 * c6
    let t14 = r01 * c6 + r02 * s6
    let t15 = t14 * t14
    let t16 = r11 * c6 + r12 * s6
    let t17 = r12 * c6 - r11 * s6
    circle(0.46 * t12, t6, t7 + c6 * t8 + s6 * t9) -> c5 s5 {
      let t20 = 0.46 + (t12 * c5 + t5 * s5)
      let t21 = t5 * c5 - t12 * s5
      let t22 = s5 * t13
      let t23 = r00 * c5
      let t24 = r00 * s5 + c5 * t13
      let t25 = t23 - t22
      let t26 = t22 - t23
      let t27 = r10 * c5 + s5 * t17
      let t28 = c5 * t17 - r10 * s5
      align(-0.42 * t20 + -0.03500000000000003 * t21, -0.42 * t21 - t20 * -0.03500000000000003) -> c4 s4 {
        # what is left of the rotation for the wrist
        # the angle between the first and the last axis of the wrist
        let t31 = c4 * t25 - s4 * t24
        let t32 = c4 * t27 + s4 * t28
        let t33 = c4 * t28 - s4 * t27
        half(s4 * t26 - c4 * t24, sqrt(t31 * t31 + t15)) -> c2 s2 {
          let t36 = s2 * t33
          align(-(t31 * s2), t14 * s2) -> c3 s3 {
            let t39 = c3 * t16 + s3 * t32
            let t40 = t16 * s3
            let t41 = c3 * t32
            align(t39, t36 - c2 * (t40 - t41)) -> c1 s1 {
              emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
            }
            zero(s2, 1e-11) {
            } else {
              let t44 = -s2
              let t45 = -c3
              let t46 = -s3
              align(-t39, -(t36 + c2 * (t41 - t40))) -> c1_2 s1_2 {
                emit angle(c1_2, s1_2) angle(c2, t44) angle(t45, t46) angle(c4, s4) angle(c5, s5) angle(c6, s6)
              }
            }
          }
        }
      }
    }
  }
}
