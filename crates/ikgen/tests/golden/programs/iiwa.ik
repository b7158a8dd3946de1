ikgen 1
class "7R spherical shoulder, axes 1 and 2 meeting (from the tip), j7 given"
variables 7
free [6]
snap 0.0
slack 0.0
{
  # the place of the wrist centre
  # axes meet: the distance from their common point does not depend on the turn of the second
  let t0 = cos(free0)
  let t1 = r22 * 0.36 - (r02 * px + r12 * py + r22 * pz)
  let t2 = sin(free0)
  let t3 = px * r01 + py * r11 + pz * r21
  let t4 = 0.36 * r21
  let t5 = t0 * t1 + t2 * (t3 - t4)
  let t6 = t0 * (t4 - t3) + t1 * t2
  let t7 = px * r00 + py * r10 + pz * r20 - 0.36 * r20 + 0.1260000000000001
  let t8 = -t6
  let t9 = r21 * t2 - r22 * t0
  let t10 = r21 * t0 + r22 * t2
  let t11 = r02 * t0 - r01 * t2
  let t12 = r01 * t0 + r02 * t2
  circle(0.33599999999999997, 0.0, t5 * t5 + t6 * t6 + t7 * t7 - 0.3363999999999999) -> c4 s4 {
    let t15 = -0.42000000000000004 * s4
    let t16 = -0.3999999999999999 + -0.42000000000000004 * c4
    let t17 = t7 * t16
    let t18 = t5 * t16
    circle(0.0, t15, t8) -> c5 s5 {
      let t21 = t15 * c5
      let t22 = s5 * t10
      let t23 = c5 * t10
      let t24 = s5 * t12
      let t25 = c5 * t12
      align(t5 * t21 + t17, t7 * t21 - t18) -> c6 s6 {
        # what is left of the rotation for the wrist
        # the angle between the first and the last axis of the wrist
        let t28 = r20 * c6 - s6 * t9
        let t29 = r20 * s6 + c6 * t9
        let t30 = c5 * t29 + t22
        let t31 = s5 * t29 - t23
        let t32 = s4 * t28
        let t33 = c4 * t30
        let t34 = t32 - t33
        let t35 = t33 - t32
        let t36 = c6 * t11
        let t37 = r00 * s6
        let t38 = c5 * (t36 - t37)
        let t39 = r00 * c6 + s6 * t11
        let t40 = c4 * (t38 - t24) + s4 * t39
        let t41 = t25 - s5 * (t37 - t36)
        let t42 = c4 * t39 + s4 * (t24 - t38)
        half(-(c4 * t28 + s4 * t30), sqrt(t31 * t31 + t34 * t34)) -> c2 s2 {
          let t45 = s2 * t42
          align(s2 * t35, -(t31 * s2)) -> c3 s3 {
            let t48 = c3 * t40
            let t49 = s3 * t41
            let t50 = c3 * t41 + t40 * s3
            align(c2 * (t48 - t49) - t45, -t50) -> c1 s1 {
              emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6) angle(t0, t2)
            }
            zero(s2, 1e-11) {
            } else {
              let t53 = -s2
              let t54 = -c3
              let t55 = -s3
              align(t45 + c2 * (t49 - t48), t50) -> c1_2 s1_2 {
                emit angle(c1_2, s1_2) angle(c2, t53) angle(t54, t55) angle(c4, s4) angle(c5, s5) angle(c6, s6) angle(t0, t2)
              }
            }
          }
        }
      }
    }
  }
}
