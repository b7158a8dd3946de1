ikgen 1
class "PPPRRR one by one, joints in the order 5, 4, 6, 1, 2, 3"
variables 6
free []
snap 0.0
slack 0.0
{
  # joint 5: an equation of which it is the only unknown
  let t0 = r02 * -0.2
  let t1 = -0.2 * r12
  let t2 = -0.2 * r22
  circle(0.0, -1.0, r22) -> c5 s5 {
    # joint 4: two equations in its cosine and sine
    let t5 = 0.5 * (c5 + c5)
    let t6 = t5 * t5
    let t7 = t6 / max(1e-30, t6 + t6)
    align(t7 * (r02 * t5), t7 * (r12 * t5)) -> c4 s4 {
      # joint 6: two equations in its cosine and sine
      align((r01 * s4 - r11 * c4) * -0.5, -0.5 * (s4 * r00 - c4 * r10)) -> c6 s6 {
        # joint 1: its length
        let t12 = c6 * 0.050000000000000044
        let t13 = s6 * -0.050000000000000044
        let t14 = 0.1 - (py + (t1 - (r10 * t12 + r11 * t13)))
        let t15 = 1.0 - (pz + (t2 - (t12 * r20 + t13 * r21)))
        quadratic(0.0, 1.0, 0.2 - (px + (t0 - (r00 * t12 + r01 * t13)))) -> d1 {
          # joint 2: its length
          quadratic(0.0, 1.0, t14) -> d2 {
            # joint 3: its length
            quadratic(0.0, 1.0, t15) -> d3 {
              emit length(d1) length(d2) length(d3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
            }
          }
        }
      }
    }
  }
}
