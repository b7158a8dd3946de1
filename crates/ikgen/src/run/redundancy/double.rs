//! Numbers of twice as many digits: unevaluated sums of two.
//!
//! Determinants of eliminations are small differences of large products: of sixteen digits some eight are left, of thirty-two more than
//! enough. (Dekker, "A floating-point technique for extending the available precision", 1971; no fused multiplications, so that all
//! machines find the same bits.)

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// `high + low`, where `low` is less than the last place of `high`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Double {
    high: f64,
    low: f64,
}

/// A turn as cosine and sine.
pub(super) type Turn = [Double; 2];

/// A sum, and what rounding took from it.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The upper half of the digits, and the lower one.
fn split(a: f64) -> (f64, f64) {
    let shifted = 134_217_729.0 * a;
    let high = shifted - (shifted - a);
    (high, a - high)
}

/// A product, and what rounding took from it.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

impl Double {
    pub(super) const ZERO: Self = Self { high: 0.0, low: 0.0 };
    pub(super) const ONE: Self = Self { high: 1.0, low: 0.0 };

    /// Of two numbers the first of which is much larger.
    fn of(large: f64, small: f64) -> Self {
        let high = large + small;
        Self { high, low: small - (high - large) }
    }

    /// The nearest number.
    pub(super) fn near(self) -> f64 {
        self.high
    }

    pub(super) fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// Of a positive number; zero of others.
    pub(super) fn sqrt(self) -> Self {
        if !(self.high > 0.0) {
            return Self::ZERO;
        }
        let root = libm::sqrt(self.high);
        let rest = self - Self::from(root) * Self::from(root);
        Self::of(root, rest.high / (2.0 * root))
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = two_sum(self.high, other.high);
        let (rest, last) = two_sum(self.low, other.low);
        let sum = Self::of(high, low + rest);
        Self::of(sum.high, sum.low + last)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (high, low) = two_product(self.high, other.high);
        Self::of(high, low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        Self::of(first, second) + Self::from(rest.high / other.high)
    }
}

impl AddAssign for Double {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Double {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl std::iter::Sum for Double {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::ZERO, |sum, x| sum + x)
    }
}

/// One turn after another.
pub(super) fn both(a: Turn, b: Turn) -> Turn {
    [a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]]
}

/// The turn in the direction of these numbers.
pub(super) fn turn_along(x: f64, y: f64) -> Turn {
    let (x, y) = (Double::from(x), Double::from(y));
    let size = (x * x + y * y).sqrt();
    [x / size, y / size]
}

/// The `count` turns that divide the circle, from none on.
pub(super) fn division(count: usize) -> Vec<Turn> {
    // pi in three parts: a number, and what it lacks.
    let circle = Double { high: std::f64::consts::TAU, low: 2.449_293_598_294_706_4e-16 };
    let angle = circle / Double::from(count as f64);
    // Their series; the first angle may be large, so it is halved before and doubled after.
    let small = angle * Double::from(1.0 / 64.0);
    let (mut term, mut step) = (Double::ONE, [Double::ONE, Double::ZERO]);
    for k in 1..24 {
        term = term * small / Double::from(f64::from(k));
        let sign = if k % 4 < 2 { Double::ONE } else { -Double::ONE };
        step[(k % 2) as usize] += sign * term;
    }
    for _ in 0..6 {
        step = both(step, step);
    }
    let mut all = vec![[Double::ONE, Double::ZERO]];
    for k in 1..count {
        all.push(both(all[k - 1], step));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn digits_are_twice_as_many() {
        let mut rng = Seed::new(6).rng();
        for _ in 0..2000 {
            let mut any = || Double::from(rng.range(-2.0, 2.0)) / Double::from(rng.range(0.5, 3.0));
            let (a, b, c) = (any(), any(), any());
            let least = |x: Double| x.near().abs();
            assert!(least((a + b) - a - b) < 1e-30);
            assert!(least((a + b) * c - a * c - b * c) < 1e-29);
            assert!(least(a / b * b - a) < 1e-29);
            let square = a * a;
            assert!(least(square.sqrt() * square.sqrt() - square) < 1e-29);
        }
    }

    #[test]
    fn a_circle_closes() {
        for count in [1, 2, 3, 19, 27, 54] {
            let turns = division(count);
            let full = both(turns[count - 1], *turns.get(1).unwrap_or(&turns[0]));
            assert!((full[0] - Double::ONE).near().abs() < 1e-29 && full[1].near().abs() < 1e-29);
            for (k, turn) in turns.iter().enumerate() {
                let angle = std::f64::consts::TAU * k as f64 / count as f64;
                assert!((turn[0].near() - angle.cos()).abs() < 1e-15);
                assert!((turn[1].near() - angle.sin()).abs() < 1e-15);
            }
        }
    }
}
