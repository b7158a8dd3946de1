ikgen 1
class "RRPR one by one, joints in the order 3, 2, 1, 4"
variables 4
free []
snap 0.0
slack 0.0
{
  # joint 3: its length
  let t0 = r22 * -0.55
  let t1 = -0.55 * r12
  let t2 = -0.55 * r02
  quadratic(0.0, 1.0, 0.2 - (pz + (r20 * -0.1 + t0))) -> d3 {
    # joint 2: an equation of which it is the only unknown
    let t4 = 0.1 - (0.2 + (0.2 - d3 - 0.2))
    let t5 = r00 * t4
    let t6 = px + t5
    let t7 = t6 * t6
    let t8 = t4 * r10
    let t9 = py + t8
    let t10 = t9 * t9
    let t11 = r20 * t4
    let t12 = pz + t11 - 0.2
    let t13 = t6 - 0.55
    let t14 = 0.2 + t12 - 0.2
    let t15 = t14 * t14
    let t16 = t15 + (t10 + t13 * t13)
    let t17 = t6 + 0.55
    let t18 = t15 + (t10 + t17 * t17)
    let t19 = 0.5 * (t16 - t18)
    let t20 = 0.2 + (0.2 + (pz + (t0 + t11) - 0.2) - 0.2) - 0.2
    let t21 = t20 * t20
    let t22 = py + (t8 + t1)
    let t23 = t22 - 0.3
    let t24 = px + (t5 + t2)
    let t25 = t22 + 0.3
    let t26 = t9 - 0.55
    let t27 = t9 + 0.55
    let t28 = 0.5 * (t15 + (t7 + t26 * t26) - (t15 + (t7 + t27 * t27)))
    let t29 = t24 - 0.3
    let t30 = 0.3 + t24
    let t31 = t19 * t19 + t28 * t28
    let t32 = 0.5 * (t16 + t18)
    circle(0.15000000000000002, 0.0, t10 + t7 + t12 * t12 - 0.15250000000000002) -> c2 s2 {
      # joint 1: two equations in its cosine and sine
      let t35 = t24 * s2
      let t36 = 0.3 + (c2 * t23 - t35) - 0.55
      let t37 = t24 * c2
      let t38 = t37 + s2 * t23
      let t39 = 0.3 + (t35 - c2 * t25) - 0.55
      let t40 = t37 + s2 * t25
      let t41 = 0.5 * (t21 + (t36 * t36 + t38 * t38) - (t21 + (t39 * t39 + t40 * t40)))
      let t42 = t22 * s2
      let t43 = 0.3 + (t42 + c2 * t29) - 0.55
      let t44 = t22 * c2
      let t45 = t44 - s2 * t29
      let t46 = t21 + (t43 * t43 + t45 * t45)
      let t47 = 0.3 - (t42 + c2 * t30) - 0.55
      let t48 = s2 * t30 - t44
      let t49 = t21 + (t47 * t47 + t48 * t48)
      let t50 = 0.5 * (t46 - t49)
      let t51 = (t19 * t41 - t28 * t50) / max(1e-30, t41 * t41 + (t50 * t50 + t31))
      let t52 = 0.5 * (t46 + t49) - 0.30250000000000005
      let t53 = 0.3 + c2 * 0.25000000000000006 - 0.55
      let t54 = s2 * 0.25000000000000006
      let t55 = t32 - (t53 * t53 + t54 * t54)
      align(t51 * (t28 * t52 - t41 * t55), t51 * (t50 * t55 - t19 * t52)) -> c1 s1 {
        # joint 4: two equations in its cosine and sine
        let t58 = c2 * c1
        let t59 = s2 * s1
        let t60 = t58 - t59
        let t61 = t59 - t58
        let t62 = 0.5 * (t60 - t61)
        let t63 = 0.5 * (t61 - t60)
        let t64 = s2 * c1 + c2 * s1
        let t65 = 0.5 * (t64 + t64)
        let t66 = t65 * t65
        let t67 = (t62 * t63 - t66) / max(1e-30, t66 + (t66 + t62 * t62) + t63 * t63)
        let t68 = r02 - 0.5 * (t60 + t61)
        align(t67 * (t63 * t68 + t65 * r01), t67 * (t62 * r01 + t65 * t68)) -> c4 s4 {
          emit angle(c1, s1) angle(c2, s2) length(d3) angle(c4, s4)
        }
      }
    }
  }
}
