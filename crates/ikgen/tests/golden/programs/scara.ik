ikgen 1
class "RRPR one by one, joints in the order 3, 2, 4, 1"
variables 4
free []
snap 0.0
slack 0.0
{
  # joint 3: its length
  let t0 = r22 * -0.55
  let t1 = r01 * 0.55
  let t2 = 0.55 * r11
  let t3 = 0.55 * r21
  let t4 = -0.55 * r01
  let t5 = -0.55 * r11
  let t6 = -0.55 * r21
  let t7 = -0.55 * r02
  let t8 = -0.55 * r12
  let t9 = 0.55 * r02
  let t10 = 0.55 * r12
  let t11 = r22 * 0.55
  quadratic(0.0, 1.0, 0.2 - (pz + (r20 * -0.1 + t0))) -> d3 {
    # joint 2: an equation of which it is the only unknown
    let t13 = -0.1 + d3
    let t14 = r00 * t13
    let t15 = px + t14
    let t16 = t13 * r10
    let t17 = py + t16
    let t18 = r20 * t13
    let t19 = pz + t18 - 0.2
    let t20 = px + (t14 + t1)
    let t21 = py + (t16 + t2)
    let t22 = pz + (t18 + t3) - 0.2
    let t23 = px + (t14 + t4)
    let t24 = py + (t16 + t5)
    let t25 = pz + (t18 + t6) - 0.2
    let t26 = 0.5 * (t20 * t20 + t21 * t21 + t22 * t22 - (t23 * t23 + t24 * t24 + t25 * t25))
    let t27 = px + (t14 + t7)
    let t28 = py + (t16 + t8)
    let t29 = pz + (t0 + t18) - 0.2
    let t30 = t27 * t27 + t28 * t28 + t29 * t29
    let t31 = px + (t14 + t9)
    let t32 = py + (t16 + t10)
    let t33 = pz + (t18 + t11) - 0.2
    let t34 = t31 * t31 + t32 * t32 + t33 * t33
    let t35 = 0.5 * (t30 - t34)
    let t36 = t35 * t35
    let t37 = t26 * t26
    let t38 = 0.5 * (t30 + t34)
    circle(0.15000000000000002, 0.0, t15 * t15 + t17 * t17 + t19 * t19 - 0.15250000000000002) -> c2 s2 {
      # joint 4: two equations in its cosine and sine
      let t41 = -0.3 * s2
      let t42 = r01 * t41
      let t43 = -0.3 * c2
      let t44 = -0.25000000000000006 + t43
      let t45 = px + (t14 - t42 + r02 * t44) - 0.55
      let t46 = r11 * t41
      let t47 = py + (t16 - t46 + r12 * t44)
      let t48 = r21 * t41
      let t49 = pz + (t18 - t48 + r22 * t44) - 0.2
      let t50 = t45 * t45 + t47 * t47 + t49 * t49
      let t51 = 0.25 - t43
      let t52 = px + (t14 + t42 + r02 * t51) - 0.55
      let t53 = py + (t16 + t46 + r12 * t51)
      let t54 = pz + (t18 + t48 + r22 * t51) - 0.2
      let t55 = t52 * t52 + t53 * t53 + t54 * t54
      let t56 = 0.5 * (t50 - t55)
      let t57 = r01 * t44
      let t58 = r02 * t41
      let t59 = px + (t14 - t57 - t58) - 0.55
      let t60 = r11 * t44
      let t61 = r12 * t41
      let t62 = py + (t16 - t60 - t61)
      let t63 = r21 * t44
      let t64 = r22 * t41
      let t65 = pz + (t18 - t63 - t64) - 0.2
      let t66 = px + (t58 + (t14 + t57)) - 0.55
      let t67 = py + (t61 + (t16 + t60))
      let t68 = pz + (t64 + (t18 + t63)) - 0.2
      let t69 = 0.5 * (t59 * t59 + t62 * t62 + t65 * t65 - (t66 * t66 + t67 * t67 + t68 * t68))
      let t70 = (t26 * t56 - t35 * t69) / max(1e-30, t37 + (t56 * t56 + t69 * t69 + t36))
      let t71 = t43 + 0.3
      let t72 = t38 - (t71 * t71 + t41 * t41)
      let t73 = 0.5 * (t50 + t55) - 0.30250000000000005
      align(t70 * (t69 * t72 - t26 * t73), t70 * (t35 * t73 - t56 * t72)) -> c4 s4 {
        # joint 1: two equations in its cosine and sine
        let t76 = s2 * c4 + c2 * s4
        let t77 = c2 * c4 - s2 * s4
        align(-0.5 * (r01 * t76 - r02 * t77), -0.5 * (r01 * t77 + r02 * t76)) -> c1 s1 {
          emit angle(c1, s1) angle(c2, s2) length(d3) angle(c4, s4)
        }
      }
    }
  }
}
