//! From a serial chain to a solution program.

pub mod builder;
pub mod compile;
mod complete;
pub mod facts;
pub(crate) mod lock;
pub mod problem;
pub mod strategies;

pub use compile::{Compiled, Options, Refusal, compile};
