ikgen 1
class "6R spherical wrist, axes 2 and 3 parallel, the rest in general"
variables 6
free []
snap 1e-5
slack 4e-5
{
  # the place of the wrist centre
  # axes parallel: the height along them does not depend on the turn of the second
  let t0 = px + (r01 * -1e-5 + r02 * -0.08)
  let t1 = py + (-1e-5 * r11 + -0.08 * r12)
  let t2 = t0 * t0 + t1 * t1
  doubt(1e-5 - sqrt(t2), 0.00064)
  let t3 = pz + (-1e-5 * r21 + -0.08 * r22)
  let t4 = t3 - 0.4
  let t5 = -0.0147 + -0.5 * (0.000625 + (t2 + t4 * t4))
  let t6 = t0 * 0.025
  let t7 = t1 * 0.025
  let t8 = 0.4 - t3
  let t9 = -0.455 * t8
  let t10 = t9 * t9
  circle(-t1, -t0, -1e-5) -> c1 s1 {
    let t13 = t5 + c1 * t6
    let t14 = s1 * t7
    let t15 = t13 - t14
    let t16 = -0.025 + t0 * c1 - t1 * s1
    let t17 = -0.455 * t16
    doubt(max(t15, t14 - t13) - sqrt(t17 * t17 + t10), 0.00064)
    let t18 = r12 * s1
    let t19 = r02 * c1
    let t20 = t18 - t19
    let t21 = t19 - t18
    let t22 = r12 * c1 + r02 * s1
    let t23 = t22 * t22
    let t24 = r11 * c1 + r01 * s1
    let t25 = r11 * s1
    let t26 = r01 * c1
    let t27 = t25 - t26
    let t28 = t26 - t25
    circle(t17, t9, t15) -> c2 s2 {
      let t31 = -0.455 + (t16 * c2 + t8 * s2)
      let t32 = t4 * c2 + t16 * s2
      let t33 = r22 * s2 + c2 * t20
      let t34 = r22 * c2 + s2 * t21
      let t35 = r21 * c2 - s2 * t27
      let t36 = r21 * s2
      let t37 = c2 * t28
      let t38 = t36 - t37
      let t39 = t37 - t36
      align(0.42 * t31 + 0.035 * t32, t31 * 0.035 - 0.42 * t32) -> c3 s3 {
        # what is left of the rotation for the wrist
        # the angle between the first and the last axis of the wrist
        let t42 = s3 * t33 - c3 * t34
        let t43 = sqrt(t42 * t42 + t23)
        doubt(t43 * t43, 0.00128)
        let t44 = c3 * t35 - s3 * t38
        let t45 = s3 * t35 - c3 * t39
        half(-(t33 * c3 + s3 * t34), t43) -> c5 s5 {
          let t48 = s5 * t45
          align(t42 * s5, -(t22 * s5)) -> c4 s4 {
            align(c4 * t24 - s4 * t44, t48 - c5 * (c4 * t44 + t24 * s4)) -> c6 s6 {
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
  rest {
    # where that gives nothing or leaves a doubt: six joints in general, as they are described
    # the six axes as lines, the goal, and the orders of elimination with their degrees
    six(0.0, 0.0, -1.0, 0.0, 0.0, 0.4, 0.0, 1.0, 0.0, 0.025, 0.0, 0.4, 0.0, 1.0, 0.0, 0.48, 0.0, 0.4, -1.0, 0.0, 0.0, 0.9, 0.0, 0.435, 0.0, 1.0, 0.0, 0.9, 0.0, 0.435, -1.0, 0.0, 0.0, 0.98, 2e-5, 0.435, r02, r01, -r00, r12, r11, -r10, r22, r21, -r20, px + (0.435 * r00 + r01 * -2e-5 + r02 * -0.98), py + (0.435 * r10 + r11 * -2e-5 + r12 * -0.98), pz + (0.435 * r20 + r21 * -2e-5 + r22 * -0.98), 20.0, 7.0, 0.0, 4.0, 8.0, 0.0, 23.0, 8.0, 0.0) -> c1_2 s1_2 c2_2 s2_2 c3_2 s3_2 c4_2 s4_2 c5_2 s5_2 c6_2 s6_2 {
      emit angle(c1_2, s1_2) angle(c2_2, s2_2) angle(c3_2, s3_2) angle(c4_2, s4_2) angle(c5_2, s5_2) angle(c6_2, s6_2)
    }
  }
}
