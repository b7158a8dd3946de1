//! Execution of solution programs: an interpreter that is plainly right, a bytecode that is fast, and the solver
//! that checks and polishes what either finds.

mod batch;
pub mod bytecode;
mod closest;
mod families;
mod general;
pub mod interpreter;
mod lanes;
mod redundancy;
mod solver;
mod true_chain;

pub use batch::Batch;
pub use bytecode::{Bytecode, Candidate, TooLarge};
pub use closest::{Closest, ClosestOptions};
#[cfg(feature = "generate")]
pub(crate) use general::six_lines;
pub use redundancy::{Completeness, FreeIntervals, RedundancyOptions, Side, SwivelBranch};
pub use solver::{Engine, LoadError, Solver};
pub use true_chain::TrueChain;

use robotc_core::Pose;

use crate::kernel::chain::Frame;

/// Roots that one run of a program follows at most, all equations together: a program can nest equations deeper than anybody
/// could wait for. Those of real arms come to some thousands where everything is singular at once.
pub(crate) const MOST_ROOTS: u32 = 1 << 16;

/// What solving for six unknowns at once counts as, in roots: it takes about that much longer.
pub(crate) const SIX_ROOTS: u32 = 1 << 10;

/// Takes this many from the roots that are left; `false`, and nothing taken, when there are fewer.
pub(crate) fn take(left: &mut u32, count: u32) -> bool {
    let enough = *left >= count;
    if enough {
        *left -= count;
    }
    enough
}

/// What is made of a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It does not reach the pose.
    Wrong,
    /// It does.
    Accepted,
    /// It does, and no other is wanted.
    Last,
}

/// A pose as the kernel sees it.
pub(crate) fn frame(pose: &Pose) -> Frame {
    let r = pose.rotation.to_rotation_matrix();
    let mut rotation = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            rotation[i][j] = r[(i, j)];
        }
    }
    Frame { rotation, position: pose.translation.vector.into() }
}
