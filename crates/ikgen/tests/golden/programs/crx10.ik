ikgen 1
class "6R offset wrist, axes 1 to 4 in a plane"
variables 6
free []
snap 0.0
slack 0.0
{
  # the centre of axes 5 and 6, and axis 5 on the circle round it
  # joint 6: axis 4, from the elbow to the wrist, at a right angle to axis 5
  let t0 = px + r02 * -0.15999999999999992
  let t1 = 0.7142857142857143 * t0
  let t2 = py + -0.15999999999999992 * r12
  let t3 = 0.7142857142857143 * t2
  let t4 = pz + -0.15999999999999992 * r22 - 0.245
  let t5 = 0.7142857142857143 * t4
  let t6 = r01 * t1 + r11 * t3 + r21 * t5
  let t7 = t6 * t6
  let t8 = t1 * r00 + t3 * r10 + t5 * r20
  let t9 = t8 * t8
  let t10 = 0.011479591836734693 + 0.5 * (t7 + t9)
  let t11 = t1 * t1 + t3 * t3 + t5 * t5
  let t12 = -0.09693877551020402 + t11
  let t13 = t4 * 0.5510204081632654
  let t14 = t12 - t13
  let t15 = t12 + t13
  let t16 = t8 * -0.21428571428571427
  let t17 = r20 * -0.0826530612244898
  let t18 = t16 - t17
  let t19 = t16 + t17
  let t20 = t18 * t19
  let t21 = r21 * -0.0826530612244898
  let t22 = t6 * -0.21428571428571427
  let t23 = t21 - t22
  let t24 = t21 + t22
  let t25 = t23 * t24
  let t26 = t14 * t15 + 0.5 * (t20 - t25)
  let t27 = t8 * -0.10714285714285714
  let t28 = t27 + t27
  let t29 = t19 * t14 + t18 * t15
  let t30 = t28 * t29
  let t31 = t6 * -0.10714285714285714
  let t32 = t31 + t31
  let t33 = t23 * t15 - t24 * t14
  let t34 = t32 * t33
  let t35 = 0.5 * (t7 - t9)
  let t36 = 0.5 * (t20 + t25)
  let t37 = t35 * t36
  let t38 = t6 * t8
  let t39 = 0.5 * (t38 + t38)
  let t40 = 0.5 * (t19 * t23 - t18 * t24)
  let t41 = t39 * t40
  let t42 = t11 + -0.00326530612244897
  let t43 = t11 + -0.7857142857142856
  let t44 = t22 * t22
  let t45 = t16 * t16
  let t46 = t42 * t43 + 0.5 * (t44 + t45)
  let t47 = t11 - 0.011479591836734693
  let t48 = t4 * -1.4285714285714286
  let t49 = r21 * t47 + t6 * t48
  let t50 = r21 * t49
  let t51 = r20 * t47 + t8 * t48
  let t52 = r20 * t51
  let t53 = 0.5 * (t50 + t52)
  let t54 = t22 * t42 + t22 * t43
  let t55 = t4 * 0.15306122448979592
  let t56 = r21 * t55
  let t57 = t54 * t56
  let t58 = t16 * t42 + t16 * t43
  let t59 = r20 * t55
  let t60 = t58 * t59
  let t61 = 0.5 * (t44 - t45)
  let t62 = 0.5 * (t50 - t52)
  let t63 = t61 * t62
  let t64 = t16 * t22
  let t65 = 0.5 * (t64 + t64)
  let t66 = 0.5 * (r21 * t51 + r20 * t49)
  let t67 = t65 * t66
  let t68 = t32 * t36
  let t69 = t28 * t40
  let t70 = t33 * t35
  let t71 = t29 * t39
  let t72 = t54 * t62
  let t73 = t58 * t66
  let t74 = t56 * t61
  let t75 = t59 * t65
  let t76 = t28 * t36
  let t77 = t32 * t40
  let t78 = t29 * t35
  let t79 = t33 * t39
  let t80 = t54 * t66
  let t81 = t58 * t62
  let t82 = t56 * t65
  let t83 = t59 * t61
  octic(t10 * t26 + 0.5 * (t30 - t34) - 0.5 * (t37 + t41) + (t46 * t53 + 0.5 * (t57 + t60) + 0.5 * (t63 + t67)), t33 * t10 - t32 * t26 + 0.5 * (t68 + t69) + 0.5 * (t70 - t71) - (t56 * t46 + t54 * t53 + 0.5 * (t72 + t73) + 0.5 * (t74 + t75)), t29 * t10 + t28 * t26 + 0.5 * (t76 - t77) - 0.5 * (t78 + t79) + (t59 * t46 + t58 * t53 + 0.5 * (t80 - t81) + 0.5 * (t82 - t83)), t35 * t26 - (t36 * t10 + 0.5 * (t30 + t34)) + (t62 * t46 + 0.5 * (t57 - t60) + t61 * t53), t40 * t10 + 0.5 * (t28 * t33 - t29 * t32) - t39 * t26 - (t66 * t46 + 0.5 * (t54 * t59 + t56 * t58) + t65 * t53), 0.5 * (t68 - t69) + 0.5 * (t70 + t71) + (0.5 * (t73 - t72) + 0.5 * (t75 - t74)), 0.5 * (t78 - t79) - 0.5 * (t76 + t77) + (0.5 * (t80 + t81) + 0.5 * (t82 + t83)), 0.5 * (t41 - t37) + 0.5 * (t63 - t67), 0.5 * (t35 * t40 + t36 * t39) - 0.5 * (t61 * t66 + t62 * t65)) -> c6 s6 {
    # the triangle of shoulder, elbow and wrist: joint 3
    let t86 = r00 * s6 - r01 * c6
    let t87 = t0 + -0.15 * t86
    let t88 = r10 * s6
    let t89 = r11 * c6
    let t90 = t88 - t89
    let t91 = t2 + -0.15 * t90
    let t92 = t87 * t87 + t91 * t91
    let t93 = r20 * s6 - r21 * c6
    let t94 = t4 + -0.15 * t93
    let t95 = 0.5102040816326531 * t92
    let t96 = t89 - t88
    circle(0.0, 0.7668, t92 + t94 * t94 - 0.7957000000000001) -> c3 s3 {
      let t99 = 0.71 + 0.54 * s3
      let t100 = t94 * t99
      let t101 = 0.54 * c3
      let t102 = t94 * t101
      zero(t95, 1e-8) {
        # the wrist is above or below the shoulder: joint 1 from the right angle of axes 4 and 5
        align(t100, -t102) -> c2 s2 {
          let t105 = c3 * c2 + s3 * s2
          let t106 = t93 * (c3 * s2 - s3 * c2)
          circle(-(t86 * t105), -(t90 * t105), -t106) -> c1 s1 {
            zero(t106 - (t86 * (t105 * c1) + t90 * (t105 * s1)), 0.003) {
              # what is left of the rotation: joints 4 and 5
              let t109 = s1 * t96
              let t110 = t86 * c1
              let t111 = r02 * c1 + r12 * s1
              let t112 = r22 * c2 + s2 * t111
              let t113 = r22 * s2 - c2 * t111
              let t114 = s3 * t112 - c3 * t113
              let t115 = r12 * c1 - r02 * s1
              let t116 = c3 * t112 + s3 * t113
              align(t86 * s1 - t90 * c1, c3 * (t93 * c2 - s2 * (t109 - t110)) - s3 * (c2 * (t110 - t109) - t93 * s2)) -> c4 s4 {
                align(t114, s4 * t115 + c4 * t116) -> c5 s5 {
                  emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
                }
              }
            } else {
            }
          }
        }
      } else {
      }
      zero(t95, 1e-20) {
      } else {
        # the plane of the arm through the wrist: joint 1
        circle(t91, -t87, 0.0) -> c1_2 s1_2 {
          let t123 = t87 * c1_2 + t91 * s1_2
          align(t100 + t101 * t123, t99 * t123 - t102) -> c2_2 s2_2 {
            let t126 = c3 * c2_2 + s3 * s2_2
            zero(t93 * (c3 * s2_2 - s3 * c2_2) - (t86 * (c1_2 * t126) + t90 * (s1_2 * t126)), 0.003) {
              # what is left of the rotation: joints 4 and 5
              let t127 = t96 * s1_2
              let t128 = t86 * c1_2
              let t129 = r02 * c1_2 + r12 * s1_2
              let t130 = r22 * c2_2 + s2_2 * t129
              let t131 = r22 * s2_2 - c2_2 * t129
              let t132 = s3 * t130 - c3 * t131
              let t133 = r12 * c1_2 - r02 * s1_2
              let t134 = c3 * t130 + s3 * t131
              align(t86 * s1_2 - t90 * c1_2, c3 * (t93 * c2_2 - s2_2 * (t127 - t128)) - s3 * (c2_2 * (t128 - t127) - t93 * s2_2)) -> c4_2 s4_2 {
                align(t132, s4_2 * t133 + c4_2 * t134) -> c5_2 s5_2 {
                  emit angle(c1_2, s1_2) angle(c2_2, s2_2) angle(c3, s3) angle(c4_2, s4_2) angle(c5_2, s5_2) angle(c6, s6)
                }
              }
            } else {
            }
          }
        }
      }
    }
  }
}
