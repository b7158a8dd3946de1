//! Planners by name.

use std::collections::BTreeMap;
use std::fmt;

use robotc_core::Seed;
use thiserror::Error;

use super::document::PlanningProblem;
use super::planners;
use crate::budget::{Budget, Interrupt};
use crate::constraint::Constraint;
use crate::edge::{EdgeChecker, Obstruction};
use crate::goal::GoalSampler;

/// A planner from a start configuration to a goal: what the registry holds, and what planners from outside implement.
pub trait PathPlanner: Send + Sync {
    /// What problems call it: lower case, digits and underscores.
    fn name(&self) -> &str;

    /// What it does, in one sentence.
    fn summary(&self) -> &str;

    /// Finds a path of valid edges from the query's start to one of its goals.
    ///
    /// A good planner asks the budget often, draws randomness from the seed alone, and counts what blocked it.
    fn plan(
        &self,
        checker: &mut dyn EdgeChecker,
        query: Query<'_>,
        budget: &Budget<'_>,
        seed: Seed,
    ) -> Result<PathSolution, PathFailure>;
}

/// What a planner is given.
pub struct Query<'q> {
    /// The start; it is valid.
    pub start: &'q [f64],
    /// The goals, drawn one by one.
    pub goals: &'q mut dyn GoalSampler,
    /// What every state of the path satisfies. The checker refuses others; projection finds good ones.
    pub constraint: Option<&'q dyn Constraint>,
    /// All parameters.
    pub problem: &'q PlanningProblem,
}

/// A path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathSolution {
    /// States from the start to a goal.
    pub path: Vec<Vec<f64>>,
    /// Number of the goal, in the order of drawing.
    pub goal: usize,
    /// Iterations, in the planner's own unit.
    pub iterations: u32,
}

/// Why a planner found no path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PathFailureReason {
    /// The start is not valid.
    Start(Obstruction),
    /// There was no goal.
    NoGoal,
    /// There is no path, or the planner's limits were reached.
    Exhausted,
    /// The budget ended.
    Interrupted(Interrupt),
    /// The planner cannot do what is asked for: this.
    Unsupported(String),
}

/// Why there is no path, and what was tried.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PathFailure {
    /// What ended the search.
    pub reason: PathFailureReason,
    /// Iterations, in the planner's own unit.
    pub iterations: u32,
    /// How many motions each obstruction stopped.
    pub blocked: BTreeMap<Obstruction, u32>,
}

impl fmt::Display for PathFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.reason {
            PathFailureReason::Start(_) => write!(f, "the start is not free"),
            PathFailureReason::NoGoal => write!(f, "no goal configuration was found"),
            PathFailureReason::Exhausted => write!(f, "no path after {} iterations", self.iterations),
            PathFailureReason::Interrupted(interrupt) => {
                write!(f, "{interrupt} after {} iterations", self.iterations)
            }
            PathFailureReason::Unsupported(what) => write!(f, "the planner cannot do this: {what}"),
        }
    }
}

/// What is wrong with a name.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RegistryError {
    /// There is no such planner.
    #[error("there is no planner {name}; there are {known}")]
    Unknown {
        /// The name asked for.
        name: String,
        /// All names, with commas.
        known: String,
    },
    /// There is one already.
    #[error("there is a planner {0} already")]
    Taken(String),
    /// It is no name.
    #[error("{0:?} is no name of a planner: lower case letters, digits and underscores are")]
    BadName(String),
}

/// Planners, in the order in which they were registered.
pub struct Registry {
    planners: Vec<Box<dyn PathPlanner>>,
}

impl Registry {
    /// The planners of this library: one line each.
    pub fn standard() -> Self {
        Self {
            planners: vec![
                Box::new(planners::Connect),
                Box::new(planners::Lazy),
                Box::new(planners::SingleTree),
                Box::new(planners::Straight),
            ],
        }
    }

    /// Adds a planner.
    pub fn register(&mut self, planner: Box<dyn PathPlanner>) -> Result<(), RegistryError> {
        let name = planner.name();
        let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        if name.is_empty() || !name.chars().all(good) {
            return Err(RegistryError::BadName(name.into()));
        }
        if self.iter().any(|p| p.name() == name) {
            return Err(RegistryError::Taken(name.into()));
        }
        self.planners.push(planner);
        Ok(())
    }

    /// The planner with this name.
    pub fn get(&self, name: &str) -> Result<&dyn PathPlanner, RegistryError> {
        self.iter().find(|p| p.name() == name).ok_or_else(|| RegistryError::Unknown {
            name: name.into(),
            known: self.iter().map(PathPlanner::name).collect::<Vec<_>>().join(", "),
        })
    }

    /// All planners.
    pub fn iter(&self) -> impl Iterator<Item = &dyn PathPlanner> {
        self.planners.iter().map(|p| &**p)
    }
}

impl Default for Registry {
    fn default() -> Self {
        Self::standard()
    }
}
