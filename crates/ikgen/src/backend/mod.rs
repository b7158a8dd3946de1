//! Solution programs as source code.

mod c;
mod prune;
mod rust;

pub use c::{CError, CSource, c_source};
pub use rust::{RustOptions, rust_source};

/// Most solutions that a generated solver returns.
const CAPACITY: usize = 16;
