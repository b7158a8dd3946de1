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
    let t21 = s3 * -0.7000000000000001
    let t22 = -0.10000000000000009 + t21
    let t23 = c3 * 0.7000000000000001
    let t24 = -0.7000000000000001 + t23
    let t25 = r00 * t22
    let t26 = r10 * t22
    let t27 = r20 * t22
    let t28 = -0.10000000000000009 - t21
    let t29 = 0.4999999999999998 - t23
    let t30 = r00 * t28
    let t31 = r10 * t28
    let t32 = r20 * t28
    let t33 = -0.8 * c3 + s3 * 0.1
    let t34 = -0.09999999999999998 + t33
    let t35 = c3 * -0.1 + -0.8 * s3
    let t36 = -0.6000000000000001 - t35
    let t37 = -1.3000000000000003 - t33
    let t38 = -0.6000000000000001 + t35
    let t39 = 0.5 * (t34 * t34 + t36 * t36 - (t37 * t37 + t38 * t38))
    let t40 = t23 + -0.7000000000000002
    let t41 = r00 * t40
    let t42 = r10 * t40
    let t43 = r20 * t40
    let t44 = 0.4999999999999999 - t23
    let t45 = r00 * t44
    let t46 = r10 * t44
    let t47 = r20 * t44
    let t48 = -0.7000000000000001 + t35
    let t49 = t48 * t48 + t33 * t33
    let t50 = -0.7000000000000001 - t35
    let t51 = -1.2000000000000002 - t33
    let t52 = t50 * t50 + t51 * t51
    let t53 = 0.5 * (t49 - t52)
    let t54 = 0.5 * (t49 + t52)
    align(t6 * (t4 * s3), t6 * (t1 * s3)) -> c1 s1 {
      # joint 4: two equations in its cosine and sine
      let t57 = c1 * 0.8 - 0.8
      let t58 = 0.8 * s1
      let t59 = t57 * t57 + t58 * t58
      let t60 = -0.6000000000000001 * c1 - 0.8
      let t61 = -0.6000000000000001 * s1
      let t62 = 1.4400000000000004 + (t60 * t60 + t61 * t61)
      let t63 = 0.5 * (t59 - t62)
      let t64 = 0.7000000000000001 * c1 - 0.8
      let t65 = 0.7000000000000001 * s1
      let t66 = c1 * -0.5000000000000001 - 0.8
      let t67 = s1 * -0.5000000000000001
      let t68 = 0.5 * (1.6800000000000002 + (t64 * t64 + t65 * t65 - (t66 * t66 + t67 * t67)))
      let t69 = 0.5 * (t59 + t62)
      align(0.5 * (c1 * r11 - s1 * r01), 0.5 * (c1 * r12 - s1 * r02)) -> c4 s4 {
        # joint 2: two equations in its cosine and sine
        let t72 = s4 * t24
        let t73 = t24 * c4
        let t74 = px + (r02 * t73 + (t25 - r01 * t72)) - 0.8
        let t75 = py + (r12 * t73 + (t26 - r11 * t72))
        let t76 = pz + (t73 * r22 + (t27 - t72 * r21)) - 1.1
        let t77 = t74 * t74 + t75 * t75 + t76 * t76
        let t78 = s4 * t29
        let t79 = c4 * t29
        let t80 = px + (r02 * t79 + (t30 - r01 * t78)) - 0.8
        let t81 = py + (r12 * t79 + (t31 - r11 * t78))
        let t82 = pz + (r22 * t79 + (t32 - r21 * t78)) - 1.1
        let t83 = t80 * t80 + t81 * t81 + t82 * t82
        let t84 = t63 - 0.5 * (t77 - t83)
        let t85 = -0.9000000000000001 * s4
        let t86 = -0.9000000000000001 * c4
        let t87 = px + (r02 * t86 + (t7 - r01 * t85))
        let t88 = py + (r12 * t86 + (t8 - r11 * t85))
        let t89 = c1 * t87 + s1 * t88 - 0.8
        let t90 = c1 * t88 - s1 * t87
        let t91 = pz + (r22 * t86 + (t9 - r21 * t85)) - 1.1
        let t92 = 0.7 * s4
        let t93 = 0.7 * c4
        let t94 = px + (r02 * t93 + (t10 - r01 * t92))
        let t95 = py + (r12 * t93 + (t11 - r11 * t92))
        let t96 = c1 * t94 + s1 * t95 - 0.8
        let t97 = c1 * t95 - s1 * t94
        let t98 = pz + (r22 * t93 + (t12 - r21 * t92)) - 1.1
        let t99 = t39 - 0.5 * (t89 * t89 + t90 * t90 + t91 * t91 - (t96 * t96 + t97 * t97 + t98 * t98))
        let t100 = t28 * s4
        let t101 = t28 * c4
        let t102 = px + (r02 * t101 + (t41 - r01 * t100)) - 0.8
        let t103 = py + (r12 * t101 + (t42 - r11 * t100))
        let t104 = pz + (r22 * t101 + (t43 - r21 * t100)) - 1.1
        let t105 = t22 * s4
        let t106 = t22 * c4
        let t107 = px + (r02 * t106 + (t45 - r01 * t105)) - 0.8
        let t108 = py + (r12 * t106 + (t46 - r11 * t105))
        let t109 = pz + (r22 * t106 + (t47 - r21 * t105)) - 1.1
        let t110 = t68 - 0.5 * (t102 * t102 + t103 * t103 + t104 * t104 - (t107 * t107 + t108 * t108 + t109 * t109))
        let t111 = -0.8 * s4
        let t112 = -0.8 * c4
        let t113 = px + (r02 * t112 + (t13 - r01 * t111))
        let t114 = py + (r12 * t112 + (t14 - r11 * t111))
        let t115 = c1 * t113 + s1 * t114 - 0.8
        let t116 = c1 * t114 - s1 * t113
        let t117 = pz + (r22 * t112 + (t15 - r21 * t111)) - 1.1
        let t118 = t115 * t115 + t116 * t116 + t117 * t117
        let t119 = 0.5999999999999999 * s4
        let t120 = 0.5999999999999999 * c4
        let t121 = px + (r02 * t120 + (t16 - r01 * t119))
        let t122 = py + (r12 * t120 + (t17 - r11 * t119))
        let t123 = c1 * t121 + s1 * t122 - 0.8
        let t124 = c1 * t122 - s1 * t121
        let t125 = pz + (r22 * t120 + (t18 - r21 * t119)) - 1.1
        let t126 = t123 * t123 + t124 * t124 + t125 * t125
        let t127 = t53 - 0.5 * (t118 - t126)
        let t128 = (t84 * t99 - t110 * t127) / max(1e-30, t84 * t84 + t110 * t110 + t127 * t127 + t99 * t99)
        let t129 = 0.5 * (t77 + t83) - t69
        let t130 = 0.5 * (t118 + t126) - t54
        align(t128 * (t99 * t129 - t110 * t130), t128 * (t84 * t130 - t127 * t129)) -> c2 s2 {
          emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4)
        }
      }
    }
  }
}
