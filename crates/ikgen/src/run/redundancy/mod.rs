//! The values of a free variable for which a pose has solutions within limits: intervals, not a grid.
//!
//! The range of the variable is cut into cells. On each the solution program is run with intervals in place of numbers: a cell on which
//! one branch keeps to the limits belongs to the set, one on which every branch leaves them or has lost its roots does not, and any
//! other is halved. What is left in the end are cells narrower than [`RedundancyOptions::width`] around the ends of the set: where a joint
//! comes to a limit, and where two branches fold into each other. There the solver itself finds the place. So nothing wider than that
//! can have been missed. (The free joint of section 4.1 of Diankov's thesis, stepped there.)
//!
//! With a spherical shoulder and a spherical wrist the set is known in closed form ([`Solver::swivel`]), and complete.
//!
//! The general solver of six joints is not made of equations with one unknown. With it, and where bounds say too little, seven turning joints
//! are cut where branches may meet (`general`) and where a joint comes to a limit; of other chains only points can be tried, and the
//! result says so.

// `!(x < y)` is meant: a NaN must count as too large.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod bounds;
mod determinant;
mod double;
mod general;
mod interval;
mod pick;
mod search;
mod sinusoid;
mod spherical;
mod swivel;
mod trigonometric;
mod two_angles;

use std::f64::consts::PI;

use robotc_core::Pose;
use robotc_core::ik::{PreferenceError, Preferences, VariableRange};
use robotc_core::model::ChainMotion;
use robotc_core::rng::Rng;

pub use self::spherical::Side;
pub use self::swivel::SwivelBranch;

use self::search::{POINTS, Search, widest_unknown};
use super::Solver;
use crate::ir::RootKind;

/// Cells of unknown state that are wider than this are looked at in another way, if there is one; radians.
const NARROW: f64 = 1e-4;

/// Choices of [`Solver::free_intervals`].
#[derive(Debug, Clone, PartialEq)]
pub struct RedundancyOptions {
    /// Cells of the free value are cut down to this, radians or metres.
    pub width: f64,
    /// Cells that are looked at, at most.
    pub cells: usize,
}

impl Default for RedundancyOptions {
    fn default() -> Self {
        Self { width: 1e-6, cells: 4000 }
    }
}

/// What is known of intervals of the free value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Completeness {
    /// Exactly these values, but for rounding.
    Complete,
    /// Every value outside of them has no solution, but for cells narrower than this that hold an end of an interval or a singular
    /// pose.
    ToWidth(f64),
    /// Found by trying points this far apart: a narrower interval, or a narrower gap, may have been missed.
    Sampled(f64),
}

impl std::fmt::Display for Completeness {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Complete => f.write_str("complete"),
            Self::ToWidth(width) => write!(f, "complete to width {width:.0e}"),
            Self::Sampled(step) => write!(f, "sampled in steps of {step:.1e}"),
        }
    }
}

/// Values of a free variable for which a pose has solutions.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeIntervals {
    /// Lower and upper ends, ascending, apart from each other; within the limits of the variable, or in [-pi, pi] when it turns without
    /// end.
    pub intervals: Vec<[f64; 2]>,
    /// What is known of the rest.
    pub completeness: Completeness,
    range: VariableRange,
}

impl FreeIntervals {
    /// Whether no value has a solution.
    pub fn is_empty(&self) -> bool {
        self.intervals.is_empty()
    }

    /// All values together, radians or metres.
    pub fn measure(&self) -> f64 {
        self.intervals.iter().map(|[low, high]| high - low).sum()
    }

    /// Whether a value is in one of them.
    pub fn contains(&self, value: f64) -> bool {
        self.intervals.iter().any(|[low, high]| *low <= value && value <= *high)
    }

    /// The value in one of them that is nearest to `seed`; the short way round when the variable turns without end.
    pub fn nearest(&self, seed: f64) -> Option<f64> {
        let seed = self.range.nearest(seed, 0.0).unwrap_or(seed);
        let near = |[low, high]: &[f64; 2]| {
            if *low <= seed && seed <= *high {
                seed
            } else if self.range.distance(*low, seed) <= self.range.distance(*high, seed) {
                *low
            } else {
                *high
            }
        };
        let all = self.intervals.iter().map(near);
        all.min_by(|a, b| self.range.distance(*a, seed).total_cmp(&self.range.distance(*b, seed)))
    }

