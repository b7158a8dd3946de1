//! Real roots of trigonometric polynomials, as eigenvalues.

use super::eigen::{MAX_SIZE, Square, hessenberg_eigenvalues};
use super::math::{atan2, cos_sin, sqrt};

/// Highest multiple of the angle.
pub const MAX_DEGREE: usize = MAX_SIZE / 2;

/// Number of samples that determine a polynomial of the highest degree.
pub const MAX_SAMPLES: usize = 2 * MAX_DEGREE + 1;

/// The roots of the trigonometric polynomial of this degree that takes the values `samples` at `2 degree + 1` equal
/// steps round the circle, starting at zero. Roots are `[angle, imaginary part]`; returns how many there are.
///
/// Half a turn is moved to where the polynomial is largest, so that no root is at infinity in the tangent `t` of the half
/// angle. The powers of `t` are scaled by square roots of binomial coefficients, which makes the change of basis from the
/// samples an isometry but for the weights of the waves (Bombieri's norm), and the companion matrix a balanced one.
pub fn roots(samples: &[f64; MAX_SAMPLES], degree: usize, found: &mut [[f64; 2]; MAX_SIZE]) -> usize {
    let n = 2 * degree + 1;
    let size = 2 * degree;
    let step = core::f64::consts::TAU / n as f64;
    let mut largest = 0;
    for i in 0..n {
        if samples[i].abs() > samples[largest].abs() {
            largest = i;
        }
    }
    let start = step * largest as f64 - core::f64::consts::PI;
    let mut powers = powers_of_half_tangent(samples, degree, start);
    if !(powers[size].abs() > 0.0 && powers[size].abs() < f64::INFINITY) {
        return 0;
    }
    let mut weight = [1.0; MAX_SIZE + 1];
    for k in 1..=size {
        weight[k] = weight[k - 1] * sqrt((size + 1 - k) as f64 / k as f64);
    }
    let mut companion: Square = [[0.0; MAX_SIZE]; MAX_SIZE];
    for k in 0..size {
        powers[k] /= weight[k] * powers[size];
        if k > 0 {
            companion[k][k - 1] = weight[k - 1] / weight[k];
        }
    }
    for k in 0..size {
        companion[k][size - 1] -= weight[size - 1] * powers[k];
    }
    let count = hessenberg_eigenvalues(&mut companion, size, found);
    for root in &mut found[..count] {
        let [x, y] = *root;
        // 2 atan(x + i y), its imaginary part to first order: only small ones matter.
        *root = [start + atan2(2.0 * x, 1.0 - x * x - y * y), 2.0 * y / (1.0 + x * x)];
    }
    count
}

/// Coefficients of the powers of `t = tan((angle - start) / 2)` in the polynomial times `(1 + t^2)^degree`.
fn powers_of_half_tangent(samples: &[f64; MAX_SAMPLES], degree: usize, start: f64) -> [f64; MAX_SIZE + 1] {
    let n = 2 * degree + 1;
    let mut table = [[0.0; 2]; MAX_SAMPLES];
    for (i, entry) in table.iter_mut().enumerate().take(n) {
        *entry = cos_sin(core::f64::consts::TAU * i as f64 / n as f64);
    }
    // The sum over the waves k of Re(d_k (1 + i t)^(2 k)) (1 + t^2)^(degree - k).
    let mut powers = [0.0; MAX_SIZE + 1];
    for k in 0..=degree {
        let (mut real, mut imaginary) = (0.0, 0.0);
        for i in 0..n {
            let [c, s] = table[i * k % n];
            real += samples[i] * c;
            imaginary -= samples[i] * s;
        }
        let [c, s] = cos_sin(k as f64 * start);
        let weight = if k == 0 { 1.0 } else { 2.0 } / n as f64;
        let mut wave = [[0.0; 2]; MAX_SIZE + 1];
        wave[0] = [weight * (real * c - imaginary * s), weight * (real * s + imaginary * c)];
        for length in 0..2 * k {
            for d in (0..=length).rev() {
                let [x, y] = wave[d];
                wave[d + 1][0] -= y;
                wave[d + 1][1] += x;
            }
        }
        for pair in k..degree {
            for d in (0..=2 * pair).rev() {
                wave[d + 2][0] += wave[d][0];
            }
        }
        for (sum, term) in powers.iter_mut().zip(&wave) {
            *sum += term[0];
        }
    }
    powers
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn known_roots_are_found() {
        let mut rng = Seed::new(4).rng();
        for case in 0..500 {
            let degree = 1 + case % MAX_DEGREE;
            let n = 2 * degree + 1;
            let angles: Vec<f64> = (0..2 * degree).map(|_| rng.range(-3.0, 3.0)).collect();
            let mut samples = [0.0; MAX_SAMPLES];
            for (i, x) in samples.iter_mut().enumerate().take(n) {
                let at = core::f64::consts::TAU * i as f64 / n as f64;
                *x = angles.iter().map(|a| (0.5 * (at - a)).sin()).product();
            }
            let mut found = [[0.0; 2]; MAX_SIZE];
            assert_eq!(roots(&samples, degree, &mut found), 2 * degree);
            let slope = |a: f64| -> f64 {
                angles.iter().filter(|b| **b != a).map(|b| (0.5 * (a - b)).sin()).product::<f64>().abs()
            };
            for a in &angles {
                let gap = |r: &[f64; 2]| (0.5 * (r[0] - a)).sin().abs().max(r[1].abs());
                let near = found[..2 * degree].iter().map(gap).fold(9.0, f64::min);
                assert!(near < 1e-13 / slope(*a) + 1e-6 || slope(*a) < 1e-6, "{degree} {near} {}", slope(*a));
            }
        }
    }
}
