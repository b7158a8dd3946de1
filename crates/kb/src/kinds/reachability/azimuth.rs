//! Sets of azimuths about an arm's first axis, as unions of equal sectors.

use std::f64::consts::TAU;

use robotc_core::so3::turn_of;
use serde::{Deserialize, Serialize};

/// Number of sectors of a turn.
pub const SECTORS: u32 = u32::BITS;

/// A set of sectors: bit s stands for the azimuths from s to s + 1 times 2 pi / [`SECTORS`], counted from the x axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Sectors(pub u32);

impl Sectors {
    /// The whole turn.
    pub const ALL: Self = Self(u32::MAX);
    /// No sector.
    pub const NONE: Self = Self(0);

    /// The sector of an azimuth, radians.
    pub fn at(azimuth: f64) -> Self {
        let turns = azimuth / TAU;
        let sector = ((turns - libm::floor(turns)) * f64::from(SECTORS)) as u32;
        Self(1 << sector.min(SECTORS - 1))
    }

    /// The sector of the direction of (x, y), good to 1e-7 radians: faster than [`at`](Self::at).
    pub fn towards(y: f64, x: f64) -> Self {
        let sector = (turn_of(y, x) * f64::from(SECTORS)) as u32;
        Self(1 << (sector % SECTORS))
    }

    /// The sectors that lie in an arc as a whole, and those that touch it. The arc starts at an azimuth and has a length,
    /// both in radians.
    pub fn of_arc(start: f64, length: f64) -> (Self, Self) {
        if length.is_nan() || length < 0.0 {
            return (Self::NONE, Self::NONE);
        }
        let width = TAU / f64::from(SECTORS);
        let turns = start / TAU;
        let from = (turns - libm::floor(turns)) * f64::from(SECTORS);
        let to = from + (length / width).min(2.0 * f64::from(SECTORS));
        (Self::run(from.ceil(), to.floor()), Self::run(from.floor(), to.ceil()))
    }

    fn run(first: f64, end: f64) -> Self {
        let count = end - first;
        if count <= 0.0 {
            Self::NONE
        } else if count >= f64::from(SECTORS) {
            Self::ALL
        } else {
            Self(((1_u32 << count as u32) - 1).rotate_left(first as u32 % SECTORS))
        }
    }

    /// Those in either.
    pub fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Those in both.
    pub fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether all of `other` are among these.
    pub fn contains(self, other: Self) -> bool {
        other.0 & !self.0 == 0
    }

    /// These and their neighbours.
    pub fn widened(self) -> Self {
        Self(self.0 | self.0.rotate_left(1) | self.0.rotate_right(1))
    }

    /// Number of sectors.
    pub fn count(self) -> u32 {
        self.0.count_ones()
    }

    /// Azimuths of the centres of the sectors, radians in (0, 2 pi), with the sectors.
    pub fn centres(self) -> impl Iterator<Item = (Self, f64)> {
        let centre = |s: u32| (Self(1 << s), (f64::from(s) + 0.5) * TAU / f64::from(SECTORS));
        (0..SECTORS).filter(move |s| self.0 >> s & 1 == 1).map(centre)
    }

    /// Azimuth of the centre of the `index`-th of them, counted from zero; of the last one when there are not as many.
    pub(super) fn nth(self, index: u32) -> f64 {
        let mut rest = self.0;
        for _ in 0..index.min(self.count().saturating_sub(1)) {
            rest &= rest - 1;
        }
        (f64::from(rest.trailing_zeros()) + 0.5) * TAU / f64::from(SECTORS)
    }

    /// As arcs: start and end in radians, start in [0, 2 pi), end above start; ascending. An arc over zero is one arc.
    pub fn arcs(self) -> Vec<(f64, f64)> {
        if self == Self::ALL {
            return vec![(0.0, TAU)];
        }
        let angle = |s: u32| f64::from(s) * TAU / f64::from(SECTORS);
        let has = |s: u32| self.0 >> (s % SECTORS) & 1 == 1;
        let starts = (0..SECTORS).filter(|&s| has(s) && !has(s + SECTORS - 1));
        starts.map(|s| (angle(s), angle((s..).find(|&e| !has(e)).expect("not all are in the set")))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcs_hold_the_sectors_within_and_reach_those_they_touch() {
        let width = TAU / f64::from(SECTORS);
        for (start, length) in
            [(0.0, 1.0), (0.3, 0.1), (-2.0, 5.2), (6.2, 0.3), (1.0, 6.2), (3.0, 7.0), (1.0, 0.0)]
        {
            let (inner, outer) = Sectors::of_arc(start, length);
            assert!(outer.contains(inner));
            for s in 0..SECTORS {
                let inside = |a: f64| (a - start).rem_euclid(TAU) <= length;
                let samples: Vec<bool> = (0..=100)
                    .map(|k| inside((f64::from(s) + 0.001 + 0.00998 * f64::from(k)) * width))
                    .collect();
                let bit = Sectors(1 << s);
                assert!(!inner.contains(bit) || samples.iter().all(|x| *x), "{start} {length} {s}");
                assert!(outer.contains(bit) || !samples.iter().any(|x| *x), "{start} {length} {s}");
            }
        }
        assert_eq!(Sectors::of_arc(1.0, f64::INFINITY), (Sectors::ALL, Sectors::ALL));
    }

    #[test]
    fn sets_are_unions_of_arcs() {
        let set = Sectors(0b1000_0000_0000_0000_0000_0000_0110_0001);
        let width = TAU / 32.0;
        assert_eq!(set.arcs(), [(5.0 * width, 7.0 * width), (31.0 * width, 33.0 * width)]);
        assert_eq!(Sectors::ALL.arcs(), [(0.0, TAU)]);
        assert!(Sectors::NONE.arcs().is_empty());
        for (sector, azimuth) in set.centres() {
            assert_eq!(Sectors::at(azimuth), sector);
            assert_eq!(Sectors::at(azimuth - TAU), sector);
            assert_eq!(Sectors::towards(3.0 * azimuth.sin(), 3.0 * azimuth.cos()), sector);
        }
        assert_eq!(set.widened().count(), 8);
        for (k, (_, azimuth)) in (0..).zip(set.centres()) {
            assert_eq!(set.nth(k), azimuth);
        }
    }
}
