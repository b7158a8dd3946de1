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
  let t3 = sqrt(t2)
  let t4 = 1e-5 - t3
  doubt(t4, 0.00064)
  let t5 = pz + (-1e-5 * r21 + -0.08 * r22)
  let t6 = t5 - 0.4
  let t7 = -0.0147 + -0.5 * (0.000625 + (t2 + t6 * t6))
  let t8 = t0 * 0.025
  let t9 = t1 * 0.025
  let t10 = 0.4 - t5
  let t11 = -0.455 * t10
  let t12 = t11 * t11
  let t13 = min(1.0, sqrt(max(t4, t3 - 1e-5)))
  circle(-t1, -t0, -1e-5) -> c1 s1 {
    let t16 = t7 + c1 * t8
    let t17 = s1 * t9
    let t18 = t16 - t17
    let t19 = max(t18, t17 - t16)
    let t20 = -0.025 + t0 * c1 - t1 * s1
    let t21 = -0.455 * t20
    let t22 = sqrt(t21 * t21 + t12)
    let t23 = t19 - t22
    doubt(t23, 0.00064)
    doubt(t23 * t13, 4e-5)
    let t24 = r12 * s1
    let t25 = r02 * c1
    let t26 = t24 - t25
    let t27 = t25 - t24
    let t28 = r12 * c1 + r02 * s1
    let t29 = t28 * t28
    let t30 = t13 * min(1.0, sqrt(max(t23, t22 - t19)))
    let t31 = r11 * c1 + r01 * s1
    let t32 = r11 * s1
    let t33 = r01 * c1
    let t34 = t32 - t33
    let t35 = t33 - t32
    circle(t21, t11, t18) -> c2 s2 {
      let t38 = -0.455 + (t20 * c2 + t10 * s2)
      let t39 = t6 * c2 + t20 * s2
      let t40 = r22 * s2 + c2 * t26
      let t41 = r22 * c2 + s2 * t27
      let t42 = r21 * c2 - s2 * t34
      let t43 = r21 * s2
      let t44 = c2 * t35
      let t45 = t43 - t44
      let t46 = t44 - t43
      align(0.42 * t38 + 0.035 * t39, t38 * 0.035 - 0.42 * t39) -> c3 s3 {
        # what is left of the rotation for the wrist
        # the angle between the first and the last axis of the wrist
        let t49 = s3 * t40 - c3 * t41
        let t50 = sqrt(t49 * t49 + t29)
        let t51 = t50 * t50
        doubt(t51, 0.00128)
        doubt(t51 * t30, 8e-5)
        let t52 = c3 * t42 - s3 * t45
        let t53 = s3 * t42 - c3 * t46
        half(-(t40 * c3 + s3 * t41), t50) -> c5 s5 {
          let t56 = s5 * t53
          align(t49 * s5, -(t28 * s5)) -> c4 s4 {
            align(c4 * t31 - s4 * t52, t56 - c5 * (c4 * t52 + t31 * s4)) -> c6 s6 {
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
    six(0.0, 0.0, -1.0, 0.0, 0.0, 0.4, 0.0, 1.0, 0.0, 0.025, 0.0, 0.4, 0.0, 1.0, 0.0, 0.48, 0.0, 0.4, -1.0, 0.0, 0.0, 0.9, 0.0, 0.435, 0.0, 1.0, 0.0, 0.9, 0.0, 0.435, -1.0, 0.0, 0.0, 0.98, 2e-5, 0.435, r02, r01, -r00, r12, r11, -r10, r22, r21, -r20, px + (0.435 * r00 + r01 * -2e-5 + r02 * -0.98), py + (0.435 * r10 + r11 * -2e-5 + r12 * -0.98), pz + (0.435 * r20 + r21 * -2e-5 + r22 * -0.98), 4.0, 8.0, 0.0, 20.0, 8.0, 0.0, 23.0, 8.0, 0.0) -> c1_2 s1_2 c2_2 s2_2 c3_2 s3_2 c4_2 s4_2 c5_2 s5_2 c6_2 s6_2 {
      emit angle(c1_2, s1_2) angle(c2_2, s2_2) angle(c3_2, s3_2) angle(c4_2, s4_2) angle(c5_2, s5_2) angle(c6_2, s6_2)
    }
  }
}
