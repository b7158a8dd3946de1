ikgen 1
class "6R offset wrist, axes 1 to 4 in a plane"
variables 6
free []
snap 0.0
slack 0.0
{
  # the centre of axes 5 and 6, and axis 5 on the circle round it
  let t0 = px + r02 * -0.15999999999999992
  let t1 = 0.8130081300813008 * t0
  let t2 = py + -0.15999999999999992 * r12
  let t3 = 0.8130081300813008 * t2
  let t4 = pz + -0.15999999999999992 * r22 - 0.245
  let t5 = 0.8130081300813008 * t4
  let t6 = r01 * t1 + r11 * t3 + r21 * t5
  let t7 = t6 * t6
  let t8 = t1 * r00 + t3 * r10 + t5 * r20
  let t9 = t8 * t8
  let t10 = t7 + t9
  let t11 = t1 * t1 + t3 * t3 + t5 * t5
  let t12 = 0.014872099940511599 + t11
  let t13 = 0.014872099940511599 + 0.5 * t10
  let t14 = t4 * 0.7138607971445567
  let t15 = t12 - t14
  let t16 = t12 + t14
  let t17 = t8 * -0.24390243902439024
  let t18 = r20 * -0.10707911957168352
  let t19 = t17 - t18
  let t20 = t17 + t18
  let t21 = t19 * t20
  let t22 = r21 * -0.10707911957168352
  let t23 = t6 * -0.24390243902439024
  let t24 = t22 - t23
  let t25 = t22 + t23
  let t26 = t24 * t25
  let t27 = t15 * t16 + 0.5 * (t21 - t26)
  let t28 = t8 * -0.12195121951219512
  let t29 = t28 + t28
  let t30 = t20 * t15 + t19 * t16
  let t31 = t29 * t30
  let t32 = t6 * -0.12195121951219512
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
  let t43 = t11 + -0.7560975609756098
  let t44 = t23 * t23
  let t45 = t17 * t17
  let t46 = t12 * t43 + 0.5 * (t44 + t45)
  let t47 = t11 - 0.014872099940511599
  let t48 = t4 * -1.6260162601626016
  let t49 = r21 * t47 + t6 * t48
  let t50 = r21 * t49
  let t51 = r20 * t47 + t8 * t48
  let t52 = r20 * t51
  let t53 = 0.5 * (t50 + t52)
  let t54 = t12 * t23 + t23 * t43
  let t55 = t4 * 0.19829466587348799
  let t56 = r21 * t55
  let t57 = t54 * t56
  let t58 = t12 * t17 + t17 * t43
  let t59 = r20 * t55
  let t60 = t58 * t59
  let t61 = 0.5 * (t44 - t45)
  let t62 = 0.5 * (t50 - t52)
  let t63 = t61 * t62
  let t64 = t17 * t23
  let t65 = 0.5 * (t64 + t64)
  let t66 = 0.5 * (r21 * t51 + r20 * t49)
  let t67 = t65 * t66
  let t68 = t33 * t37
  let t69 = t29 * t41
  let t70 = t34 * t36
  let t71 = t30 * t40
  let t72 = t54 * t62
  let t73 = t58 * t66
  let t74 = t56 * t61
  let t75 = t59 * t65
  let t76 = t29 * t37
  let t77 = t33 * t41
  let t78 = t30 * t36
  let t79 = t34 * t40
  let t80 = t54 * t66
  let t81 = t58 * t62
  let t82 = t56 * t65
  let t83 = t59 * t61
  let t84 = t13 * t27 + 0.5 * (t31 - t35) - 0.5 * (t38 + t42) + (t46 * t53 + 0.5 * (t57 + t60) + 0.5 * (t63 + t67))
  let t85 = t34 * t13 - t33 * t27 + 0.5 * (t68 + t69) + 0.5 * (t70 - t71) - (t56 * t46 + t54 * t53 + 0.5 * (t72 + t73) + 0.5 * (t74 + t75))
  let t86 = t30 * t13 + t29 * t27 + 0.5 * (t76 - t77) - 0.5 * (t78 + t79) + (t59 * t46 + t58 * t53 + 0.5 * (t80 - t81) + 0.5 * (t82 - t83))
  let t87 = t36 * t27 - (t37 * t13 + 0.5 * (t31 + t35)) + (t62 * t46 + 0.5 * (t57 - t60) + t61 * t53)
  let t88 = t41 * t13 + 0.5 * (t29 * t34 - t30 * t33) - t40 * t27 - (t66 * t46 + 0.5 * (t54 * t59 + t56 * t58) + t65 * t53)
  let t89 = 0.5 * (t68 - t69) + 0.5 * (t70 + t71) + (0.5 * (t73 - t72) + 0.5 * (t75 - t74))
  let t90 = 0.5 * (t78 - t79) - 0.5 * (t76 + t77) + (0.5 * (t80 + t81) + 0.5 * (t82 + t83))
  let t91 = 0.5 * (t42 - t38) + 0.5 * (t63 - t67)
  let t92 = 0.5 * (t36 * t41 + t37 * t40) - 0.5 * (t61 * t66 + t62 * t65)
  first {
    # joint 6: axis 4, from the elbow to the wrist, at a right angle to axis 5
    octic(t84, t85, t86, t87, t88, t89, t90, t91, t92) -> c6 s6 {
      # the triangle of shoulder, elbow and wrist: joint 3
      let t95 = r00 * s6 - r01 * c6
      let t96 = t0 + -0.15 * t95
      let t97 = r10 * s6
      let t98 = r11 * c6
      let t99 = t97 - t98
      let t100 = t2 + -0.15 * t99
      let t101 = t96 * t96 + t100 * t100
      let t102 = r20 * s6 - r21 * c6
      let t103 = t4 + -0.15 * t102
      let t104 = 0.6609822195782933 * t101
      let t105 = t98 - t97
      circle(0.0, 0.5832, t101 + t103 * t103 - 0.5832) -> c3 s3 {
        let t108 = 0.54 + 0.54 * s3
        let t109 = t103 * t108
        let t110 = 0.54 * c3
        let t111 = t103 * t110
        zero(t104, 1e-8) {
          # the wrist is above or below the shoulder: joint 1 from the right angle of axes 4 and 5
          align(t109, -t111) -> c2 s2 {
            let t114 = c3 * c2 + s3 * s2
            let t115 = t102 * (c3 * s2 - s3 * c2)
            circle(-(t95 * t114), -(t99 * t114), -t115) -> c1 s1 {
              zero(t115 - (t95 * (t114 * c1) + t99 * (t114 * s1)), 0.003) {
                # what is left of the rotation: joints 4 and 5
                let t118 = s1 * t105
                let t119 = t95 * c1
                let t120 = r02 * c1 + r12 * s1
                let t121 = r22 * c2 + s2 * t120
                let t122 = r22 * s2 - c2 * t120
                let t123 = s3 * t121 - c3 * t122
                let t124 = r12 * c1 - r02 * s1
                let t125 = c3 * t121 + s3 * t122
                align(t95 * s1 - t99 * c1, c3 * (t102 * c2 - s2 * (t118 - t119)) - s3 * (c2 * (t119 - t118) - t102 * s2)) -> c4 s4 {
                  align(t123, s4 * t124 + c4 * t125) -> c5 s5 {
                    emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
                  }
                }
              } else {
              }
            }
          }
        } else {
        }
        zero(t104, 1e-20) {
        } else {
          # the plane of the arm through the wrist: joint 1
          circle(t100, -t96, 0.0) -> c1_2 s1_2 {
            let t132 = t96 * c1_2 + t100 * s1_2
            align(t109 + t110 * t132, t108 * t132 - t111) -> c2_2 s2_2 {
              let t135 = c3 * c2_2 + s3 * s2_2
              zero(t102 * (c3 * s2_2 - s3 * c2_2) - (t95 * (c1_2 * t135) + t99 * (s1_2 * t135)), 0.003) {
                # what is left of the rotation: joints 4 and 5
                let t136 = t105 * s1_2
                let t137 = t95 * c1_2
                let t138 = r02 * c1_2 + r12 * s1_2
                let t139 = r22 * c2_2 + s2_2 * t138
                let t140 = r22 * s2_2 - c2_2 * t138
                let t141 = s3 * t139 - c3 * t140
                let t142 = r12 * c1_2 - r02 * s1_2
                let t143 = c3 * t139 + s3 * t140
                align(t95 * s1_2 - t99 * c1_2, c3 * (t102 * c2_2 - s2_2 * (t136 - t137)) - s3 * (c2_2 * (t137 - t136) - t102 * s2_2)) -> c4_2 s4_2 {
                  align(t141, s4_2 * t142 + c4_2 * t143) -> c5_2 s5_2 {
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
  } else {
    zero(t12 - 0.24390243902439024 * sqrt(t10), 1e-8) {
      # the wrist may be at the shoulder: joint 6 brings it as near as it can
      align(-t6, t8) -> c6_2 s6_2 {
        # the triangle of shoulder, elbow and wrist: joint 3
        let t150 = r00 * s6_2 - r01 * c6_2
        let t151 = t0 + -0.15 * t150
        let t152 = r10 * s6_2
        let t153 = r11 * c6_2
        let t154 = t152 - t153
        let t155 = t2 + -0.15 * t154
        let t156 = r20 * s6_2 - r21 * c6_2
        let t157 = t4 + -0.15 * t156
        let t158 = t153 - t152
        circle(0.0, 0.5832, t151 * t151 + t155 * t155 + t157 * t157 - 0.5832) -> c3_2 s3_2 {
          # the wrist is at the shoulder: any plane of the arm; joint 2 from the right angle of axes 4 and 5
          let t161 = t156 * s3_2
          let t162 = t156 * c3_2
          align(0.0, 0.0) -> c1_3 s1_3 {
            let t165 = t150 * c1_3
            let t166 = s1_3 * t158
            let t167 = t165 - t166
            circle(-(c3_2 * t167 + t161), t162 - s3_2 * t167, 0.0) -> c2_3 s2_3 {
              let t170 = c3_2 * c2_3 + s3_2 * s2_3
              zero(t156 * (c3_2 * s2_3 - s3_2 * c2_3) - (t150 * (c1_3 * t170) + t154 * (s1_3 * t170)), 0.003) {
                # what is left of the rotation: joints 4 and 5
                let t171 = r02 * c1_3 + r12 * s1_3
                let t172 = r22 * c2_3 + s2_3 * t171
                let t173 = r22 * s2_3 - c2_3 * t171
                let t174 = s3_2 * t172 - c3_2 * t173
                let t175 = r12 * c1_3 - r02 * s1_3
                let t176 = c3_2 * t172 + s3_2 * t173
                align(t150 * s1_3 - t154 * c1_3, c3_2 * (t156 * c2_3 - s2_3 * (t166 - t165)) - s3_2 * (t167 * c2_3 - t156 * s2_3)) -> c4_3 s4_3 {
                  align(t174, s4_3 * t175 + c4_3 * t176) -> c5_3 s5_3 {
                    emit angle(c1_3, s1_3) angle(c2_3, s2_3) angle(c3_2, s3_2) angle(c4_3, s4_3) angle(c5_3, s5_3) angle(c6_2, s6_2)
                  }
                }
              } else {
              }
            }
          }
        }
      }
    } else {
    }
  }
}
