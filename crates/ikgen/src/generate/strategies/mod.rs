//! The ways to solve a chain: one file each, one line in [`ALL`].

mod general;
mod offset_wrist;
mod orient;
mod reach;
mod spherical_wrist;
mod three_parallel;

pub(super) use reach::Line;

use super::builder::Builder;
use super::problem::Problem;

/// A way to solve a class of chains.
pub struct Strategy {
    /// Its name in traces.
    pub name: &'static str,
    /// Number of unknown joints it is for.
    pub unknowns: usize,
    /// Writes the program, and adapts the axes of the problem to the ideal ones it solves. Says why if it cannot.
    pub write: fn(&mut Problem, &Builder) -> Result<String, String>,
}

/// Strategies for special chains, in the order in which they are tried.
pub const SPECIAL: &[Strategy] = &[
    Strategy { name: "spherical wrist", unknowns: 6, write: spherical_wrist::write },
    Strategy { name: "three parallel axes", unknowns: 6, write: three_parallel::write },
    Strategy { name: "offset wrist", unknowns: 6, write: offset_wrist::write },
];

/// Strategies for any chain, for where no special one fits.
pub const GENERAL: &[Strategy] = &[Strategy { name: "general", unknowns: 6, write: general::write }];
