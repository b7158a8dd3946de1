//! Real roots of trigonometric polynomials, as eigenvalues.

use super::eigen::{MAX_SIZE, Square, hessenberg_eigenvalues};
use super::math::{angle_of, cos_sin, sqrt};

/// Highest multiple of the angle.
pub const MAX_DEGREE: usize = MAX_SIZE / 2;

/// Number of samples that determine a polynomial of the highest degree.
pub const MAX_SAMPLES: usize = 2 * MAX_DEGREE + 1;

/// A trigonometric polynomial by its waves: `d[0] + 2 sum_k Re(d[k] e^(i k q))`, `d[k]` as real and imaginary part.
#[derive(Clone, Copy, Debug)]
pub struct Waves {
    d: [[f64; 2]; MAX_DEGREE + 1],
    /// Highest wave.
    pub degree: usize,
    /// Largest sample in magnitude.
    pub largest: f64,
    /// Where that is, and half a turn before it.
    start: f64,
}

/// A root.
#[derive(Clone, Copy, Debug)]
pub struct Root {
    /// Real part of the angle.
    pub angle: f64,
    /// Imaginary part of the angle, to first order.
    pub imaginary: f64,
}

/// Roots; the first `count` of the entries.
pub type Roots = [Root; MAX_SIZE];

impl Waves {
    /// The polynomial of this degree that takes the values `samples` at `2 degree + 1` equal steps round the circle, starting at
    /// zero.
    pub fn new(samples: &[f64; MAX_SAMPLES], degree: usize) -> Waves {
        let n = 2 * degree + 1;
        let step = core::f64::consts::TAU / n as f64;
        let mut table = [[0.0; 2]; MAX_SAMPLES];
        let mut at = 0;
        for i in 0..n {
            table[i] = cos_sin(step * i as f64);
            if samples[i].abs() > samples[at].abs() {
                at = i;
            }
        }
        let mut d = [[0.0; 2]; MAX_DEGREE + 1];
        for (k, [real, imaginary]) in d.iter_mut().enumerate().take(degree + 1) {
            let mut place = 0;
            for x in &samples[..n] {
                *real += x * table[place][0];
                *imaginary -= x * table[place][1];
                place = (place + k) % n;
            }
            (*real, *imaginary) = (*real / n as f64, *imaginary / n as f64);
        }
        let start = step * at as f64 - core::f64::consts::PI;
        Waves { d, degree, largest: samples[at].abs(), start }
    }

    /// `a[0] + a[1] cos q + a[2] sin q + ... + a[7] cos 4q + a[8] sin 4q`.
    pub fn of_fourth(a: [f64; 9]) -> Waves {
        const SIDE: f64 = core::f64::consts::FRAC_1_SQRT_2;
        const EIGHTHS: [[f64; 2]; 8] = [
            [1.0, 0.0],
            [SIDE, SIDE],
            [0.0, 1.0],
            [-SIDE, SIDE],
            [-1.0, 0.0],
            [-SIDE, -SIDE],
            [0.0, -1.0],
            [SIDE, -SIDE],
        ];
        let mut d = [[0.0; 2]; MAX_DEGREE + 1];
        d[0][0] = a[0];
        for k in 1..5 {
            d[k] = [0.5 * a[2 * k - 1], -0.5 * a[2 * k]];
        }
        let mut waves = Waves { d, degree: 4, largest: 0.0, start: 0.0 };
        for (i, turn) in EIGHTHS.into_iter().enumerate() {
            let value = waves.bends(turn)[0].abs();
            if value > waves.largest {
                waves.largest = value;
                waves.start = (i as f64 - 4.0) * core::f64::consts::FRAC_PI_4;
            }
        }
        waves
    }

    /// Value and the first two derivatives at a turn.
    fn bends(&self, [c, s]: [f64; 2]) -> [f64; 3] {
        let (mut x, mut y) = (1.0, 0.0);
        let [mut value, mut slope, mut bend] = [self.d[0][0], 0.0, 0.0];
        for (k, [real, imaginary]) in self.d.iter().enumerate().take(self.degree + 1).skip(1) {
            (x, y) = (x * c - y * s, x * s + y * c);
            let (along, across) = (2.0 * (real * x - imaginary * y), 2.0 * (real * y + imaginary * x));
            let k = k as f64;
            value += along;
            slope -= k * across;
            bend -= k * k * along;
        }
        [value, slope, bend]
    }

