//! Sine, cosine and arc tangent from additions, products and quotients alone.
//!
//! Each is within one unit in the last place of the exact value, angles within two, and gives the same bits on every platform.

pub use super::sqrt::sqrt;

/// Cosine and sine of an angle in radians, `[cos, sin]`, for angles of up to a million quarter turns.
///
/// Reduction by a three-part pi/2 to [-pi/4, pi/4] and a remainder below the last place, then Taylor polynomials whose
/// truncation is below 1e-18.
pub fn cos_sin(angle: f64) -> [f64; 2] {
    // The first two parts have 33 bits: their products with the number of quarters are exact.
    const PI_2_A: f64 = 1.570_796_326_734_125_6;
    const PI_2_B: f64 = 6.077_100_506_303_966e-11;
    const PI_2_C: f64 = 2.022_266_248_795_950_6e-21;
    let scaled = angle * core::f64::consts::FRAC_2_PI;
    // Ties matter little: the polynomials hold a bit beyond pi/4.
    let quarter = (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i64;
    let k = quarter as f64;
    let (b, c) = (k * PI_2_B, k * PI_2_C);
    let a = angle - k * PI_2_A;
    let ab = a - b;
    let x = ab - c;
    // What the two differences have rounded away.
    let shift = ab - a;
    let low = ((a - (ab - shift)) - (b + shift)) + ((ab - x) - c);
    let z = x * x;
    let mut s = 1.0 / 355_687_428_096_000.0;
    for d in [-1_307_674_368_000.0, 6_227_020_800.0, -39_916_800.0, 362_880.0, -5_040.0, 120.0, -6.0] {
        s = 1.0 / d + z * s;
    }
    let half = 0.5 * z;
    let s = x + (x * z * s + low * (1.0 - half));
    let mut c = 1.0 / 20_922_789_888_000.0;
    for d in [-87_178_291_200.0, 479_001_600.0, -3_628_800.0, 40_320.0, -720.0, 24.0] {
        c = 1.0 / d + z * c;
    }
    let w = 1.0 - half;
    let c = w + (((1.0 - w) - half) + (z * z * c - x * low));
    match quarter & 3 {
        0 => [c, s],
        1 => [-s, c],
        2 => [-c, -s],
        _ => [s, -c],
    }
}

/// Angle with this sine and cosine in (-pi, pi], within two places.
///
/// Folded to the first octant and turned back by the nearest of the angles with sine `k/16`; what is left is a small sine.
pub fn angle_of(sine: f64, cosine: f64) -> f64 {
    use core::f64::consts::{FRAC_PI_2, PI};
    /// Cosine and angle.
    const SIXTEENTHS: [[f64; 2]; 12] = [
        [1.0, 0.0],
        [0.998_044_963_916_957, 0.062_540_761_796_491_39],
        [0.992_156_741_649_221_5, 0.125_327_831_168_065_4],
        [0.982_264_602_843_857, 0.188_616_386_175_404_1],
        [0.968_245_836_551_854_3, 0.252_680_255_142_078_65],
        [0.949_917_759_598_166_5, 0.317_823_703_927_880_73],
        [0.927_024_810_886_957_9, 0.384_396_774_495_639_1],
        [0.899_218_410_621_135, 0.452_816_594_744_925_6],
        [0.866_025_403_784_438_6, core::f64::consts::FRAC_PI_6],
        [0.826_797_284_707_684_5, 0.597_406_416_645_350_2],
        [0.780_624_749_799_799_8, 0.675_131_532_937_031_7],
        [0.726_184_377_413_890_6, 0.758_040_765_426_236],
    ];
    /// What the angle of the octant is added to, and with which sign: beyond the diagonal, left, both.
    const OCTANTS: [[f64; 2]; 4] = [[0.0, 1.0], [FRAC_PI_2, -1.0], [PI, -1.0], [FRAC_PI_2, 1.0]];
    let (ac, as_) = (cosine.abs(), sine.abs());
    let (large, small) = if ac > as_ { (ac, as_) } else { (as_, ac) };
    // The cast gives 0 for what is not a number.
    let k = (small * 16.0 + 0.5) as u32 as usize;
    let k = if k > 11 { 11 } else { k };
    let [cos, angle] = SIXTEENTHS[k];
    let x = small * cos - large * (k as f64 * 0.0625);
    let z = x * x;
    let mut p = 945.0 / 42_240.0;
    for coefficient in [105.0 / 3_456.0, 15.0 / 336.0, 3.0 / 40.0, 1.0 / 6.0] {
        p = coefficient + z * p;
    }
    let octant = angle + (x + x * z * p);
    let [base, sign] = OCTANTS[usize::from(as_ > ac) + 2 * usize::from(cosine < 0.0)];
    let angle = base + sign * octant;
    if sine < 0.0 { mirrored(angle) } else { angle }
}

/// The angle half a turn on; both in (-pi, pi].
pub fn opposite(angle: f64) -> f64 {
    use core::f64::consts::PI;
    let turned = if angle > 0.0 { angle - PI } else { angle + PI };
    if turned > -PI { turned } else { PI }
}

/// The angle with the other sign; both in (-pi, pi].
pub fn mirrored(angle: f64) -> f64 {
    if angle < core::f64::consts::PI { -angle } else { angle }
}

/// The number without the lower half of its digits.
pub fn upper_half(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0xffff_ffff_f800_0000)
}

