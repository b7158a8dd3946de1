ikgen 1
class "6R three parallel axes 2-3-4, axes 5 and 6 meeting"
variables 6
free []
snap 0.0
slack 0.0
{
  # height of the meeting point of axes 5 and 6 along the parallel axes: joint 1 alone
  let t0 = r11 * -0.08230000000000001
  let t1 = py + t0
  let t2 = -0.08230000000000001 * r01
  let t3 = px + t2
  let t4 = r21 * r21
  let t5 = -0.08230000000000001 * r21
  circle(t1, -t3, 0.10915) -> c1 s1 {
    # angle between the parallel axes and axis 6: joint 5
    let t8 = r01 * c1 + r11 * s1
    let t9 = c1 * r12 - s1 * r02
    let t10 = s1 * r00 - c1 * r10
    mirror(r11 * c1 - r01 * s1, sqrt(t8 * t8 + t4)) -> c5 s5 {
      # direction of the parallel axes as seen from the tip: joint 6
      let t13 = r01 * s5
      let t14 = r11 * s5
      let t15 = r21 * s5
      let t16 = -(s5 * t9)
      let t17 = -(s5 * t10)
      first {
        align(t16, t17) -> c6 s6 {
          # the triangle of axes 2, 3 and 4
          let t20 = c6 * 0.09465
          let t21 = 0.09465 * s6
          let t22 = c1 * (px + (t2 - r00 * t20 - r02 * t21)) + s1 * (py + (t0 - r10 * t20 - r12 * t21))
          let t23 = pz + (t5 - t20 * r20 - t21 * r22) - 0.089159
          let t24 = s6 * c5
          let t25 = c6 * c5
          let t26 = c1 * (t13 - r00 * t24 + r02 * t25) + s1 * (t14 - r10 * t24 + r12 * t25)
          let t27 = t15 - r20 * t24 + r22 * t25
          circle(0.3334125, 0.0, t22 * t22 + t23 * t23 - 0.3344850625) -> c3 s3 {
            let t30 = 0.425 + 0.39225000000000004 * c3
            let t31 = -0.39225000000000004 * s3
            align(t22 * t30 + t23 * t31, t22 * t31 - t23 * t30) -> c2 s2 {
              let t34 = c2 * t26
              let t35 = s2 * t27
              let t36 = c2 * t27 + t26 * s2
              align(c3 * (t34 - t35) - s3 * t36, s3 * (t35 - t34) - c3 * t36) -> c4 s4 {
                emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
              }
            }
          }
        }
      } else {
        zero(s5 * s5, 1e-6) {
          # axis 6 is parallel too: any value of joint 6 for which axes 2, 3 and 4 close the triangle
          let t39 = t3 * c1 + t1 * s1
          let t40 = c1 * (r00 * -0.09465) + s1 * (r10 * -0.09465)
          let t41 = pz + t5 - 0.089159
          let t42 = r20 * -0.09465
          let t43 = 2.0 * (t39 * t40 + t41 * t42)
          let t44 = 2.0 * (t39 * (c1 * (r02 * -0.09465) + s1 * (r12 * -0.09465)) + t41 * (r22 * -0.09465))
          let t45 = t39 * t39 + t41 * t41 + (t40 * t40 + t42 * t42)
          let t46 = sqrt(t43 * t43 + t44 * t44)
          circle(t43, t44, 0.5 * (max(0.0010725624999999965, t45 - t46) + min(0.6678975625000001, t45 + t46)) - t45) -> c6_2 s6_2 {
            # the triangle of axes 2, 3 and 4
            let t49 = 0.09465 * c6_2
            let t50 = 0.09465 * s6_2
            let t51 = c1 * (px + (t2 - r00 * t49 - r02 * t50)) + s1 * (py + (t0 - r10 * t49 - r12 * t50))
            let t52 = pz + (t5 - r20 * t49 - r22 * t50) - 0.089159
            let t53 = c5 * s6_2
            let t54 = c5 * c6_2
            let t55 = c1 * (t13 - r00 * t53 + r02 * t54) + s1 * (t14 - r10 * t53 + r12 * t54)
            let t56 = t15 - r20 * t53 + r22 * t54
            circle(0.3334125, 0.0, t51 * t51 + t52 * t52 - 0.3344850625) -> c3_2 s3_2 {
              let t59 = 0.425 + 0.39225000000000004 * c3_2
              let t60 = -0.39225000000000004 * s3_2
              align(t51 * t59 + t52 * t60, t51 * t60 - t52 * t59) -> c2_2 s2_2 {
                let t63 = c2_2 * t55
                let t64 = s2_2 * t56
                let t65 = c2_2 * t56 + t55 * s2_2
                align(c3_2 * (t63 - t64) - s3_2 * t65, s3_2 * (t64 - t63) - c3_2 * t65) -> c4_2 s4_2 {
                  emit angle(c1, s1) angle(c2_2, s2_2) angle(c3_2, s3_2) angle(c4_2, s4_2) angle(c5, s5) angle(c6_2, s6_2)
                }
              }
            }
          }
        } else {
        }
      }
    }
  }
}
