//! The inverse-kinematics compiler: from a serial chain to a solution program, its source and its proof.
//!
//! ```text
//! chain -> facts -> strategies -> program -> passes -> Rust source | text -> interpreter | bytecode
//! ```
//!
//! [`compile`](fn@compile) finds the program, [`report::prove`] tries it on random and singular poses, [`Solver`] runs it. Loading and
//! running need none of the compiler: without the feature `generate` the crate is the language and its executors.
//!
//! # The solution language
//!
//! A [`Program`] takes a pose `base_from_tip` and the values of the *free* variables, and emits *candidates*: one value for
//! each variable of the chain. This is its text form:
//!
//! ```text
//! ikgen 1
//! class "6R spherical wrist, axes 2 and 3 parallel"
//! variables 6
//! free []
//! snap 0.0
//! slack 0.0
//! {
//!   let t0 = py + -0.08 * r12
//!   circle(px, t0, 0.1) -> c1 s1 {
//!     ...
//!     emit angle(c1, s1) angle(c2, s2) ...
//!   }
//! }
//! ```
//!
//! **Expressions** are pure: `rIJ` (rotation of the pose, row I, column J), `px py pz` (its position), `freeK`, numbers, bound names,
//! `+ - * /`, `sqrt` (0 for negative arguments), `sin`, `cos`, `angle_of`, `min`, `max`. They form a hash-consed graph: what is written
//! twice is one node.
//!
//! **Statements** are structured; a name is visible in the rest of its block and in nested blocks.
//!
//! | statement | meaning |
//! |---|---|
//! | `let x = e` | a name for a value |
//! | `align(x, y) -> c s { }` | for the angle along (x, y) |
//! | `mirror(x, y) -> c s { }` | for the two angles along (x, y) and (x, -y) |
//! | `half(x, y) -> c s { }` | for the one of them whose sine is positive |
//! | `circle(a, b, d) -> c s { }` | for each angle with `a cos + b sin = d` |
//! | `conic(a, b, c, d, e, f) -> c s { }` | for each angle with `a cos^2 + b cos sin + c sin^2 + d cos + e sin + f = 0` |
//! | `octic(a0, a1, b1, ..., a4, b4) -> c s { }` | for each angle with `a0 + a1 cos q + b1 sin q + ... + a4 cos 4q + b4 sin 4q = 0` |
//! | `six(...) -> c s c s c s c s c s c s { }` | for each way in which six turning joints close a loop; [`kernel::six`] says how |
//! | `sweep(...) -> c s c s c s c s c s c s { }` | for each way in which five turning joints and one unknown that slides or moves several joints close a loop; [`kernel::sweep`] says how |
//! | `quadratic(a, b, c) -> t { }` | for each length with `a t^2 + b t + c = 0` |
//! | `zero(e, tolerance) { } else { }` | a *guard*: the first block where `e` is smaller in magnitude |
//! | `first { } else { }` | the second block only if nothing emitted by the first was accepted |
//! | `doubt(e, tolerance)` | a note that an equation is near to losing roots, where `e` is smaller in magnitude |
//! | `rest { }` | the block only if nothing was accepted before, or there was a doubt; not inside of another statement |
//! | `emit angle(c, s) length(x) ...` | a candidate |
//! | `# words` | a remark: which equation gave the following lines |
//!
//! Angles are unknown through cosine and sine throughout; inverse trigonometry happens once, when a candidate is accepted.
//!
//! **Free roots.** Where the coefficients of an equation vanish it says nothing about its unknown: axes have lined up and
//! the solutions are a continuum. The unknown then takes representative values, zero first, until one has led to an accepted
//! candidate. Since every later equation is solved for the value taken, the representative is an exact solution.
//!
//! **Slack.** An equation whose roots have just disappeared (an arm stretched to its edge) is taken where it comes nearest:
//! within 1e-9, or within what the ideal chain of the program may differ from the described one. `six` is written for the described
//! chain, and has none of the latter.
//!
//! **Solutions.** A candidate is *accepted* if it reaches the pose on the *true chain* to 1e-9 (metres, and Frobenius norm of the
//! rotation difference). The true chain is not part of the program but given at load: the described arm, or a calibrated one. A
//! candidate that misses by more than 1e-13 is polished by Newton steps on the true chain first. Equal solutions are kept once. So
//! a program can only fail to find something; it cannot give a wrong answer.

#[cfg(feature = "generate")]
pub mod backend;
pub mod check;
#[cfg(feature = "generate")]
pub mod generate;
pub mod goal;
pub mod ir;
#[cfg(feature = "generate")]
mod jacobian;
pub mod kernel;
mod orders;
pub mod passes;
#[cfg(feature = "generate")]
pub mod report;
pub mod run;
#[cfg(feature = "generate")]
mod vectors;

#[cfg(feature = "generate")]
pub use backend::RustOptions;
#[cfg(feature = "generate")]
pub use generate::{Compiled, Options, Refusal, compile, compile_watched};
pub use goal::GoalType;
pub use ir::Program;
#[cfg(feature = "generate")]
pub use report::{ProofOptions, Report, prove};
pub use run::Solver;
