//! Loads a compiled knowledge base, plans, executes and records, with no generator linked.
//!
//! A [`Session`] is a task with its artefacts. [`Session::plan`] gives a plan, [`execute()`] follows it in a kinematic
//! simulation, [`film()`] turns what happened into a [`record::Recording`], and [`view`] writes that as a page or as glTF.

pub mod execute;
pub mod film;
pub mod motion;
mod own_points;
pub mod picture;
pub mod record;
pub mod session;
pub mod table;
pub mod view;

pub use execute::{Execution, ExecutionError, execute};
pub use film::film;
pub use motion::{FirstContact, Motion, MotionError};
pub use picture::picture;
pub use session::{NoPlan, Session, SessionError};
pub use table::MotionTable;
