//! Motion, grasp and manipulation planners.
//!

pub mod grasp;

pub use grasp::{Contact, Grasp, GraspSet};
