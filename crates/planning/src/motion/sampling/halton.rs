//! A sequence that fills the space evenly (Halton, "On the efficiency of certain quasi-random sequences of points", 1960), moved by
//! a random shift so that every run of a search has another one (Cranley and Patterson, 1976).

use std::f64::consts::PI;

use robotc_core::Seed;
use robotc_core::rng::Rng;

use super::{Growth, Sampler, Sampling};
use crate::space::Space;

pub(super) const HALTON: Sampling = Sampling {
    name: "halton",
    summary: "A Halton sequence, which fills the space more evenly than chance, with a random shift.",
    make: |space, seed| Box::new(Halton::new(space, seed)),
};

/// A coordinate's base, the number of the last state in it, and what is added to its fractions.
struct Digits {
    base: u32,
    shift: f64,
}

struct Halton {
    digits: Vec<Digits>,
    drawn: u32,
}

impl Halton {
    fn new(space: &Space, seed: Seed) -> Self {
        let mut rng = seed.rng();
        let mut digits: Vec<Digits> = Vec::with_capacity(space.dimension());
        let mut next = 2;
        while digits.len() < space.dimension() {
            if digits.iter().all(|d| next % d.base != 0) {
                digits.push(Digits { base: next, shift: rng.unit() });
            }
            next += 1;
        }
        Self { digits, drawn: 0 }
    }
}

impl Sampler for Halton {
    fn draw(&mut self, growth: &mut Growth<'_>, _: &mut Rng, sample: &mut [f64]) {
        self.drawn = self.drawn.wrapping_add(1);
        for ((x, axis), digits) in sample.iter_mut().zip(growth.space.axes()).zip(&self.digits) {
            let fraction = reversed(self.drawn, digits.base) + digits.shift;
            let (low, high) = if axis.wraps { (-PI, PI) } else { (axis.lower, axis.upper) };
            *x = low + (high - low) * (fraction - fraction.floor());
        }
    }
}

/// The digits of a number in a base, mirrored at the point: in [0, 1).
fn reversed(mut number: u32, base: u32) -> f64 {
    let share = 1.0 / f64::from(base);
    let (mut value, mut place) = (0.0, share);
    while number > 0 {
        value += place * f64::from(number % base);
        number /= base;
        place *= share;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_mirrored_at_the_point() {
        let of = |base| (1..=5).map(|n| reversed(n, base)).collect::<Vec<_>>();
        assert_eq!(of(2), [0.5, 0.25, 0.75, 0.125, 0.625]);
        assert!((reversed(7, 3) - (1.0 / 3.0 + 2.0 / 9.0)).abs() < 1e-15);
        let bases = Halton::new(&Space::new(vec![crate::space::Axis::wrapping(); 8]), Seed::new(1)).digits;
        assert_eq!(bases.iter().map(|d| d.base).collect::<Vec<_>>(), [2, 3, 5, 7, 11, 13, 17, 19]);
    }
}
