//! Solution programs as source code.

mod c;
mod prune;
mod rust;

pub use c::{CError, CSource, c_source};
pub use rust::{RustOptions, rust_source};

use crate::ir::{Program, RootKind};

/// Most solutions that a generated solver returns: six joints that turn have no more than sixteen.
fn capacity(program: &Program) -> usize {
    if program.uses(RootKind::Sweep) { 32 } else { 16 }
}
