ikgen 1
class "4R spherical shoulder, axes 1 and 2 meeting, completed to 6R (from the tip)"
variables 4
free []
snap 0.0
slack 0.0
{
  # the place of the wrist centre
  # axes meet: the distance from their common point does not depend on the turn of the second
  let t0 = r22 * 0.3 - (r02 * px + r12 * py + r22 * pz) - 0.35771
  let t1 = 0.3 * r21 - (px * r01 + py * r11 + pz * r21) - 0.23659
  let t2 = px * r00 + py * r10 + pz * r20 - 0.3 * r20 + 0.47392999999999996
  circle(-0.16317910000000005, -0.35963470000000003, t0 * t0 + t1 * t1 + t2 * t2 - 0.48853901710000003) -> c4 s4 {
    let t5 = 0.17393000000000003 + -0.55 * c4 + -0.045 * s4
    let t6 = -0.31271 + c4 * -0.045 + s4 * 0.55
    let t7 = t0 * t6
    let t8 = t1 * t6
    circle(t5, 0.23659, t2) -> c5 s5 {
      let t11 = -0.23659 * c5 + t5 * s5
      let t12 = r20 * c5
      let t13 = r20 * s5
      let t14 = r00 * c5
      let t15 = r00 * s5
      align(t1 * t11 + t7, t8 - t0 * t11) -> c6 s6 {
        # what is left of the rotation for the wrist
        # the angle between the first and the last axis of the wrist
        let t18 = r21 * c6
        let t19 = r22 * s6
        let t20 = s5 * (t18 - t19)
        let t21 = r22 * c6 + r21 * s6
        let t22 = c5 * (t19 - t18) - t13
        let t23 = c4 * t21 + s4 * (t20 - t12)
        let t24 = r02 * c6 + r01 * s6
        let t25 = c4 * t24
        let t26 = r02 * s6
        let t27 = r01 * c6
        let t28 = s5 * (t26 - t27) + t14
        let t29 = s4 * t28
        let t30 = t25 - t29
        let t31 = c5 * (t27 - t26) + t15
        let t32 = c4 * t28 + s4 * t24
        let t33 = t29 - t25
        let t34 = 2.0 - (c5 + c6)
        half(-(c4 * (t12 - t20) + s4 * t21), sqrt(t22 * t22 + t23 * t23)) -> c2 s2 {
          let t37 = s2 * t32
          align(-(t23 * s2), -(t22 * s2)) -> c3 s3 {
            let t40 = c3 * t30
            let t41 = s3 * t31
            let t42 = s3 * t33
            let t43 = c3 * t31
            align(c2 * (t40 - t41) - t37, t42 - t43) -> c1 s1 {
              zero(t34, 0.001) {
                emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4)
              } else {
              }
            }
            zero(s2, 1e-11) {
            } else {
              align(t37 + c2 * (t41 - t40), t43 - t42) -> c1_2 s1_2 {
                zero(t34, 0.001) {
                  emit angle(c1_2, s1_2) angle(c2, -s2) angle(-c3, -s3) angle(c4, s4)
                } else {
                }
              }
            }
          }
        }
      }
    }
  }
}
