ikgen 1
class "RRPRRR one by one, joints in the order 3, 2, 1, 5, 4, 6"
variables 6
free []
snap 0.0
slack 0.0
{
  # joint 3: its length
  let t0 = px + r00 * 0.20000000000000007
  let t1 = py + 0.20000000000000007 * r10
  let t2 = pz + 0.20000000000000007 * r20
  let t3 = t2 - 0.4
  let t4 = px + r00 * 0.7000000000000001
  let t5 = py + r10 * 0.7000000000000001
  let t6 = 0.4 + (pz + r20 * 0.7000000000000001 - 0.4) - 0.4
  quadratic(1.0, 1.0, 0.2725 - (t0 * t0 + t1 * t1 + t3 * t3)) -> d3 {
    # joint 2: an equation of which it is the only unknown
    let t8 = 0.9 + d3
    let t9 = t8 - 0.4
    let t10 = 0.4 + (0.4 + t9 - 0.4)
    let t11 = 0.4 + (0.4 + (0.4 - t8) - 0.4)
    let t12 = 0.4 + d3 - 0.4
    let t13 = t12 * t12
    let t14 = d3 + 1.4 - 0.4
    let t15 = t14 * t14
    let t16 = 0.5 * (t13 - t15)
    let t17 = 0.5 * (t13 + t15)
    circle(0.5 * (t10 - t11), -0.15000000000000002, t2 - 0.5 * (t10 + t11)) -> c2 s2 {
      # joint 1: two equations in its cosine and sine
      let t20 = 0.15 * c2 + t9 * s2
      let t21 = 0.5 * (t20 + t20)
      let t22 = t21 * t21
      let t23 = -t22 / max(1e-30, t22 + t22)
      let t24 = s2 * t6
      let t25 = c2 * t6
      let t26 = r20 * s2
      let t27 = s2 * r21
      let t28 = s2 * r22
      align(-(t23 * (t0 * t21)), -(t23 * (t1 * t21))) -> c1 s1 {
        # joint 5: an equation of which it is the only unknown
        let t31 = c1 * t4 + s1 * t5
        let t32 = c2 * t31 - t24 - 0.15
        let t33 = c1 * t5 - t4 * s1
        let t34 = 0.4 + (s2 * t31 + t25) - 0.4
        let t35 = t26 - c2 * (r00 * c1 + r10 * s1)
        let t36 = r00 * s1 - r10 * c1
        let t37 = c1 * r11 - s1 * r01
        let t38 = c2 * (c1 * r01 + s1 * r11) - t27
        let t39 = c1 * r12 - s1 * r02
        let t40 = c2 * (c1 * r02 + s1 * r12) - t28
        circle(t16, 0.0, t32 * t32 + t33 * t33 + t34 * t34 - t17) -> c5 s5 {
          # joint 4: two equations in its cosine and sine
          let t43 = 0.5 * (s5 + s5)
          let t44 = t43 * t43
          let t45 = -t44 / max(1e-30, t44 + t44)
          align(-(t45 * (t43 * t35)), -(t45 * (t43 * t36))) -> c4 s4 {
            # joint 6: two equations in its cosine and sine
            align(0.5 * (c4 * t37 - s4 * t38), 0.5 * (c4 * t39 - s4 * t40)) -> c6 s6 {
              emit angle(c1, s1) angle(c2, s2) length(d3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
            }
          }
        }
      }
    }
  }
}
