ikgen 1
class "7R spherical wrist, general shoulder, j3 given"
variables 7
free [2]
snap 0.0
slack 0.0
{
  # the place of the wrist centre
  # axes skew: two linear equations give the turned vector, its length a conic
  let t0 = cos(free0)
  let t1 = -0.03755700000000001 * t0
  let t2 = px + r02 * -0.30499999999999994
  let t3 = py + -0.30499999999999994 * r12
  let t4 = pz + -0.30499999999999994 * r22 - 0.06
  let t5 = -0.1134725 + 0.5 * (t2 * t2 + t3 * t3 + t4 * t4 - 0.013689000000000002)
  let t6 = t4 * 0.117
  let t7 = t0 * 0.32100000000000006
  let t8 = t4 * -0.013689000000000002
  let t9 = sin(free0)
  let t10 = 0.32100000000000006 * t9
  conic(0.011356663815000001, 0.0, -(t1 * t1), -0.0030934949760000005 - 0.22598400000000002 * t5, 0.0, -0.001696121856 + (t5 * t5 + t6 * t6)) -> c4 s4 {
    let t13 = 0.352 + 0.32100000000000006 * c4
    let t14 = -0.117 * (c4 * 0.11299200000000001 - t5)
    let t15 = s4 * t7
    let t16 = s4 * t10
    let t17 = t3 * t16
    let t18 = t2 * t16
    align(t13 * t14 + t15 * t8, t13 * t8 - t14 * t15) -> c2 s2 {
      let t21 = 0.117 + (t13 * c2 - t15 * s2)
      let t22 = r22 * s2
      let t23 = r22 * c2
      let t24 = c2 * r21
      let t25 = s2 * r21
      align(t2 * t21 + t17, t3 * t21 - t18) -> c1 s1 {
        # what is left of the rotation for the wrist
        # the angle between the first and the last axis of the wrist
        let t28 = r02 * c1 + r12 * s1
        let t29 = c2 * t28
        let t30 = s2 * t28 + t23
        let t31 = r12 * c1 - r02 * s1
        let t32 = t0 * t30 - t9 * t31
        let t33 = s4 * (t22 - t29)
        let t34 = c4 * t32
        let t35 = t33 - t34
        let t36 = t0 * t31 + t9 * t30
        let t37 = t34 - t33
        let t38 = c1 * r11 - s1 * r01
        let t39 = c1 * r01 + s1 * r11
        let t40 = s2 * t39 + t24
        let t41 = t0 * t38 + t9 * t40
        let t42 = c2 * t39
        let t43 = s4 * (t25 - t42)
        let t44 = t0 * t40 - t9 * t38
        let t45 = c4 * t44
        let t46 = t43 - t45
        let t47 = t45 - t43
        let t48 = s4 * t44 - c4 * (t42 - t25)
        half(c4 * (t29 - t22) - s4 * t32, sqrt(t35 * t35 + t36 * t36)) -> c6 s6 {
          let t51 = s6 * t48
          align(-(s6 * t37), t36 * s6) -> c5 s5 {
            let t54 = c5 * t41
            let t55 = s5 * t46
            let t56 = c5 * t47
            let t57 = t41 * s5
            align(t54 - t55, c6 * (t56 - t57) - t51) -> c7 s7 {
              emit angle(c1, s1) angle(c2, s2) angle(t0, t9) angle(c4, s4) angle(c5, s5) angle(c6, s6) angle(c7, s7)
            }
            zero(s6, 1e-11) {
            } else {
              let t60 = -c5
              let t61 = -s5
              let t62 = -s6
              align(t55 - t54, t51 + c6 * (t57 - t56)) -> c7_2 s7_2 {
                emit angle(c1, s1) angle(c2, s2) angle(t0, t9) angle(c4, s4) angle(t60, t61) angle(c6, t62) angle(c7_2, s7_2)
              }
            }
          }
        }
      }
    }
  }
}
