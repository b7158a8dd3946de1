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
  let t1 = r22 * 0.333
  let t2 = r02 * px + r12 * py + r22 * pz
  let t3 = sin(free0)
  let t4 = 0.333 * r21 - (px * r01 + py * r11 + pz * r21)
  let t5 = 0.088 + (t0 * (t1 - t2) + t3 * t4)
  let t6 = t0 * t4 + t3 * (t2 - t1)
  let t7 = px * r00 + py * r10 + pz * r20 - 0.333 * r20 + -0.10699999999999987
  let t8 = r22 * t0 + r21 * t3
  let t9 = r22 * t3 - r21 * t0
  let t10 = r02 * t0 + r01 * t3
  let t11 = r01 * t0 - r02 * t3
  circle(0.22907549999999993, -0.11549999999999999, t5 * t5 + t6 * t6 + t7 * t7 - 0.26092449999999995) -> c4 s4 {
    let t14 = 0.0825 + -0.0825 * c4 + -0.316 * s4
    let t15 = -0.3839999999999999 + c4 * -0.316 + 0.0825 * s4
    let t16 = t7 * t15
    let t17 = t5 * t15
    circle(0.0, -t14, t6) -> c5 s5 {
      let t20 = t14 * c5
      let t21 = s5 * t9
      let t22 = c5 * t9
      let t23 = s5 * t11
      let t24 = c5 * t11
      align(t5 * t20 + t16, t17 - t7 * t20) -> c6 s6 {
        # what is left of the rotation for the wrist
        # the angle between the first and the last axis of the wrist
        let t27 = r20 * s6 + c6 * t8
        let t28 = c5 * t27 + t21
        let t29 = r20 * c6 - s6 * t8
        let t30 = t22 - s5 * t27
        let t31 = c4 * t28 + s4 * t29
        let t32 = r00 * s6 + c6 * t10
        let t33 = c5 * t32
        let t34 = c4 * (t33 - t23)
        let t35 = s6 * t10 - r00 * c6
        let t36 = s4 * t35
        let t37 = t34 - t36
        let t38 = s5 * t32 + t24
        let t39 = s4 * (t23 - t33) - c4 * t35
        let t40 = t36 - t34
        half(s4 * t28 - c4 * t29, sqrt(t30 * t30 + t31 * t31)) -> c2 s2 {
          let t43 = s2 * t39
          align(-(t31 * s2), -(t30 * s2)) -> c3 s3 {
            let t46 = c3 * t37
            let t47 = s3 * t38
            let t48 = s3 * t40
            let t49 = c3 * t38
            align(c2 * (t46 - t47) - t43, t48 - t49) -> c1 s1 {
              emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6) angle(t0, t3)
            }
            zero(s2, 1e-11) {
            } else {
              let t52 = -s2
              let t53 = -c3
              let t54 = -s3
              align(t43 + c2 * (t47 - t46), t49 - t48) -> c1_2 s1_2 {
                emit angle(c1_2, s1_2) angle(c2, t52) angle(t53, t54) angle(c4, s4) angle(c5, s5) angle(c6, s6) angle(t0, t3)
              }
            }
          }
        }
      }
    }
  }
}
