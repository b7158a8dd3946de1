//! The inverse-kinematics compiler (in progress).

#[cfg(feature = "generate")]
pub mod backend;
pub mod check;
#[cfg(feature = "generate")]
pub mod generate;
pub mod ir;
pub mod kernel;
#[cfg(feature = "generate")]
pub mod passes;
#[cfg(feature = "generate")]
pub mod report;
pub mod run;

#[cfg(feature = "generate")]
pub use generate::{Compiled, Options, Refusal, compile};
pub use ir::Program;
pub use run::Solver;
