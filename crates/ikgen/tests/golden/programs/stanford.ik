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
  let t2 = pz + 0.20000000000000007 * r20 - 0.4
  let t3 = px + r00 * 0.7000000000000001
  let t4 = py + r10 * 0.7000000000000001
  let t5 = pz + r20 * 0.7000000000000001 - 0.4
  quadratic(1.0, 1.0, 0.2725 - (t0 * t0 + t1 * t1 + t2 * t2)) -> d3 {
    # joint 2: an equation of which it is the only unknown
    let t7 = 0.5 + d3
    let t8 = d3 * d3
    let t9 = d3 + 0.9999999999999999
    let t10 = t9 * t9
    let t11 = 0.5 * (t8 - t10)
    let t12 = 0.5 * (t8 + t10)
    circle(0.5 * (1.0 + (d3 + d3)), -0.15000000000000002, t2) -> c2 s2 {
      # joint 1: two equations in its cosine and sine
      let t15 = 0.15 * c2 + s2 * t7
      let t16 = 0.5 * (t15 + t15)
      let t17 = t16 * t16
      let t18 = -t17 / max(1e-30, t17 + t17)
      let t19 = s2 * t5
      let t20 = c2 * t5
      let t21 = r20 * s2
      let t22 = s2 * r21
      let t23 = s2 * r22
      align(-(t18 * (t0 * t16)), -(t18 * (t1 * t16))) -> c1 s1 {
        # joint 5: an equation of which it is the only unknown
        let t26 = c1 * t3 + s1 * t4
        let t27 = c2 * t26 - t19 - 0.15
        let t28 = c1 * t4 - t3 * s1
        let t29 = s2 * t26 + t20
        let t30 = t21 - c2 * (r00 * c1 + r10 * s1)
        let t31 = r00 * s1 - r10 * c1
        let t32 = c1 * r11 - s1 * r01
        let t33 = c2 * (c1 * r01 + s1 * r11) - t22
        let t34 = c1 * r12 - s1 * r02
        let t35 = c2 * (c1 * r02 + s1 * r12) - t23
        circle(t11, 0.0, t27 * t27 + t28 * t28 + t29 * t29 - t12) -> c5 s5 {
          # joint 4: two equations in its cosine and sine
          let t38 = 0.5 * (s5 + s5)
          let t39 = t38 * t38
          let t40 = -t39 / max(1e-30, t39 + t39)
          align(-(t40 * (t38 * t30)), -(t40 * (t38 * t31))) -> c4 s4 {
            # joint 6: two equations in its cosine and sine
            align(0.5 * (c4 * t32 - s4 * t33), 0.5 * (c4 * t34 - s4 * t35)) -> c6 s6 {
              emit angle(c1, s1) angle(c2, s2) length(d3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
            }
          }
        }
      }
    }
  }
}
