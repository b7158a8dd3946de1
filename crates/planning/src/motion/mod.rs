//! One motion from a start to a goal: found quickly, then made short.
//!
//! This is the planner for the plain question between two states. It knows nothing of robots; with
//! [`LaneChecker`](crate::LaneChecker) it is made for microseconds. Goals that have to be found first, and constraints, are
//! the business of [`rrt`](crate::rrt).

mod race;
mod sampling;
mod search;
mod shorten;
mod tree;

use std::fmt;

use robotc_core::Seed;

use crate::budget::{Budget, Interrupt};
use crate::edge::{EdgeChecker, Obstruction, Patience};

pub use race::{Race, race, race_motion};
pub use sampling::{SAMPLINGS, Sampling};
pub use search::SearchOptions;
pub use shorten::ShortenOptions;

/// How to plan.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MotionOptions {
    /// The search for a first path.
    pub search: SearchOptions,
    /// What makes it shorter.
    pub shorten: ShortenOptions,
}

/// A path between two states.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionPlan {
    /// States from start to goal; the straight motions between them were found free.
    pub path: Vec<Vec<f64>>,
    /// Iterations of the search, over all restarts; zero when the straight motion is free.
    pub iterations: u32,
}

/// Why there is no path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionFailure {
    /// The start is invalid.
    Start(Obstruction),
    /// The goal is invalid.
    Goal(Obstruction),
    /// This many iterations found nothing.
    Iterations(u32),
    /// The budget ended after this many iterations.
    Interrupted(Interrupt, u32),
}

impl fmt::Display for MotionFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start(_) => write!(f, "the start is not free"),
            Self::Goal(_) => write!(f, "the goal is not free"),
            Self::Iterations(n) => write!(f, "no path after {n} iterations"),
            Self::Interrupted(interrupt, n) => write!(f, "{interrupt} after {n} iterations"),
        }
    }
}

/// Finds a path from `start` to `goal`. The same seed gives the same path.
pub fn find_motion<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    start: &[f64],
    goal: &[f64],
    options: &SearchOptions,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<MotionPlan, MotionFailure> {
    checker.set_patience(Patience::Thorough);
    checker.state(start).map_err(MotionFailure::Start)?;
    checker.state(goal).map_err(MotionFailure::Goal)?;
    search::run(checker, start, goal, options, budget, seed)
}

/// Makes a path shorter; its ends stay, and only motions that were found free are added.
pub fn shorten_motion<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    path: Vec<Vec<f64>>,
    options: &ShortenOptions,
    budget: &Budget<'_>,
    seed: Seed,
) -> Vec<Vec<f64>> {
    checker.set_patience(options.patience);
    let path = shorten::run(checker, path, options, budget, seed);
    checker.set_patience(Patience::Thorough);
    path
}

/// Finds a path from `start` to `goal` and makes it shorter.
pub fn plan_motion<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    start: &[f64],
    goal: &[f64],
    options: &MotionOptions,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<MotionPlan, MotionFailure> {
    let MotionPlan { path, iterations } =
        find_motion(checker, start, goal, &options.search, budget, seed.split("search"))?;
    let path = shorten_motion(checker, path, &options.shorten, budget, seed.split("shorten"));
    Ok(MotionPlan { path, iterations })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edge::walk_path;
    use crate::toy::Toy;

    fn plan(toy: &mut Toy, goal: [f64; 2], seed: u64) -> Result<MotionPlan, MotionFailure> {
        let mut options = MotionOptions::default();
        options.search.max_iterations = 3000;
        plan_motion(toy, &[1.0, 1.0], &goal, &options, &Budget::unlimited(), Seed::new(seed))
    }

    #[test]
    fn goes_round_a_wall_by_nearly_the_shortest_way() {
        let corners = [[1.0, 1.0], [4.0, 9.0], [5.0, 9.0], [9.0, 1.0]].map(|p| p.to_vec());
        let shortest = Toy::wall(0.05).space().length(&corners);
        for seed in 0..20 {
            let mut toy = Toy::wall(0.05);
            toy.padding = 0.025;
            let found = plan(&mut toy, [9.0, 1.0], seed).unwrap();
            walk_path(&mut Toy::wall(0.001), &found.path).unwrap();
            assert_eq!(
                (&found.path[0][..], &found.path[found.path.len() - 1][..]),
                (&[1.0, 1.0][..], &[9.0, 1.0][..])
            );
            let length = toy.space().length(&found.path);
            assert!(length < 1.15 * shortest, "{length} {shortest}");
            assert_eq!(plan(&mut toy, [9.0, 1.0], seed).unwrap(), found);
        }
    }

    #[test]
    fn the_straight_way_takes_no_search() {
        let found = plan(&mut Toy::wall(0.05), [1.0, 8.0], 1).unwrap();
        assert_eq!((found.iterations, found.path.len()), (0, 2));
    }

    #[test]
    fn failures_say_why() {
        assert_eq!(plan(&mut Toy::room(0.05), [8.0, 8.0], 1), Err(MotionFailure::Iterations(3000)));
        let covered = plan(&mut Toy::wall(0.05), [4.5, 1.0], 1);
        assert_eq!(covered, Err(MotionFailure::Goal(Obstruction::Contact(0))));
        let spent = || Some(Interrupt::Cancelled);
        let options = MotionOptions::default();
        let budget = Budget::new(&spent);
        let goal = [9.0, 1.0];
        let stopped = plan_motion(&mut Toy::wall(0.05), &[1.0; 2], &goal, &options, &budget, Seed::new(1));
        assert_eq!(stopped, Err(MotionFailure::Interrupted(Interrupt::Cancelled, 0)));
    }
}
