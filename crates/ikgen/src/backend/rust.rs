//! Rust.

use crate::ir::Program;
use crate::run::TrueChain;

/// Choices of the Rust back end.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RustOptions {
    /// Use the square root of `std` instead of the file's own: faster, but then the file needs `std`.
    pub std: bool,
}

/// The source file.
pub fn rust_source(program: &Program, _chain: &TrueChain, _options: &RustOptions) -> String {
    program.text()
}
