ikgen 1
class "6R three parallel axes 3-4-5, axes 5 and 6 meeting (from the tip)"
variables 6
free []
snap 0.0
slack 0.0
{
  # height of the meeting point of axes 5 and 6 along the parallel axes: joint 1 alone
  let t0 = r01 * px + r11 * py + r21 * pz
  let t1 = r11 * 0.08
  let t2 = r21 * 0.1
  let t3 = t1 + t2
  let t4 = px * r02 + py * r12 + pz * r22
  let t5 = 0.08 * r12
  let t6 = 0.1 * r22
  let t7 = t5 + t6
  let t8 = r10 * r10
  let t9 = px * r00 + py * r10 + pz * r20
  let t10 = 0.08 * r10
  circle(t0 - t3, t4 - t7, 0.16999999999999998) -> c6 s6 {
    # angle between the parallel axes and axis 6: joint 5
    let t13 = r11 * s6 - r12 * c6
    let t14 = r01 * c6 + r02 * s6
    let t15 = r21 * c6 + r22 * s6
    mirror(r11 * c6 + r12 * s6, sqrt(t13 * t13 + t8)) -> c2 s2 {
      # direction of the parallel axes as seen from the tip: joint 6
      let t18 = r12 * s2
      let t19 = r11 * s2
      let t20 = r10 * s2
      let t21 = -(s2 * t14)
      let t22 = s2 * t15
      first {
        align(t21, t22) -> c1 s1 {
          # the triangle of axes 2, 3 and 4
          let t25 = s1 * -0.1
          let t26 = 0.1 + 0.1 * c1
          let t27 = c6 * (t5 - r02 * t25 + r22 * t26 - t4) - s6 * (t1 - r01 * t25 + r21 * t26 - t0)
          let t28 = 0.09999999999999998 + (t9 - (t10 - r00 * t25 + r20 * t26))
          let t29 = c1 * c2
          let t30 = s1 * c2
          let t31 = c6 * (t18 + r02 * t29 - r22 * t30) - s6 * (t19 + r01 * t29 - r21 * t30)
          let t32 = t20 + r00 * t29
          let t33 = r20 * t30
          let t34 = t32 - t33
          let t35 = t33 - t32
          circle(0.27999999999999997, 0.0, t27 * t27 + t28 * t28 - 0.28250000000000003) -> c4 s4 {
            let t38 = -0.35 + -0.4 * c4
            let t39 = -0.4 * s4
            align(t27 * t38 + t28 * t39, t28 * t38 - t27 * t39) -> c5 s5 {
              let t42 = c5 * t31 - s5 * t34
              let t43 = t31 * s5
              let t44 = c5 * t35
              align(c4 * t42 - s4 * (t43 - t44), c4 * (t44 - t43) - s4 * t42) -> c3 s3 {
                emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
              }
            }
          }
        }
      } else {
        zero(s2 * s2, 1e-6) {
          # axis 6 is parallel too: any value of joint 6 for which axes 2, 3 and 4 close the triangle
          let t47 = c6 * (t7 - t4) - s6 * (t3 - t0)
          let t48 = t6 * c6 - t2 * s6
          let t49 = 0.1 * r20
          let t50 = 0.09999999999999998 + (t9 - (t10 + t49))
          let t51 = 2.0 * (t47 * t48 - t49 * t50)
          let t52 = 2.0 * (t47 * (c6 * (0.1 * r02) - s6 * (r01 * 0.1)) - t50 * (0.1 * r00))
          let t53 = t47 * t47 + t50 * t50 + (t48 * t48 + t49 * t49)
          let t54 = sqrt(t51 * t51 + t52 * t52)
          circle(t51, t52, 0.5 * (max(0.0025000000000000044, t53 - t54) + min(0.5625, t53 + t54)) - t53) -> c1_2 s1_2 {
            # the triangle of axes 2, 3 and 4
            let t57 = -0.1 * s1_2
            let t58 = 0.1 + 0.1 * c1_2
            let t59 = c6 * (t5 - r02 * t57 + r22 * t58 - t4) - s6 * (t1 - r01 * t57 + r21 * t58 - t0)
            let t60 = 0.09999999999999998 + (t9 - (t10 - r00 * t57 + r20 * t58))
            let t61 = c2 * c1_2
            let t62 = c2 * s1_2
            let t63 = c6 * (t18 + r02 * t61 - r22 * t62) - s6 * (t19 + r01 * t61 - r21 * t62)
            let t64 = t20 + r00 * t61
            let t65 = r20 * t62
            let t66 = t64 - t65
            let t67 = t65 - t64
            circle(0.27999999999999997, 0.0, t59 * t59 + t60 * t60 - 0.28250000000000003) -> c4_2 s4_2 {
              let t70 = -0.35 + -0.4 * c4_2
              let t71 = -0.4 * s4_2
              align(t59 * t70 + t60 * t71, t60 * t70 - t59 * t71) -> c5_2 s5_2 {
                let t74 = c5_2 * t63 - s5_2 * t66
                let t75 = t63 * s5_2
                let t76 = c5_2 * t67
                align(c4_2 * t74 - s4_2 * (t75 - t76), c4_2 * (t76 - t75) - s4_2 * t74) -> c3_2 s3_2 {
                  emit angle(c1_2, s1_2) angle(c2, s2) angle(c3_2, s3_2) angle(c4_2, s4_2) angle(c5_2, s5_2) angle(c6, s6)
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
