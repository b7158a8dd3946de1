ikgen 1
class "5R one by one, joints in the order 3, 1, 4, 2"
variables 4
free []
snap 0.0
slack 0.0
{
  # joint 3: an equation of which it is the only unknown
  let t0 = py + r10 * -0.10000000000000009
  let t1 = 0.5 * (t0 + t0)
  let t2 = 0.5 * (r10 + r10)
  let t3 = px + -0.10000000000000009 * r00
  let t4 = 0.5 * (t3 + t3)
  let t5 = 0.5 * (r00 + r00)
  let t6 = -(t1 * t2 + t4 * t5) / max(1e-30, t1 * t1 + t4 * t4 + t5 * t5 + t2 * t2)
  let t7 = r00 * -0.8
  let t8 = r10 * -0.8
  let t9 = -0.8 * r20
  let t10 = r00 * 0.5999999999999999
  let t11 = r10 * 0.5999999999999999
  let t12 = r20 * 0.5999999999999999
  let t13 = r00 * 0.7
  let t14 = r10 * 0.7
  let t15 = r20 * 0.7
  let t16 = r00 * -0.9000000000000001
  let t17 = r10 * -0.9000000000000001
  let t18 = r20 * -0.9000000000000001
  circle(1.0, 0.0, -r20) -> c3 s3 {
    # joint 1: two equations in its cosine and sine
    let t21 = 1.1 - s3 * -0.7000000000000001
    let t22 = t21 - 1.1
    let t23 = 1.0 - (1.1 + (1.1 + t22 - 1.1))
    let t24 = 0.1 + c3 * 0.7000000000000001
    let t25 = t24 - 0.7
    let t26 = 0.7 + t25 - 0.8
    let t27 = r00 * t23
    let t28 = r10 * t23
    let t29 = r20 * t23
    let t30 = 1.1 - t21
    let t31 = 1.0 - (1.1 + (1.1 + t30 - 1.1))
    let t32 = 0.7 - t24
    let t33 = 0.7 + t32 - 0.8
    let t34 = r00 * t31
    let t35 = r10 * t31
    let t36 = r20 * t31
    let t37 = 1.1 + (-0.8 * c3 + s3 * 0.1)
    let t38 = t37 - 0.5
    let t39 = 0.1 + t38 - 0.8
    let t40 = 0.1 + (c3 * -0.1 + -0.8 * s3)
    let t41 = 0.1 - t40
    let t42 = 0.5 + t41 - 1.1
    let t43 = 0.5 - t37
    let t44 = 0.1 + t43 - 0.8
    let t45 = t40 - 0.1
    let t46 = 0.5 + t45 - 1.1
    let t47 = 0.5 * (t39 * t39 + t42 * t42 - (t44 * t44 + t46 * t46))
    let t48 = 1.0 - (1.1 + (1.1 + t32 - 1.1))
    let t49 = 0.7 + t22 - 0.8
    let t50 = r00 * t48
    let t51 = r10 * t48
    let t52 = r20 * t48
    let t53 = 1.0 - (1.1 + (1.1 + t25 - 1.1))
    let t54 = 0.7 + t30 - 0.8
    let t55 = r00 * t53
    let t56 = r10 * t53
    let t57 = r20 * t53
    let t58 = 0.1 + t45 - 0.8
    let t59 = 0.5 + t38 - 1.1
    let t60 = t58 * t58 + t59 * t59
    let t61 = 0.1 + t41 - 0.8
    let t62 = 0.5 + t43 - 1.1
    let t63 = t61 * t61 + t62 * t62
    let t64 = 0.5 * (t60 - t63)
    let t65 = 0.5 * (t60 + t63)
    align(t6 * (t4 * s3), t6 * (t1 * s3)) -> c1 s1 {
      # joint 4: two equations in its cosine and sine
      let t68 = 0.8 * c1 - 0.8
      let t69 = 0.8 * s1
      let t70 = t68 * t68 + t69 * t69
      let t71 = c1 * -0.6000000000000001 - 0.8
      let t72 = s1 * -0.6000000000000001
      let t73 = 1.4400000000000004 + (t71 * t71 + t72 * t72)
      let t74 = 0.5 * (t70 - t73)
      let t75 = 0.7000000000000001 * c1 - 0.8
      let t76 = 0.7000000000000001 * s1
      let t77 = c1 * -0.5000000000000001 - 0.8
      let t78 = s1 * -0.5000000000000001
      let t79 = 0.5 * (1.6900000000000002 + (t75 * t75 + t76 * t76) - (0.010000000000000018 + (t77 * t77 + t78 * t78)))
      let t80 = 0.5 * (t70 + t73)
      align(0.5 * (c1 * r11 - s1 * r01), 0.5 * (c1 * r12 - s1 * r02)) -> c4 s4 {
        # joint 2: two equations in its cosine and sine
        let t83 = s4 * t26
        let t84 = -0.8 + (0.8 + t26 * c4)
        let t85 = px + (r02 * t84 + (t27 - r01 * t83)) - 0.8
        let t86 = py + (r12 * t84 + (t28 - r11 * t83))
        let t87 = pz + (t84 * r22 + (t29 - t83 * r21)) - 1.1
        let t88 = t85 * t85 + t86 * t86 + t87 * t87
        let t89 = s4 * t33
        let t90 = -0.8 + (0.8 + c4 * t33)
        let t91 = px + (r02 * t90 + (t34 - r01 * t89)) - 0.8
        let t92 = py + (r12 * t90 + (t35 - r11 * t89))
        let t93 = pz + (r22 * t90 + (t36 - r21 * t89)) - 1.1
        let t94 = t91 * t91 + t92 * t92 + t93 * t93
        let t95 = t74 - 0.5 * (t88 - t94)
        let t96 = -0.9000000000000001 * s4
        let t97 = -0.8 + (0.8 + -0.9000000000000001 * c4)
        let t98 = px + (r02 * t97 + (t7 - r01 * t96))
        let t99 = py + (r12 * t97 + (t8 - r11 * t96))
        let t100 = c1 * t98 + s1 * t99 - 0.8
        let t101 = c1 * t99 - s1 * t98
        let t102 = 0.3 + (pz + (r22 * t97 + (t9 - r21 * t96)) - 0.3) - 1.1
        let t103 = 0.7 * s4
        let t104 = -0.8 + (0.8 + 0.7 * c4)
        let t105 = px + (r02 * t104 + (t10 - r01 * t103))
        let t106 = py + (r12 * t104 + (t11 - r11 * t103))
        let t107 = c1 * t105 + s1 * t106 - 0.8
        let t108 = c1 * t106 - s1 * t105
        let t109 = 0.3 + (pz + (r22 * t104 + (t12 - r21 * t103)) - 0.3) - 1.1
        let t110 = t47 - 0.5 * (t100 * t100 + t101 * t101 + t102 * t102 - (t107 * t107 + t108 * t108 + t109 * t109))
        let t111 = s4 * t49
        let t112 = -0.8 + (0.8 + c4 * t49)
        let t113 = px + (r02 * t112 + (t50 - r01 * t111)) - 0.8
        let t114 = py + (r12 * t112 + (t51 - r11 * t111))
        let t115 = pz + (r22 * t112 + (t52 - r21 * t111)) - 1.1
        let t116 = s4 * t54
        let t117 = -0.8 + (0.8 + c4 * t54)
        let t118 = px + (r02 * t117 + (t55 - r01 * t116)) - 0.8
        let t119 = py + (r12 * t117 + (t56 - r11 * t116))
        let t120 = pz + (r22 * t117 + (t57 - r21 * t116)) - 1.1
        let t121 = t79 - 0.5 * (t113 * t113 + t114 * t114 + t115 * t115 - (t118 * t118 + t119 * t119 + t120 * t120))
        let t122 = -0.8 * s4
        let t123 = -0.8 + (0.8 + -0.8 * c4)
        let t124 = px + (r02 * t123 + (t13 - r01 * t122))
        let t125 = py + (r12 * t123 + (t14 - r11 * t122))
        let t126 = c1 * t124 + s1 * t125 - 0.8
        let t127 = c1 * t125 - s1 * t124
        let t128 = 0.3 + (pz + (r22 * t123 + (t15 - r21 * t122)) - 0.3) - 1.1
        let t129 = t126 * t126 + t127 * t127 + t128 * t128
        let t130 = 0.5999999999999999 * s4
        let t131 = -0.8 + (0.8 + 0.5999999999999999 * c4)
        let t132 = px + (r02 * t131 + (t16 - r01 * t130))
        let t133 = py + (r12 * t131 + (t17 - r11 * t130))
        let t134 = c1 * t132 + s1 * t133 - 0.8
        let t135 = c1 * t133 - s1 * t132
        let t136 = 0.3 + (pz + (r22 * t131 + (t18 - r21 * t130)) - 0.3) - 1.1
        let t137 = t134 * t134 + t135 * t135 + t136 * t136
        let t138 = t64 - 0.5 * (t129 - t137)
        let t139 = (t95 * t110 - t121 * t138) / max(1e-30, t95 * t95 + t121 * t121 + t138 * t138 + t110 * t110)
        let t140 = 0.5 * (t88 + t94) - t80
        let t141 = 0.5 * (t129 + t137) - t65
        align(t139 * (t110 * t140 - t121 * t141), t139 * (t95 * t141 - t138 * t140)) -> c2 s2 {
          emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4)
        }
      }
    }
  }
}