    /// The root near an angle, or the extremum where two roots fall together, as cosine and sine, and the value there; Newton steps.
    pub fn improved(&self, angle: f64, double: bool) -> ([f64; 2], f64) {
        let mut turn = cos_sin(angle);
        let [mut value, mut slope, mut bend] = self.bends(turn);
        for _ in 0..if double { 4 } else { 2 } {
            let step = if double { -slope / bend } else { -value / slope };
            if !(step.abs() < 2e-2) {
                break;
            }
            let [c, s] = turn;
            let [x, y] = [c - s * step, s + c * step];
            let n = sqrt(x * x + y * y);
            turn = [x / n, y / n];
            [value, slope, bend] = self.bends(turn);
            if step.abs() < 1e-9 {
                break;
            }
        }
        (turn, value)
    }

    /// The extremum near an angle, with the value and the second derivative there; Newton steps.
    pub fn extremum(&self, angle: f64) -> [f64; 3] {
        let mut at = angle;
        let [mut value, mut slope, mut bend] = self.bends(cos_sin(at));
        for _ in 0..4 {
            let step = -slope / bend;
            if !(step.abs() < 1e-2) || step.abs() < 1e-12 {
                break;
            }
            at += step;
            [value, slope, bend] = self.bends(cos_sin(at));
        }
        [at, value, bend]
    }

    /// How high the polynomial rises within `reach` of an angle, to second order.
    pub fn rise(&self, angle: f64, reach: f64) -> f64 {
        let [value, slope, bend] = self.bends(cos_sin(angle));
        value.abs() + reach * (slope.abs() + 0.5 * reach * bend.abs())
    }

    /// Size of a wave.
    pub fn size(&self, k: usize) -> f64 {
        sqrt(self.d[k][0] * self.d[k][0] + self.d[k][1] * self.d[k][1])
    }

    /// Value and derivative.
    pub fn at(&self, angle: f64) -> [f64; 2] {
        let [value, slope, _] = self.bends(cos_sin(angle));
        [value, slope]
    }

    /// All roots; returns how many were found.
    ///
    /// Half a turn is moved to where the polynomial is largest, so that no root is at infinity in the tangent `t` of the half
    /// angle. The powers of `t` are scaled by square roots of binomial coefficients, which makes the change of basis an isometry
    /// but for the weights of the waves (Bombieri's norm), and the companion matrix a balanced one.
    ///
    /// With `squared` the polynomial is known to be a square, and the roots are those of its root.
    pub fn roots(&self, squared: bool, found: &mut Roots) -> usize {
        let mut powers = self.powers_of_half_tangent();
        let mut size = 2 * self.degree;
        if squared {
            square_root(&mut powers, size);
            size /= 2;
        }
        if !(powers[size].abs() > 0.0 && powers[size].abs() < f64::INFINITY) {
            return 0;
        }
        let mut weight = [1.0; MAX_SIZE + 1];
        for k in 1..=size {
            weight[k] = weight[k - 1] * sqrt((size + 1 - k) as f64 / k as f64);
        }
        let mut companion: Square = [[0.0; MAX_SIZE]; MAX_SIZE];
        for k in 0..size {
            companion[k][size - 1] = -weight[size - 1] * powers[k] / (weight[k] * powers[size]);
        }
        for k in 1..size {
            companion[k][k - 1] += weight[k - 1] / weight[k];
        }
        let mut values = [[0.0; 2]; MAX_SIZE];
        let count = hessenberg_eigenvalues(&mut companion, size, &mut values);
        for (root, [x, y]) in found.iter_mut().zip(&values[..count]) {
            // 2 atan(x + i y), its imaginary part to first order: only small ones matter. Halves keep digits that their sum has not.
            let half = |across: f64| {
                let n = sqrt(x * x + across * across);
                angle_of(x / n, across / n)
            };
            let angle = self.start + (half(1.0 - y) + half(1.0 + y));
            *root = Root { angle, imaginary: 2.0 * y / (1.0 + x * x) };
        }
        count
    }

