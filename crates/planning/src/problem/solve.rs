//! From a problem to a path.

use std::fmt;

use super::document::{PlanningProblem, ProblemError};
use super::registry::{PathFailure, PathSolution, Query, Registry, RegistryError};
use crate::budget::Budget;
use crate::constraint::Constraint;
use crate::edge::{EdgeChecker, Obstruction};
use crate::goal::{FixedGoals, GoalSampler};
use crate::jitter::{JitterFailure, jitter};
use crate::smooth::smooth;

/// A path, and what was done to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// States from the start to a goal; the straight motions between them are valid, but for the first one when the start
    /// was moved out of a contact.
    pub path: Vec<Vec<f64>>,
    /// Number of the goal: its position in the problem, or with a sampler the order of drawing.
    pub goal: usize,
    /// Length in the metric as the planner found it, without the motion out of a contact.
    pub length_found: f64,
    /// The same after post-processing.
    pub length: f64,
    /// Iterations of the planner.
    pub iterations: u32,
    /// How far the start was moved out of a contact, as travel of the fastest point; zero when it was free.
    pub jittered: f64,
    /// Goals of the problem that are not free, with the reason.
    pub bad_goals: Vec<(usize, Obstruction)>,
}

/// Why there is no path.
#[derive(Debug, Clone, PartialEq)]
pub enum SolveFailure {
    /// The document is wrong.
    Problem(ProblemError),
    /// The planner is not known.
    Planner(RegistryError),
    /// The space of the checker is not that of the problem.
    Space,
    /// The start is in a contact that it cannot be moved out of.
    Jitter(JitterFailure),
    /// The planner found no path.
    Search {
        /// What it says.
        failure: PathFailure,
        /// Goals of the problem that are not free, with the reason.
        bad_goals: Vec<(usize, Obstruction)>,
    },
}

impl fmt::Display for SolveFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Problem(e) => write!(f, "{e}"),
            Self::Planner(e) => write!(f, "{e}"),
            Self::Space => write!(f, "the limits of the problem are not those of the checker"),
            Self::Jitter(e) => write!(f, "the start is not free: {e}"),
            Self::Search { failure, bad_goals } => {
                write!(f, "{failure}")?;
                if !bad_goals.is_empty() {
                    write!(f, " ({} goals are not free)", bad_goals.len())?;
                }
                Ok(())
            }
        }
    }
}

/// Solves a problem with the planner that it names: jittering, search, post-processing.
///
/// `checker` is of the problem's space. Goals are those of the problem that are free, or else drawn from `goals`;
/// `constraint` is what [`ConstraintDocument::build`](super::ConstraintDocument::build) made, and the checker refuses states
/// off it.
pub fn solve(
    registry: &Registry,
    problem: &PlanningProblem,
    checker: &mut dyn EdgeChecker,
    goals: Option<&mut dyn GoalSampler>,
    constraint: Option<&dyn Constraint>,
    budget: &Budget<'_>,
) -> Result<Solved, SolveFailure> {
    solve_racer(registry, problem, checker, goals, constraint, budget, 0)
}

/// [`solve`] as one of the searches that [race](crate::motion::race()): each has a stream of its own, the first one, number 0, that of a search which
/// has no rival.
pub fn solve_racer(
    registry: &Registry,
    problem: &PlanningProblem,
    checker: &mut dyn EdgeChecker,
    goals: Option<&mut dyn GoalSampler>,
    constraint: Option<&dyn Constraint>,
    budget: &Budget<'_>,
    racer: u32,
) -> Result<Solved, SolveFailure> {
    problem.check().map_err(SolveFailure::Problem)?;
    let planner = registry.get(&problem.planner).map_err(SolveFailure::Planner)?;
    if *checker.space() != problem.space() {
        return Err(SolveFailure::Space);
    }
    let seed = problem.racer_seed(racer);

    let mut start = problem.start.clone();
    let mut jittered = 0.0;
    if let Some(options) = &problem.jitter {
        let rng = &mut seed.split("jitter").rng();
        let moved =
            jitter(checker, constraint, &start, options, budget, rng).map_err(SolveFailure::Jitter)?;
        (start, jittered) = (moved.q, moved.travel);
    }

    let mut bad_goals = Vec::new();
    let mut numbers = Vec::new();
    let mut fixed = Vec::new();
    for (number, goal) in problem.goals.iter().enumerate() {
        match checker.state(goal) {
            Ok(_) => {
                numbers.push(number);
                fixed.push(goal.clone());
            }
            Err(by) => bad_goals.push((number, by)),
        }
    }
    let mut fixed = FixedGoals::new(fixed);
    let sampled = goals.is_some();
    let query = Query { start: &start, goals: goals.unwrap_or(&mut fixed), constraint, problem };
    let PathSolution { path, goal, iterations } =
        match planner.plan(checker, query, budget, seed.split("search")) {
            Ok(found) => found,
            Err(failure) => return Err(SolveFailure::Search { failure, bad_goals }),
        };

    let length_found = checker.space().length(&path);
    let mut path = smooth(checker, path, &problem.post, budget, &mut seed.split("post").rng());
    let length = checker.space().length(&path);
    if jittered > 0.0 {
        path.insert(0, problem.start.clone());
    }
    let goal = if sampled { goal } else { numbers[goal] };
    Ok(Solved { path, goal, length_found, length, iterations, jittered, bad_goals })
}
