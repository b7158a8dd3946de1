//! Solution programs as source code.

mod c;
mod prune;
mod rust;

pub use c::{CError, COptions, CSource, c_source};
pub use rust::{RustOptions, rust_source};

use crate::GoalType;
use crate::generate::orders_of_measured;
use crate::ir::{Program, RootKind};
use crate::kernel::six::Order;
use crate::run::TrueChain;

/// The orders in which `solve_on` asks the general solver; none when it does not.
fn measured(calibrated: bool, program: &Program, chain: &TrueChain) -> Vec<Order> {
    let held: Vec<bool> = (0..program.variables).map(|v| program.free.contains(&v)).collect();
    match program.goal {
        GoalType::Transform6D if calibrated => orders_of_measured(chain, &held),
        _ => Vec::new(),
    }
}

/// Most solutions that a generated solver returns: six joints that turn have no more than sixteen.
fn capacity(program: &Program) -> usize {
    if program.uses(RootKind::Sweep) { 32 } else { 16 }
}