    /// Coefficients of the powers of `t = tan((angle - start) / 2)` in the polynomial times `(1 + t^2)^degree`.
    ///
    /// With `u = 1 + i t` and its conjugate `v` that is the sum of `e_j u^j v^(2 degree - j)`, by Horner's scheme.
    fn powers_of_half_tangent(&self) -> [f64; MAX_SIZE + 1] {
        let n = self.degree;
        let mut sum = [[0.0; 2]; MAX_SIZE + 1];
        let mut conjugate = [[0.0; 2]; MAX_SIZE + 1];
        conjugate[0] = [1.0, 0.0];
        for m in 0..=2 * n {
            let k = n.abs_diff(m);
            let [c, s] = cos_sin(k as f64 * self.start);
            let [x, y] = self.d[k];
            let turned = [x * c - y * s, x * s + y * c];
            // From the highest wave down; those of negative number are conjugates.
            let [x, y] = if m <= n { turned } else { [turned[0], -turned[1]] };
            for i in (0..=m).rev() {
                let below = if i > 0 { [-sum[i - 1][1], sum[i - 1][0]] } else { [0.0; 2] };
                let [a, b] = conjugate[i];
                // The sum times u, and the wave times the power of v.
                if m > 0 {
                    sum[i] = [sum[i][0] + below[0], sum[i][1] + below[1]];
                }
                sum[i] = [sum[i][0] + x * a - y * b, sum[i][1] + x * b + y * a];
            }
            for i in (1..MAX_SIZE + 1).rev() {
                let [a, b] = conjugate[i - 1];
                conjugate[i] = [conjugate[i][0] + b, conjugate[i][1] - a];
            }
        }
        sum.map(|[real, _]| real)
    }
}

/// The polynomial of half the degree whose square this one is, but for its sign.
fn square_root(powers: &mut [f64; MAX_SIZE + 1], degree: usize) {
    let half = degree / 2;
    let sign = if powers[degree] < 0.0 { -1.0 } else { 1.0 };
    let mut root = [0.0; MAX_SIZE + 1];
    root[half] = sqrt(powers[degree].abs());
    for k in (0..half).rev() {
        let mut rest = sign * powers[half + k];
        for i in k + 1..half {
            rest -= root[i] * root[half + k - i];
        }
        root[k] = 0.5 * rest / root[half];
    }
    *powers = root;
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn known_roots_are_found() {
        let mut rng = Seed::new(4).rng();
        for case in 0..500 {
            let squared = case % 3 == 0;
            let degree = if squared { 1 + case % (MAX_DEGREE / 2) } else { 1 + case % MAX_DEGREE };
            let angles: Vec<f64> = (0..2 * degree).map(|_| rng.range(-3.0, 3.0)).collect();
            let (power, degree) = if squared { (2, 2 * degree) } else { (1, degree) };
            let value = |q: f64| angles.iter().map(|a| (0.5 * (q - a)).sin()).product::<f64>().powi(power);
            let n = 2 * degree + 1;
            let mut samples = [0.0; MAX_SAMPLES];
            for (i, x) in samples.iter_mut().enumerate().take(n) {
                *x = value(core::f64::consts::TAU * i as f64 / n as f64);
            }
            let waves = Waves::new(&samples, degree);
            let (h, q) = (1e-6, 0.7);
            let [at, slope] = waves.at(q);
            assert!((at - value(q)).abs() < 1e-14);
            assert!((slope - (value(q + h) - value(q - h)) / (2.0 * h)).abs() < 1e-8);
            let mut found = [Root { angle: 0.0, imaginary: 0.0 }; MAX_SIZE];
            assert_eq!(waves.roots(squared, &mut found), angles.len());
            let slope = |a: f64| -> f64 {
                angles.iter().filter(|b| **b != a).map(|b| (0.5 * (a - b)).sin()).product::<f64>().abs()
            };
            for a in &angles {
                let gap = |r: &Root| (0.5 * (r.angle - a)).sin().abs().max(r.imaginary.abs());
                let near = found[..angles.len()].iter().map(gap).fold(9.0, f64::min);
                let allowed = if squared { 1e-9 } else { 1e-12 } / slope(*a);
                assert!(near < allowed || allowed > 1e-4, "{degree} {squared} {near:e} {allowed:e}");
            }
        }
    }
}
