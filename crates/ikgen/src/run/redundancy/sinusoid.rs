//! Functions `still + cos * cos(psi) + sin * sin(psi)` of one angle: what a turn about a fixed line makes of every number that is linear in
//! a rotation.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

/// Roots that rounding has just removed count, relative to the size of the wave.
const TOUCHING: f64 = 1e-12;

/// Roots that touch within this, relative to the size of the wave, are one.
const DOUBLE: f64 = 1e-14;

/// A wave smaller than this is none: the function is constant.
const CONSTANT: f64 = 1e-13;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sinusoid {
    pub(super) still: f64,
    pub(super) cos: f64,
    pub(super) sin: f64,
}

impl Sinusoid {
    pub(super) const fn constant(still: f64) -> Self {
        Self { still, cos: 0.0, sin: 0.0 }
    }

    pub(super) fn at(self, psi: f64) -> f64 {
        self.still + self.cos * libm::cos(psi) + self.sin * libm::sin(psi)
    }

    pub(super) fn slope(self) -> Self {
        Self { still: 0.0, cos: self.sin, sin: -self.cos }
    }

    pub(super) fn times(self, factor: f64) -> Self {
        Self { still: self.still * factor, cos: self.cos * factor, sin: self.sin * factor }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self { still: self.still + other.still, cos: self.cos + other.cos, sin: self.sin + other.sin }
    }

    pub(super) fn minus(self, other: Self) -> Self {
        self.plus(other.times(-1.0))
    }

    pub(super) fn is_constant(self) -> bool {
        libm::hypot(self.cos, self.sin) < CONSTANT
    }

    /// Where it is largest, and half a turn on, where it is smallest.
    pub(super) fn extrema(self) -> [f64; 2] {
        let top = libm::atan2(self.sin, self.cos);
        [top, if top > 0.0 { top - PI } else { top + PI }]
    }

    /// Its roots in [-pi, pi]: none or two, which are one where it touches zero; none of a constant.
    pub(super) fn roots(self) -> Vec<f64> {
        let size = libm::hypot(self.cos, self.sin);
        let ratio = -self.still / size;
        if size < CONSTANT || ratio.abs() > 1.0 + TOUCHING {
            return Vec::new();
        }
        // Rounding splits a double root by its square root.
        let ratio = if 1.0 - ratio.abs() < DOUBLE { ratio.signum() } else { ratio };
        let (middle, half) = (libm::atan2(self.sin, self.cos), libm::acos(ratio));
        vec![principal(middle + half), principal(middle - half)]
    }
}

/// The same angle in [-pi, pi].
pub(super) fn principal(angle: f64) -> f64 {
    if (-PI..=PI).contains(&angle) { angle } else { angle - 2.0 * PI * libm::round(angle / (2.0 * PI)) }
}

/// Rotations whose entries are sinusoids.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turning {
    pub(super) still: Matrix3<f64>,
    pub(super) cos: Matrix3<f64>,
    pub(super) sin: Matrix3<f64>,
}

impl Turning {
    /// Turns about `axis` (a unit vector) after `first`.
    pub(super) fn about(axis: &Vector3<f64>, first: &Matrix3<f64>) -> Self {
        let along = axis * axis.transpose();
        Self {
            still: along * first,
            cos: (Matrix3::identity() - along) * first,
            sin: axis.cross_matrix() * first,
        }
    }

    fn map(&self, f: impl Fn(&Matrix3<f64>) -> Matrix3<f64>) -> Self {
        Self { still: f(&self.still), cos: f(&self.cos), sin: f(&self.sin) }
    }

    /// `left` times the opposite of these rotations times `right`.
    pub(super) fn back_between(&self, left: &Matrix3<f64>, right: &Matrix3<f64>) -> Self {
        self.map(|m| left * m.transpose() * right)
    }

    /// `left . R right`.
    pub(super) fn form(&self, left: &Vector3<f64>, right: &Vector3<f64>) -> Sinusoid {
        let of = |m: &Matrix3<f64>| left.dot(&(m * right));
        Sinusoid { still: of(&self.still), cos: of(&self.cos), sin: of(&self.sin) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn roots_and_extrema_are_where_they_are_said_to_be() {
        let mut rng = Seed::new(6).rng();
        let mut with_roots = 0;
        for _ in 0..1000 {
            let mut any = || rng.range(-1.0, 1.0);
            let wave = Sinusoid { still: any(), cos: any(), sin: any() };
            let [top, bottom] = wave.extrema();
            assert!(wave.slope().at(top).abs() < 1e-14 && wave.at(top) > wave.at(bottom));
            let roots = wave.roots();
            assert_eq!(roots.is_empty(), wave.at(top) * wave.at(bottom) > 0.0);
            assert!(roots.iter().all(|psi| wave.at(*psi).abs() < 1e-14 && psi.abs() <= PI));
            with_roots += roots.len();
            // Moved until it touches zero.
            let touching = Sinusoid { still: wave.still - wave.at(top), ..wave };
            assert!(touching.roots().iter().all(|psi| principal(psi - top).abs() < 1e-5));
            assert_eq!(touching.roots().len(), 2);
        }
        assert!(with_roots > 500);
        assert!(Sinusoid::constant(0.0).roots().is_empty());
    }
}
