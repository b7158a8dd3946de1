//! A smooth function on an interval, as a polynomial that is as good, and the roots of that.
//!
//! The function is sampled at Chebyshev nodes. Where the last coefficients of its Chebyshev series are rounding the polynomial through
//! the samples is the function to as many digits, and its roots are eigenvalues of the colleague matrix (Good, 1961; Boyd, "Computing
//! zeros on a real interval through Chebyshev expansion and polynomial rootfinding", 2002).

use super::eigen::{MAX_SIZE, Square, hessenberg_eigenvalues};
use super::math::{cos_sin, sqrt};

/// Degree of the polynomial.
const DEGREE: usize = MAX_SIZE;

/// Number of samples.
const NODES: usize = DEGREE + 1;

/// Cosines of the multiples of the angle between half a node and the next.
pub type Cosines = [f64; 4 * NODES];

/// The table that all intervals share.
pub fn cosines() -> Cosines {
    let mut table = [0.0; 4 * NODES];
    for (m, x) in table.iter_mut().enumerate() {
        *x = cos_sin(m as f64 * (core::f64::consts::PI / (2 * NODES) as f64))[0];
    }
    table
}

/// A function on an interval.
pub struct Piece {
    /// Coefficients of Chebyshev's polynomials.
    a: [f64; NODES],
    centre: f64,
    /// Half of the width.
    pub half: f64,
    /// Largest coefficient in magnitude.
    pub largest: f64,
    /// Largest sample in magnitude of that third of the samples where they are smallest, as part of the largest one of all.
    pub even: f64,
}

impl Piece {
    /// A function of an interval of this width, from `start` on.
    pub fn new(table: &Cosines, start: f64, width: f64, mut value: impl FnMut(f64) -> f64) -> Piece {
        let half = 0.5 * width;
        let centre = start + half;
        let mut samples = [0.0; NODES];
        for (k, sample) in samples.iter_mut().enumerate() {
            *sample = value(centre + half * table[2 * k + 1]);
        }
        let (mut least, mut most) = (f64::INFINITY, 0.0f64);
        for third in samples.chunks(NODES / 3 + 1) {
            let mut size = 0.0f64;
            for sample in third {
                size = size.max(sample.abs());
            }
            least = least.min(size);
            most = most.max(size);
        }
        let mut a = [0.0; NODES];
        let mut largest = 0.0f64;
        for (j, x) in a.iter_mut().enumerate() {
            for (k, sample) in samples.iter().enumerate() {
                *x += sample * table[j * (2 * k + 1) % (4 * NODES)];
            }
            *x *= if j == 0 { 1.0 } else { 2.0 } / NODES as f64;
            largest = largest.max(x.abs());
        }
        Piece { a, centre, half, largest, even: least / most }
    }

    /// Whether a value is on the interval, or as near to it as `margin`.
    pub fn reaches(&self, value: f64, margin: f64) -> bool {
        (value - self.centre).abs() <= self.half + margin
    }

    /// The last coefficients: what the polynomial may be off.
    pub fn rest(&self) -> f64 {
        self.a[DEGREE - 1].abs() + self.a[DEGREE].abs()
    }

    /// The slope at a place of the interval.
    pub fn slope(&self, x: f64) -> f64 {
        // Chebyshev's polynomials have the derivatives k U(k - 1).
        let t = (x - self.centre) / self.half;
        let (mut before, mut u, mut sum) = (0.0, 1.0, 0.0);
        for (k, a) in self.a.iter().enumerate().skip(1) {
            sum += a * k as f64 * u;
            (before, u) = (u, 2.0 * t * u - before);
        }
        sum / self.half
    }

    /// Places and imaginary parts of the roots on the interval, or as near to it as `margin`, with imaginary parts up to `height`; returns
    /// how many there are.
    pub fn roots(&self, margin: f64, height: f64, found: &mut [[f64; 2]; MAX_SIZE]) -> usize {
        let mut others = 0.0;
        for x in &self.a[1..] {
            others += x.abs();
        }
        if !(self.largest > 0.0 && self.largest < f64::INFINITY) || self.a[0].abs() > 1.01 * others {
            return 0;
        }
        // What is less is rounding.
        let least = 1e-14 * self.largest;
        let last = if self.a[DEGREE].abs() > least { self.a[DEGREE] } else { least };
        // The basis is scaled by powers of the sixteenth root, which balances the matrix.
        let base = sqrt(sqrt(sqrt(sqrt(self.largest / last.abs()))));
        let mut colleague: Square = [[0.0; MAX_SIZE]; MAX_SIZE];
        let mut power = 1.0;
        for k in (0..DEGREE).rev() {
            colleague[k][DEGREE - 1] = -0.5 * self.a[k] / last * power;
            power /= base;
        }
        for k in 1..DEGREE {
            colleague[k][k - 1] += if k == 1 { base } else { 0.5 * base };
            colleague[k - 1][k] += 0.5 / base;
        }
        let mut values = [[0.0; 2]; MAX_SIZE];
        let count = hessenberg_eigenvalues(&mut colleague, DEGREE, &mut values);
        let mut kept = 0;
        for [x, y] in &values[..count] {
            let [x, y] = [self.half * x, self.half * y];
            if x.abs() <= self.half + margin && y.abs() <= height {
                found[kept] = [self.centre + x, y];
                kept += 1;
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn roots_of_smooth_functions_are_found() {
        let mut rng = Seed::new(3).rng();
        let table = cosines();
        let mut found = [[0.0; 2]; MAX_SIZE];
        for _ in 0..500 {
            let roots: [f64; 6] = core::array::from_fn(|_| rng.range(0.5, 0.9));
            let value = |x: f64| roots.iter().map(|r| (x - r).sin()).product::<f64>() * (0.3 * x).exp();
            let piece = Piece::new(&table, 0.5, 0.4, value);
            assert!(piece.rest() < 1e-9 * piece.largest);
            let h = 1e-6;
            assert!((piece.slope(0.7) - (value(0.7 + h) - value(0.7 - h)) / (2.0 * h)).abs() < 1e-8);
            let count = piece.roots(1e-2, 1e-2, &mut found);
            for r in &roots {
                let slope: f64 = roots.iter().filter(|s| *s != r).map(|s| (r - s).sin().abs()).product();
                let near = found[..count].iter().map(|[x, y]| (x - r).abs() + y.abs()).fold(9.0, f64::min);
                assert!(near < 1e-13 / slope || slope < 1e-9, "{near:e} {slope:e}");
            }
        }
        assert_eq!(Piece::new(&table, 0.0, 1.0, |x| 2.0 + x).roots(1e-3, 1e-3, &mut found), 0);
        assert!(Piece::new(&table, 0.0, 1.0, |x| (60.0 * x).sin()).rest() > 0.1);
    }
}
