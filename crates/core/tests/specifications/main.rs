//! Specifications: golden diagnostics, the specifications that ship, and texts made worse on purpose.

#![allow(clippy::print_stderr, reason = "a skipped test says so")]

mod arguments;
mod disk;
mod findings;
mod guesses;
mod guide;
mod mutations;
mod shipped;
mod summaries;
mod values;
