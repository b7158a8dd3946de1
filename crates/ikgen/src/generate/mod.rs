//! From a serial chain to a solution program.

pub mod builder;
pub mod compile;
mod complete;
mod doubt;
pub mod equations;
pub mod facts;
pub(crate) mod lock;
mod measured;
mod natural;
mod one_by_one;
pub mod problem;
pub mod strategies;
mod sweep;

pub use compile::{Compiled, Options, Refusal, compile, compile_watched};
pub(crate) use measured::orders_of_measured;
pub use natural::natural;
