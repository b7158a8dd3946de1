//! Execution of solution programs: an interpreter that is plainly right, a bytecode that is fast, and the solver
//! that checks and polishes what either finds.

pub mod bytecode;
pub mod interpreter;
mod solver;
mod true_chain;

pub use bytecode::{Bytecode, TooLarge};
pub use solver::{Engine, LoadError, Solver};
pub use true_chain::TrueChain;

use robotc_core::Pose;

use crate::kernel::chain::Frame;

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
