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
  let t12 = 0.011479591836734693 + t11
  let t13 = -0.10841836734693872 + t12
  let t14 = t4 * 0.5510204081632654
  let t15 = t13 - t14
  let t16 = t13 + t14
  let t17 = t8 * -0.21428571428571427
  let t18 = r20 * -0.0826530612244898
  let t19 = t17 - t18
  let t20 = t17 + t18
  let t21 = t19 * t20
  let t22 = r21 * -0.0826530612244898
  let t23 = t6 * -0.21428571428571427
  let t24 = t22 - t23
  let t25 = t22 + t23
  let t26 = t24 * t25
  let t27 = t15 * t16 + 0.5 * (t21 - t26)
  let t28 = t8 * -0.10714285714285714
  let t29 = t28 + t28
  let t30 = t20 * t15 + t19 * t16
  let t31 = t29 * t30
  let t32 = t6 * -0.10714285714285714
  let t33 = t32 + t32
  let t34 = t24 * t16 - t25 * t15
  let t35 = t33 * t34
  let t36 = 0.5 * (t7 - t9)
  let t37 = 0.5 * (t21 + t26)
  let t38 = t36 * t37
  let t39 = t6 * t8
  let t40 = 0.5 * (t39 + t39)
  let t41 = 0.5 * (t20 * t24 - t19 * t25)
  let t42 = t40 * t41
  let t43 = t12 + -0.014744897959183663
  let t44 = t12 + -0.7971938775510203
  let t45 = t23 * t23
  let t46 = t17 * t17
  let t47 = t43 * t44 + 0.5 * (t45 + t46)
  let t48 = t11 - 0.011479591836734693
  let t49 = t4 * -1.4285714285714286
  let t50 = r21 * t48 + t6 * t49
  let t51 = r21 * t50
  let t52 = r20 * t48 + t8 * t49
  let t53 = r20 * t52
  let t54 = 0.5 * (t51 + t53)
  let t55 = t23 * t43 + t23 * t44
  let t56 = t4 * 0.15306122448979592
  let t57 = r21 * t56
  let t58 = t55 * t57
  let t59 = t17 * t43 + t17 * t44
  let t60 = r20 * t56
  let t61 = t59 * t60
  let t62 = 0.5 * (t45 - t46)
  let t63 = 0.5 * (t51 - t53)
  let t64 = t62 * t63
  let t65 = t17 * t23
  let t66 = 0.5 * (t65 + t65)
  let t67 = 0.5 * (r21 * t52 + r20 * t50)
  let t68 = t66 * t67
  let t69 = t33 * t37
  let t70 = t29 * t41
  let t71 = t34 * t36
  let t72 = t30 * t40
  let t73 = t55 * t63
  let t74 = t59 * t67
  let t75 = t57 * t62
  let t76 = t60 * t66
  let t77 = t29 * t37
  let t78 = t33 * t41
  let t79 = t30 * t36
  let t80 = t34 * t40
  let t81 = t55 * t67
  let t82 = t59 * t63
  let t83 = t57 * t66
  let t84 = t60 * t62
  octic(t10 * t27 + 0.5 * (t31 - t35) - 0.5 * (t38 + t42) + (t47 * t54 + 0.5 * (t58 + t61) + 0.5 * (t64 + t68)), t34 * t10 - t33 * t27 + 0.5 * (t69 + t70) + 0.5 * (t71 - t72) - (t57 * t47 + t55 * t54 + 0.5 * (t73 + t74) + 0.5 * (t75 + t76)), t30 * t10 + t29 * t27 + 0.5 * (t77 - t78) - 0.5 * (t79 + t80) + (t60 * t47 + t59 * t54 + 0.5 * (t81 - t82) + 0.5 * (t83 - t84)), t36 * t27 - (t37 * t10 + 0.5 * (t31 + t35)) + (t63 * t47 + 0.5 * (t58 - t61) + t62 * t54), t41 * t10 + 0.5 * (t29 * t34 - t30 * t33) - t40 * t27 - (t67 * t47 + 0.5 * (t55 * t60 + t57 * t59) + t66 * t54), 0.5 * (t69 - t70) + 0.5 * (t71 + t72) + (0.5 * (t74 - t73) + 0.5 * (t76 - t75)), 0.5 * (t79 - t80) - 0.5 * (t77 + t78) + (0.5 * (t81 + t82) + 0.5 * (t83 + t84)), 0.5 * (t42 - t38) + 0.5 * (t64 - t68), 0.5 * (t36 * t41 + t37 * t40) - 0.5 * (t62 * t67 + t63 * t66)) -> c6 s6 {
    # the triangle of shoulder, elbow and wrist: joint 3
    let t87 = r00 * s6 - r01 * c6
    let t88 = t0 + -0.15 * t87
    let t89 = r10 * s6
    let t90 = r11 * c6
    let t91 = t89 - t90
    let t92 = t2 + -0.15 * t91
    let t93 = t88 * t88 + t92 * t92
    let t94 = r20 * s6 - r21 * c6
    let t95 = t4 + -0.15 * t94
    let t96 = 0.5102040816326531 * t93
    let t97 = t90 - t89
    circle(0.0, 0.7668, t93 + t95 * t95 - 0.7957000000000001) -> c3 s3 {
      let t100 = 0.71 + 0.54 * s3
      let t101 = t95 * t100
      let t102 = 0.54 * c3
      let t103 = t95 * t102
      zero(t96, 1e-8) {
        # the wrist is above or below the shoulder: joint 1 from the right angle of axes 4 and 5
        align(t101, -t103) -> c2 s2 {
          let t106 = c3 * c2 + s3 * s2
          let t107 = t94 * (c3 * s2 - s3 * c2)
          circle(-(t87 * t106), -(t91 * t106), -t107) -> c1 s1 {
            zero(t107 - (t87 * (t106 * c1) + t91 * (t106 * s1)), 0.003) {
              # what is left of the rotation: joints 4 and 5
              let t110 = s1 * t97
              let t111 = t87 * c1
              let t112 = r02 * c1 + r12 * s1
              let t113 = r22 * c2 + s2 * t112
              let t114 = r22 * s2 - c2 * t112
              let t115 = s3 * t113 - c3 * t114
              let t116 = r12 * c1 - r02 * s1
              let t117 = c3 * t113 + s3 * t114
              align(t87 * s1 - t91 * c1, c3 * (t94 * c2 - s2 * (t110 - t111)) - s3 * (c2 * (t111 - t110) - t94 * s2)) -> c4 s4 {
                align(t115, s4 * t116 + c4 * t117) -> c5 s5 {
                  emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
                }
              }
            } else {
            }
          }
        }
      } else {
      }
      zero(t96, 1e-20) {
      } else {
        # the plane of the arm through the wrist: joint 1
        circle(t92, -t88, 0.0) -> c1_2 s1_2 {
          let t124 = t88 * c1_2 + t92 * s1_2
          align(t101 + t102 * t124, t100 * t124 - t103) -> c2_2 s2_2 {
            let t127 = c3 * c2_2 + s3 * s2_2
            zero(t94 * (c3 * s2_2 - s3 * c2_2) - (t87 * (c1_2 * t127) + t91 * (s1_2 * t127)), 0.003) {
              # what is left of the rotation: joints 4 and 5
              let t128 = t97 * s1_2
              let t129 = t87 * c1_2
              let t130 = r02 * c1_2 + r12 * s1_2
              let t131 = r22 * c2_2 + s2_2 * t130
              let t132 = r22 * s2_2 - c2_2 * t130
              let t133 = s3 * t131 - c3 * t132
              let t134 = r12 * c1_2 - r02 * s1_2
              let t135 = c3 * t131 + s3 * t132
              align(t87 * s1_2 - t91 * c1_2, c3 * (t94 * c2_2 - s2_2 * (t128 - t129)) - s3 * (c2_2 * (t129 - t128) - t94 * s2_2)) -> c4_2 s4_2 {
                align(t133, s4_2 * t134 + c4_2 * t135) -> c5_2 s5_2 {
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
