ikgen 1
class "5R spherical wrist, axes 2 and 3 parallel, completed to 6R"
variables 5
free []
snap 0.0
slack 0.0
{
  # the place of the wrist centre
  # axes parallel: the height along them does not depend on the turn of the second
  let t0 = py + r12 * -0.17099999999999999
  let t1 = px + -0.17099999999999999 * r02
  let t2 = pz + -0.17099999999999999 * r22
  let t3 = 0.2 - t2
  let t4 = t2 - 0.2
  let t5 = -0.19 * t3
  let t6 = -0.008389499999999998 + -0.5 * (t1 * t1 + t0 * t0 + t4 * t4)
  circle(-t0, t1, 0.0) -> c1 s1 {
    let t9 = t1 * c1 + t0 * s1
    let t10 = c1 * r00 + s1 * r10
    let t11 = s1 * r00 - c1 * r10
    let t12 = r02 * c1 + r12 * s1
    let t13 = r12 * c1 - r02 * s1
    circle(-0.19 * t9, t5, t6) -> c2 s2 {
      let t16 = c2 * r20 + s2 * t10
      let t17 = c2 * t10
      let t18 = r20 * s2
      let t19 = t17 - t18
      let t20 = t18 - t17
      let t21 = c2 * t12
      let t22 = r22 * s2
      let t23 = t21 - t22
      let t24 = r22 * c2 + s2 * t12
      let t25 = t22 - t21
      align(0.139 * (-0.19 + (t9 * c2 + t3 * s2)), -(0.139 * (t4 * c2 + t9 * s2))) -> c3 s3 {
        # what is left of the rotation for the wrist
        # the angle between the first and the last axis of the wrist
        let t28 = c3 * t16 + s3 * t19
        let t29 = t16 * s3 + c3 * t20
        let t30 = c3 * t23
        let t31 = s3 * t24
        let t32 = t30 - t31
        let t33 = c3 * t24 - s3 * t25
        let t34 = t31 - t30
        half(t11, sqrt(t28 * t28 + t29 * t29)) -> c5 s5 {
          let t37 = s5 * t13
          let t38 = -c5
          align(-(t28 * s5), t29 * s5) -> c4 s4 {
            let t41 = c4 * t32
            let t42 = s4 * t33
            let t43 = s4 * t34
            let t44 = c4 * t33
            align(t41 - t42, t37 + c5 * (t43 - t44)) -> c6 s6 {
              zero(1.0 - c6, 0.001) {
                emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(s5, t38)
              } else {
              }
            }
            zero(s5, 1e-11) {
            } else {
              align(t42 - t41, c5 * (t44 - t43) - t37) -> c6_2 s6_2 {
                zero(1.0 - c6_2, 0.001) {
                  emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(-c4, -s4) angle(-s5, t38)
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
