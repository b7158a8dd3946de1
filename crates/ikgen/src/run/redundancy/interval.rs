//! Arithmetic on intervals: every result holds all values that its operands may give, rounding included.

use std::f64::consts::{PI, TAU};

/// All numbers from `low` to `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval {
    pub(super) low: f64,
    pub(super) high: f64,
}

/// Not the same for all values of an interval, or not known to be.
pub(super) struct Undecided;

impl Interval {
    pub(super) const fn point(x: f64) -> Self {
        Self { low: x, high: x }
    }

    /// From `low` to `high`, and what rounding may have cut off.
    fn outward(low: f64, high: f64) -> Self {
        Self { low: low.next_down(), high: high.next_up() }
    }

    /// The smallest interval that holds both.
    pub(super) fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// What both hold; they are bounds of the same values.
    pub(super) fn common(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    pub(super) fn holds(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    pub(super) fn middle(self) -> f64 {
        0.5 * (self.low + self.high)
    }

    pub(super) fn width(self) -> f64 {
        self.high - self.low
    }

    /// With `by` more on both sides.
    pub(super) fn wider(self, by: f64) -> Self {
        if by == 0.0 { self } else { Self::outward(self.low - by, self.high + by) }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self::outward(self.low + other.low, self.high + other.high)
    }

    pub(super) fn minus(self, other: Self) -> Self {
        Self::outward(self.low - other.high, self.high - other.low)
    }

    pub(super) fn negated(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }

    pub(super) fn times(self, other: Self) -> Self {
        // Zero times what is not bounded is still zero.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let all = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        let low = all.iter().copied().fold(f64::INFINITY, f64::min);
        let high = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if low == 0.0 && high == 0.0 { Self::point(0.0) } else { Self::outward(low, high) }
    }

    pub(super) fn over(self, other: Self) -> Self {
        if other.holds(0.0) {
            return Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        self.times(Self::outward(1.0 / other.high, 1.0 / other.low))
    }

    pub(super) fn square(self) -> Self {
        let (a, b) = (self.low * self.low, self.high * self.high);
        let least = if self.holds(0.0) { 0.0 } else { a.min(b).next_down() };
        Self { low: least, high: a.max(b).next_up() }
    }

    pub(super) fn magnitude(self) -> Self {
        if self.holds(0.0) {
            Self { low: 0.0, high: self.high.max(-self.low) }
        } else if self.low > 0.0 {
            self
        } else {
            self.negated()
        }
    }

    /// Square root of the positive part.
    pub(super) fn sqrt(self) -> Self {
        let root = |x: f64| libm::sqrt(x.max(0.0));
        Self { low: root(self.low).next_down().max(0.0), high: root(self.high).next_up() }
    }

    pub(super) fn cos(self) -> Self {
        if !(self.width() < TAU) {
            return Self { low: -1.0, high: 1.0 };
        }
        let (a, b) = (libm::cos(self.low), libm::cos(self.high));
        // Whether a multiple of 2 pi, moved by `shift`, lies inside.
        let passes = |shift: f64| {
            ((self.high - shift) / TAU + 1e-12).floor() >= ((self.low - shift) / TAU - 1e-12).ceil()
        };
        let low = if passes(PI) { -1.0 } else { (a.min(b) - 1e-15).max(-1.0) };
        let high = if passes(0.0) { 1.0 } else { (a.max(b) + 1e-15).min(1.0) };
        Self { low, high }
    }

    pub(super) fn sin(self) -> Self {
        self.minus(Self::point(std::f64::consts::FRAC_PI_2)).cos()
    }

    /// Angle whose cosine is in this interval, 0 to pi.
    pub(super) fn acos(self) -> Self {
        let low = libm::acos(self.high.clamp(-1.0, 1.0));
        let high = libm::acos(self.low.clamp(-1.0, 1.0));
        Self { low: (low - 2e-15).max(0.0), high: high + 2e-15 }
    }
}

/// The angles of the vectors of a box, around a middle in (-pi, pi]; `None` when the box may hold the origin.
pub(super) fn angle_of_box(x: Interval, y: Interval) -> Option<Interval> {
    if x.holds(0.0) && y.holds(0.0) || !(x.width() + y.width() < f64::INFINITY) {
        return None;
    }
    let (cx, cy) = (x.middle(), y.middle());
    let middle = libm::atan2(cy, cx);
    let mut around = Interval::point(0.0);
    for (px, py) in [(x.low, y.low), (x.low, y.high), (x.high, y.low), (x.high, y.high)] {
        // The box is on one side of a line through the origin, so that all angles to its middle are less than pi.
        let angle = libm::atan2(cx * py - cy * px, cx * px + cy * py);
        around = around.hull(Interval::point(angle));
    }
    Some(around.wider(1e-15).plus(Interval::point(middle)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn every_result_holds_the_results_of_points() {
        let mut rng = Seed::new(8).rng();
        for _ in 0..20_000 {
            let mut any = |size: f64| {
                let low = rng.range(-size, size);
                Interval { low, high: low + size * rng.unit().powi(4) }
            };
            let (a, b) = (any(2.0), any(7.0));
            let x = rng.range(a.low, a.high);
            let y = rng.range(b.low, b.high);
            assert!(a.plus(b).holds(x + y) && a.minus(b).holds(x - y) && a.times(b).holds(x * y));
            assert!(a.over(b).holds(x / y) && a.square().holds(x * x) && a.magnitude().holds(x.abs()));
            assert!(b.cos().holds(y.cos()) && b.sin().holds(y.sin()) && a.sqrt().holds(x.max(0.0).sqrt()));
            assert!(a.acos().holds(x.clamp(-1.0, 1.0).acos()));
            if let Some(angles) = angle_of_box(a, b) {
                let angle = y.atan2(x);
                assert!([angle, angle + TAU, angle - TAU].iter().any(|t| angles.holds(*t)), "{a:?} {b:?}");
                assert!(angles.width() < PI);
            }
        }
    }
}
