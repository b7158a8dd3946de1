ikgen 1
class "6R spherical wrist, axes 2 and 3 parallel"
variables 6
free []
snap 0.0
slack 0.0
{
  # the place of the wrist centre
  # axes parallel: the height along them does not depend on the turn of the second
  let t0 = py + r12 * -0.07999999999999996
  let t1 = px + -0.07999999999999996 * r02
  let t2 = pz + -0.07999999999999996 * r22
  let t3 = 0.4 - t2
  let t4 = t2 - 0.4
  let t5 = -0.45499999999999996 * t3
  let t6 = -0.014699999999999963 + -0.5 * (0.0006250000000000001 + (t1 * t1 + t0 * t0 + t4 * t4))
  let t7 = t1 * 0.025
  let t8 = t0 * 0.025
  circle(-t0, -t1, 0.0) -> c1 s1 {
    let t11 = -0.025 + t1 * c1 - t0 * s1
    let t12 = r12 * s1
    let t13 = r02 * c1
    let t14 = t12 - t13
    let t15 = t13 - t12
    let t16 = r12 * c1 + r02 * s1
    let t17 = t16 * t16
    let t18 = c1 * r11 + s1 * r01
    let t19 = s1 * r11
    let t20 = c1 * r01
    let t21 = t19 - t20
    let t22 = t20 - t19
    circle(-0.45499999999999996 * t11, t5, t6 + c1 * t7 - s1 * t8) -> c2 s2 {
      let t25 = -0.45499999999999996 + (t11 * c2 + t3 * s2)
      let t26 = t4 * c2 + t11 * s2
      let t27 = r22 * s2 + c2 * t14
      let t28 = r22 * c2 + s2 * t15
      let t29 = c2 * r21 - s2 * t21
      let t30 = s2 * r21
      let t31 = c2 * t22
      let t32 = t30 - t31
      let t33 = t31 - t30
      align(0.42000000000000004 * t25 + 0.034999999999999976 * t26, t25 * 0.034999999999999976 - 0.42000000000000004 * t26) -> c3 s3 {
        # what is left of the rotation for the wrist
        # the angle between the first and the last axis of the wrist
        let t36 = s3 * t27 - c3 * t28
        let t37 = c3 * t29 - s3 * t32
        let t38 = s3 * t29 - c3 * t33
        half(-(t27 * c3 + s3 * t28), sqrt(t36 * t36 + t17)) -> c5 s5 {
          let t41 = s5 * t38
          align(t36 * s5, -(t16 * s5)) -> c4 s4 {
            align(c4 * t18 - s4 * t37, t41 - c5 * (c4 * t37 + t18 * s4)) -> c6 s6 {
              emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
              zero(s5, 1e-11) {
              } else {
                emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(-c4, -s4) angle(c5, -s5) angle(-c6, -s6)
              }
            }
          }
        }
      }
    }
  }
}
