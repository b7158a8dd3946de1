//! Sine, cosine, arc tangent and square root from additions, products and quotients alone.
//!
//! Each is within about one unit in the last place, and gives the same bits on every platform.

/// Cosine and sine of an angle in radians, `[cos, sin]`.
///
/// Reduction to [-pi/4, pi/4] by a three-part pi/2 is exact enough up to some 1e5 turns; then Taylor polynomials,
/// whose truncation is below 1e-18.
pub fn cos_sin(angle: f64) -> [f64; 2] {
    const PI_2_A: f64 = 1.570_796_326_734_125_6;
    const PI_2_B: f64 = 6.077_100_506_303_966e-11;
    const PI_2_C: f64 = 2.022_266_248_795_950_6e-21;
    let scaled = angle * core::f64::consts::FRAC_2_PI;
    // Ties matter little: the polynomials hold a bit beyond pi/4.
    let quarter = (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i64;
    let k = quarter as f64;
    let x = ((angle - k * PI_2_A) - k * PI_2_B) - k * PI_2_C;
    let z = x * x;
    let mut s = 1.0 / 355_687_428_096_000.0;
    for d in [-1_307_674_368_000.0, 6_227_020_800.0, -39_916_800.0, 362_880.0, -5_040.0, 120.0, -6.0] {
        s = 1.0 / d + z * s;
    }
    let s = x + x * z * s;
    let mut c = 1.0 / 20_922_789_888_000.0;
    for d in [-87_178_291_200.0, 479_001_600.0, -3_628_800.0, 40_320.0, -720.0, 24.0] {
        c = 1.0 / d + z * c;
    }
    let half = 0.5 * z;
    let w = 1.0 - half;
    let c = w + (((1.0 - w) - half) + z * z * c);
    match quarter & 3 {
        0 => [c, s],
        1 => [-s, c],
        2 => [-c, -s],
        _ => [s, -c],
    }
}

/// Angle of the vector (`x`, `y`) in (-pi, pi]; 0 for the zero vector.
///
/// Folded to the first octant, turned back by the nearest of nine tabulated angles `atan(k/8)`, then a Taylor
/// polynomial on a ratio below 1/15.
pub fn atan2(y: f64, x: f64) -> f64 {
    const ATAN_EIGHTHS: [f64; 9] = [
        0.0,
        0.124_354_994_546_761_44,
        0.244_978_663_126_864_14,
        0.358_770_670_270_572_2,
        0.463_647_609_000_806_1,
        0.558_599_315_343_562_4,
        0.643_501_108_793_284_4,
        0.718_829_999_621_624_5,
        core::f64::consts::FRAC_PI_4,
    ];
    let (ax, ay) = (x.abs(), y.abs());
    let (large, small) = if ax > ay { (ax, ay) } else { (ay, ax) };
    if large == 0.0 || !(large < f64::INFINITY) {
        return 0.0;
    }
    let k = (small / large * 8.0 + 0.5) as usize;
    let tangent = k as f64 * 0.125;
    let t = (small - tangent * large) / (large + tangent * small);
    let z = t * t;
    let mut p = -1.0 / 15.0;
    for d in [13.0, -11.0, 9.0, -7.0, 5.0, -3.0] {
        p = 1.0 / d + z * p;
    }
    let mut angle = ATAN_EIGHTHS[k] + (t + t * z * p);
    if ay > ax {
        angle = core::f64::consts::FRAC_PI_2 - angle;
    }
    if x < 0.0 {
        angle = core::f64::consts::PI - angle;
    }
    if y < 0.0 { -angle } else { angle }
}

/// Square root; 0 for negative arguments.
// BEGIN sqrt: replaced in generated files that may not use `std`
pub fn sqrt(x: f64) -> f64 {
    if x > 0.0 { x.sqrt() } else { 0.0 }
}
// END sqrt

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agree_with_the_platform() {
        let mut worst = [0.0f64; 2];
        for i in -40_000..40_000 {
            let x = f64::from(i) * 7.321e-4;
            let [c, s] = cos_sin(x);
            worst[0] = worst[0].max((c - x.cos()).abs()).max((s - x.sin()).abs());
            let y = f64::from(i % 977) * 0.013;
            worst[1] = worst[1].max((atan2(y, x) - y.atan2(x)).abs());
        }
        assert!(worst[0] < 2.3e-16 && worst[1] < 4.5e-16, "{worst:?}");
        assert_eq!(atan2(0.0, -1.0), core::f64::consts::PI);
        assert_eq!(atan2(0.0, 0.0), 0.0);
        assert_eq!(sqrt(-1.0), 0.0);
    }
}
