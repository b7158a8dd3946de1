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
  let t1 = 0.088 + (r22 * 0.333 - (r02 * px + r12 * py + r22 * pz))
  let t2 = sin(free0)
  let t3 = 0.333 * r21 - (px * r01 + py * r11 + pz * r21)
  let t4 = 0.088 + (t0 * (t1 - 0.088) + t2 * t3)
  let t5 = t0 * t3 + t2 * (0.088 - t1)
  let t6 = 1.033 + (0.926 + (px * r00 + py * r10 + pz * r20 - 0.333 * r20) - 1.033) - 1.033
  let t7 = r22 * t0 + r21 * t2
  let t8 = r22 * t2 - r21 * t0
  let t9 = r02 * t0 + r01 * t2
  let t10 = r01 * t0 - r02 * t2
  circle(0.22907549999999993, -0.11549999999999999, t4 * t4 + t5 * t5 + t6 * t6 - 0.26092449999999995) -> c4 s4 {
    let t13 = 0.0825 + -0.0825 * c4 + -0.316 * s4
    let t14 = -0.3839999999999999 + c4 * -0.316 + 0.0825 * s4
    let t15 = t6 * t14
    let t16 = t4 * t14
    circle(0.0, -t13, t5) -> c5 s5 {
      let t19 = t13 * c5
      let t20 = s5 * t8
      let t21 = c5 * t8
      let t22 = s5 * t10
      let t23 = c5 * t10
      align(t4 * t19 + t15, t16 - t6 * t19) -> c6 s6 {
        # what is left of the rotation for the wrist
        # the angle between the first and the last axis of the wrist
        let t26 = r20 * s6 + c6 * t7
        let t27 = c5 * t26 + t20
        let t28 = r20 * c6 - s6 * t7
        let t29 = t21 - s5 * t26
        let t30 = c4 * t27 + s4 * t28
        let t31 = r00 * s6 + c6 * t9
        let t32 = c5 * t31
        let t33 = c4 * (t32 - t22)
        let t34 = s6 * t9 - r00 * c6
        let t35 = s4 * t34
        let t36 = t33 - t35
        let t37 = s5 * t31 + t23
        let t38 = s4 * (t22 - t32) - c4 * t34
        let t39 = t35 - t33
        half(s4 * t27 - c4 * t28, sqrt(t29 * t29 + t30 * t30)) -> c2 s2 {
          let t42 = s2 * t38
          align(-(t30 * s2), -(t29 * s2)) -> c3 s3 {
            let t45 = c3 * t36
            let t46 = s3 * t37
            let t47 = s3 * t39
            let t48 = c3 * t37
            align(c2 * (t45 - t46) - t42, t47 - t48) -> c1 s1 {
              emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6) angle(t0, t2)
            }
            zero(s2, 1e-11) {
            } else {
              let t51 = -s2
              let t52 = -c3
              let t53 = -s3
              align(t42 + c2 * (t46 - t45), t48 - t47) -> c1_2 s1_2 {
                emit angle(c1_2, s1_2) angle(c2, t51) angle(t52, t53) angle(c4, s4) angle(c5, s5) angle(c6, s6) angle(t0, t2)
              }
            }
          }
        }
      }
    }
  }
}
