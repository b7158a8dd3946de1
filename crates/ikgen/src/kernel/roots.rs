//! Root finders of the solution language. Angles are unknown through their cosine and sine; no root takes an
//! inverse trigonometric function.

use super::math::{cos_sin, sqrt};

/// Below this a coefficient counts as zero: the equation then says nothing about its unknown.
pub const VANISHING: f64 = 1e-11;

/// An equation that misses its roots by no more than this is taken at the nearest point: the edge of what an arm can do.
pub const EDGE: f64 = 1e-9;

/// How many angles are tried for an unknown that is free.
const REPRESENTATIVES: usize = 32;

/// The k-th of them: zero first, then a half turn, then quarters between, and so on.
fn representative(k: usize) -> [f64; 2] {
    let reversed = ((k as u32).reverse_bits() >> 27) as f64;
    cos_sin(reversed * (core::f64::consts::TAU / 32.0))
}

/// The roots of an equation, at most `N`, each `[cos, sin]` of an angle, or `[length, 0]`.
#[derive(Clone, Copy, Debug)]
pub struct Roots<const N: usize> {
    items: [[f64; 2]; N],
    len: usize,
    /// The unknown is free, or nearly so: later roots are tried only while none has led to a solution.
    pub free: bool,
}

impl<const N: usize> Roots<N> {
    /// No root.
    pub const NONE: Self = Roots { items: [[1.0, 0.0]; N], len: 0, free: false };

    /// Any angle will do.
    pub const ANY_ANGLE: Self = Roots { items: [[1.0, 0.0]; N], len: 0, free: true };

    /// How many roots there are.
    pub fn count(&self) -> usize {
        if self.free { self.len + REPRESENTATIVES } else { self.len }
    }

    /// The same, with room for more.
    pub fn widened<const M: usize>(&self) -> Roots<M> {
        let mut items = [[1.0, 0.0]; M];
        items[..self.len].copy_from_slice(&self.items[..self.len]);
        Roots { items, len: self.len, free: self.free }
    }

    /// One of them.
    pub fn get(&self, i: usize) -> [f64; 2] {
        if i < self.len { self.items[i] } else { representative(i - self.len) }
    }

    /// The same to be tried one after the other, where so many solutions are known.
    pub fn tries(self, accepted: usize) -> Tries<N> {
        Tries { roots: self, accepted, tried: 0 }
    }

    /// Adds one, if there is room.
    pub fn push(&mut self, root: [f64; 2]) {
        if self.len < N {
            self.items[self.len] = root;
            self.len += 1;
        }
    }
}

/// Roots that are tried one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Tries<const N: usize> {
    roots: Roots<N>,
    accepted: usize,
    tried: usize,
}

impl<const N: usize> Tries<N> {
    /// The next root: none after the last, nor where the unknown is free and more solutions are known by now than before the first.
    pub fn next(&mut self, accepted: usize) -> Option<[f64; 2]> {
        if self.tried == self.roots.count() || self.roots.free && accepted > self.accepted {
            return None;
        }
        self.tried += 1;
        Some(self.roots.get(self.tried - 1))
    }
}

/// The angle whose cosine and sine are proportional to `x` and `y`.
///
/// These are products of two vectors that vanish together where the angle is free: up to there they tell it, however small they are.
pub fn align(x: f64, y: f64, slack: f64) -> Roots<1> {
    let n = sqrt(x * x + y * y);
    if !(x.abs() + y.abs() < f64::INFINITY) {
        return Roots::NONE;
    }
    if n < VANISHING * VANISHING {
        return Roots::ANY_ANGLE;
    }
    let mut roots = Roots::NONE;
    roots.free = n < VANISHING || n < slack;
    roots.push([x / n, y / n]);
    roots
}

/// The two angles whose cosine is proportional to `x` and sine to plus or minus `y`.
pub fn mirror(x: f64, y: f64, slack: f64) -> Roots<2> {
    let mut roots: Roots<2> = half(x, y, slack).widened();
    if roots.len > 0 && roots.items[0][1] > VANISHING {
        roots.push([roots.items[0][0], -roots.items[0][1]]);
    }
    roots
}

