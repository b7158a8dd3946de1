//! Solution programs as source code.

mod rust;

pub use rust::{RustOptions, rust_source};