    /// `count` values spread evenly over their lengths, ascending.
    pub fn spread(&self, count: usize) -> Vec<f64> {
        let step = self.measure() / count.max(1) as f64;
        (0..count).filter_map(|k| self.at(step * (k as f64 + 0.5))).collect()
    }

    /// A value drawn evenly from them.
    pub fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let part = rng.unit();
        self.at(part * self.measure())
    }

    /// The value up to which they measure `length`.
    fn at(&self, mut length: f64) -> Option<f64> {
        for [low, high] in &self.intervals {
            if length <= high - low {
                return Some(low + length);
            }
            length -= high - low;
        }
        self.intervals.last().map(|[_, high]| *high)
    }
}

impl Solver {
    /// The values of the `k`-th free variable for which the pose has solutions that keep the limits of `preferences`; the other free
    /// variables have the values in `free`.
    ///
    /// Panics unless `free` has a value for each free variable and `k` is one of them.
    pub fn free_intervals(
        &self,
        base_from_tip: &Pose,
        free: &[f64],
        k: usize,
        preferences: &Preferences,
        options: &RedundancyOptions,
    ) -> Result<FreeIntervals, PreferenceError> {
        let program = self.program();
        assert!(k < free.len() && free.len() == program.free.len(), "one value for each free variable");
        let ranges = preferences.ranges(self.ranges())?;
        if !(options.width > 0.0) {
            return Err(PreferenceError::Value("width"));
        }
        let range = ranges.get(program.free[k]).copied().unwrap_or(VariableRange {
            motion: ChainMotion::Prismatic,
            lower: -1.0,
            upper: 1.0,
        });
        if let [own] = program.free[..]
            && let Some(branches) = self.swivel_within(base_from_tip, &ranges)
        {
            let all = branches.iter().flat_map(|branch| branch.joint_intervals(own)).collect();
            return Ok(FreeIntervals { intervals: united(all), completeness: Completeness::Complete, range });
        }
        let (low, high) = match range.motion {
            _ if range.is_continuous() => (-PI, PI),
            ChainMotion::Revolute => (range.lower.max(-2.0 * PI), range.upper.min(2.0 * PI)),
            ChainMotion::Prismatic => (range.lower.max(-100.0), range.upper.min(100.0)),
        };
        let search = Search {
            solver: self,
            base_from_tip,
            free,
            k,
            ranges: &ranges,
            first: Preferences { max_solutions: 1, near: None, ..preferences.clone() },
        };
        // Roots of eight waves take long to bound, six joints at once cannot be.
        let jointly = program.uses(RootKind::Six) || program.uses(RootKind::Sweep);
        let general = jointly || program.uses(RootKind::Octic);
        let width = options.width.max(100.0 * program.slack);
        let bounded = || (search.cells(low, high, width, options.cells), width);
        let between = || Some((search.between_changes([low, high], options)?, options.width));
        let known = if general {
            between()
        } else {
            // Where unknowns are nearly free, and of a snapped chain, bounds may say little.
            let (cells, width) = bounded();
            let between = if widest_unknown(&cells) > NARROW { between() } else { None };
            between.or(Some((cells, width)))
        };
        let sampled = known.is_none() && jointly;
        let (cells, width) =
            known.unwrap_or_else(|| if sampled { (search.points(low, high), width) } else { bounded() });
        let unknown = widest_unknown(&cells);
        let step = (high - low) / POINTS as f64;
        let completeness = if sampled || unknown > step {
            Completeness::Sampled(step)
        } else {
            Completeness::ToWidth(unknown.max(width))
        };
        Ok(FreeIntervals { intervals: search.intervals(&cells), completeness, range })
    }
}

/// Intervals that are apart from each other, ascending.
fn united(mut intervals: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    // Ends that only rounding keeps apart.
    const TOUCHING: f64 = 1e-12;
    intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut found: Vec<[f64; 2]> = Vec::new();
    for [low, high] in intervals {
        match found.last_mut() {
            Some(last) if last[1] + TOUCHING >= low => last[1] = last[1].max(high),
            _ => found.push([low, high]),
        }
    }
    found
}