/// Of the two angles of [`mirror`] the one whose sine is positive.
pub fn half(x: f64, y: f64, slack: f64) -> Roots<1> {
    let n = sqrt(x * x + y * y);
    if !(x.abs() + y.abs() < f64::INFINITY) {
        return Roots::NONE;
    }
    if n < VANISHING {
        return Roots::ANY_ANGLE;
    }
    let mut roots = Roots::NONE;
    roots.push([x / n, apart(y.abs() / n, slack / n)]);
    roots
}

/// The sine at which two roots that nearly fall together are started. The ideal chain says where they meet only up to
/// `slack`; from the meeting point itself a polish could find neither.
fn apart(sine: f64, slack: f64) -> f64 {
    let least = sqrt(2.0 * slack);
    if sine < least { if least < 0.2 { least } else { 0.2 } } else { sine }
}

/// The angles with `a cos + b sin = d`.
///
/// When the line misses the unit circle by no more than [`EDGE`] and `slack` the nearest angle is given: such poses are at the
/// edge of what the arm can do, and the check of solutions decides.
pub fn circle(a: f64, b: f64, d: f64, slack: f64) -> Roots<2> {
    let n = sqrt(a * a + b * b);
    if !(a.abs() + b.abs() < f64::INFINITY) {
        return Roots::NONE;
    }
    if n < VANISHING {
        return if d.abs() <= EDGE + slack { Roots::ANY_ANGLE } else { Roots::NONE };
    }
    let miss = d.abs() - n;
    if !(miss <= EDGE + slack) {
        return Roots::NONE;
    }
    let (x, y) = (a / n, b / n);
    let c = if miss < 0.0 { d / n } else { 1f64.copysign(d) };
    // (1 - c)(1 + c) keeps the digits that 1 - c * c loses near the edge.
    let s = apart(sqrt((1.0 - c) * (1.0 + c)), slack / n);
    let mut roots = Roots::NONE;
    roots.push([c * x - s * y, c * y + s * x]);
    if s > 0.0 {
        roots.push([c * x + s * y, c * y - s * x]);
    }
    roots
}

/// The lengths with `a t^2 + b t + c = 0`; a discriminant that misses zero by `slack` counts as zero.
pub fn quadratic(a: f64, b: f64, c: f64, slack: f64) -> Roots<2> {
    let mut roots = Roots::NONE;
    if a.abs() < VANISHING {
        if b.abs() >= VANISHING {
            roots.push([-c / b, 0.0]);
        } else if c.abs() <= EDGE + slack {
            roots.push([0.0, 0.0]);
        }
        return roots;
    }
    let (half, product) = (-0.5 * b / a, c / a);
    let discriminant = half * half - product;
    if !(discriminant >= -EDGE - slack) {
        return roots;
    }
    let root = sqrt(discriminant);
    let far = if half < 0.0 { half - root } else { half + root };
    roots.push([far, 0.0]);
    if root > 0.0 && far != 0.0 {
        roots.push([product / far, 0.0]);
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circle_at_its_edge_and_without_information() {
        fn all<const N: usize>(r: Roots<N>) -> Vec<[f64; 2]> {
            (0..r.count()).map(|i| r.get(i)).collect()
        }
        assert_eq!(all(circle(1.0, 0.0, 1.0 + 1e-12, 0.0)), [[1.0, 0.0]]);
        assert_eq!(circle(1.0, 0.0, 1.0 + 1e-5, 1e-4).count(), 2);
        assert_eq!(circle(1.0, 0.0, 1.1, 1e-9).count(), 0);
        assert!(circle(0.0, 0.0, 0.0, 0.0).free && align(0.0, 0.0, 0.0).count() == 32);
        assert_eq!(circle(f64::NAN, 0.0, 0.0, 1e-9).count(), 0);
        assert_eq!(all(quadratic(1.0, -3.0, 2.0, 0.0)), [[2.0, 0.0], [1.0, 0.0]]);
    }
}
