//! Motion problems as documents, planners by name, and one call that joins them.
//!
//! A [`PlanningProblem`] is everything about a search that can be written down: limits and metric, start and goals,
//! constraint, steps, limits, seed, post-processing (the planner parameters of thesis appendix A). What cannot be written
//! down, the robot and its world, is an [`EdgeChecker`](crate::edge::EdgeChecker). A [`Registry`] knows planners by name; others can be added from outside.

mod document;
mod planners;
mod registry;
mod situation;
mod solve;
#[cfg(test)]
mod tests;
mod unknown;

pub use document::{
    AxisDocument, ConstraintDocument, MOST_RACERS, MechanismDocument, PlanningProblem, PoseDocument,
    ProblemError, VERSION,
};
pub use registry::{
    PathFailure, PathFailureReason, PathPlanner, PathSolution, Query, Registry, RegistryError,
};
pub use situation::{HeldDocument, SituationDocument};
pub use solve::{SolveFailure, Solved, solve, solve_racer};
pub use unknown::{UnknownKey, unknown_keys};