/// What the product `a * b` has rounded away.
pub fn product_rest(a: f64, b: f64) -> f64 {
    let (a_top, b_top) = (upper_half(a), upper_half(b));
    let (a_low, b_low) = (a - a_top, b - b_top);
    ((a_top * b_top - a * b) + a_top * b_low + a_low * b_top) + a_low * b_low
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI};
    use robotc_core::Seed;

    /// A number of about 106 bits: the exact sum of two.
    #[derive(Clone, Copy)]
    struct Twofold(f64, f64);

    impl Twofold {
        fn sum(a: f64, b: f64) -> Self {
            let s = a + b;
            let t = s - a;
            Self(s, (a - (s - t)) + (b - t))
        }

        fn plus(self, other: Self) -> Self {
            let (s, t) = (Self::sum(self.0, other.0), Self::sum(self.1, other.1));
            let u = Self::sum(s.0, s.1 + t.0);
            Self::sum(u.0, u.1 + t.1)
        }

        fn times(self, other: Self) -> Self {
            let p = self.0 * other.0;
            let rest = self.0.mul_add(other.0, -p);
            Self::sum(p, rest + (self.0 * other.1 + self.1 * other.0))
        }

        fn over(self, d: f64) -> Self {
            let q = self.0 / d;
            Self::sum(q, ((-q).mul_add(d, self.0) + self.1) / d)
        }
    }

    /// Cosine and sine to some 30 digits: reduction by 160 bits of pi/2, then 30 terms.
    fn exact_cos_sin(angle: f64) -> [Twofold; 2] {
        const PARTS: [f64; 3] = [FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];
        let k = (angle / FRAC_PI_2).round();
        let step = |x: Twofold, part: f64| x.plus(Twofold(-k, 0.0).times(Twofold(part, 0.0)));
        let x = PARTS.into_iter().fold(Twofold(angle, 0.0), step);
        let z = x.times(x);
        let series = |first: Twofold, from: usize| {
            let (mut term, mut sum) = (first, first);
            for n in (from..from + 30).step_by(2) {
                let next = term.times(z).over(-(((n + 1) * (n + 2)) as f64));
                (term, sum) = (next, sum.plus(next));
            }
            sum
        };
        let (c, s) = (series(Twofold(1.0, 0.0), 0), series(x, 1));
        let minus = |a: Twofold| Twofold(-a.0, -a.1);
        match k.rem_euclid(4.0) as i32 {
            0 => [c, s],
            1 => [minus(s), c],
            2 => [minus(c), minus(s)],
            _ => [s, minus(c)],
        }
    }

    /// The last place of a number.
    fn place(x: f64) -> f64 {
        let x = x.abs();
        f64::from_bits(x.to_bits() + 1) - x
    }

    /// Angles of all sizes, and those nearest to multiples of a quarter turn.
    fn angles() -> Vec<f64> {
        let mut rng = Seed::new(21).rng();
        let mut angles: Vec<f64> = (-400..400).map(|k| f64::from(k) * FRAC_PI_2 * 0.5).collect();
        angles.extend((0..60_000).map(|_| rng.range(-2.0 * PI, 2.0 * PI)));
        angles.extend((0..20_000).map(|_| rng.range(-1e3, 1e3)));
        angles.extend((0..20_000).map(|_| {
            let off = rng.range(-1.0, 1.0) * 10f64.powf(rng.range(-17.0, -1.0));
            (rng.range(-9.0, 9.0)).round() * FRAC_PI_2 + off
        }));
        angles
    }

    #[test]
    fn cosine_and_sine_are_within_one_place() {
        let mut worst = 0.0f64;
        for angle in angles() {
            for (found, exact) in cos_sin(angle).into_iter().zip(exact_cos_sin(angle)) {
                let error = ((found - exact.0) - exact.1).abs() / place(exact.0);
                assert!(error <= 1.0, "{angle:?}: {error} places");
                worst = worst.max(error);
            }
        }
        assert!(worst > 0.4, "the oracle sees no rounding: {worst}");
    }

    #[test]
    fn angles_of_unit_vectors_agree_with_the_arc_tangent() {
        let mut worst = 0.0f64;
        for angle in angles() {
            let [c, s] = cos_sin(angle);
            let (found, exact) = (angle_of(s, c), s.atan2(c));
            let apart = (found - exact).abs();
            worst = worst.max(apart.min((apart - 2.0 * PI).abs()) / place(exact).max(place(0.1)));
            assert_eq!([opposite(found), mirrored(found)].map(|a| a > -PI && a <= PI), [true; 2]);
            assert!((angle_of(-s, -c) - opposite(found)).abs() < 1e-15, "{angle}");
            assert!((angle_of(-s, c) - mirrored(found)).abs() < 1e-15, "{angle}");
        }
        assert!(worst <= 2.0, "{worst} places");
        assert_eq!([angle_of(0.0, -1.0), angle_of(-0.0, -1.0)], [PI; 2]);
        assert_eq!([opposite(PI), mirrored(PI), opposite(0.0)], [0.0, PI, PI]);
    }
}
