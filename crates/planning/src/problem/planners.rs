//! The planners of this library in the form that the registry wants.

use std::collections::BTreeMap;

use robotc_core::Seed;

use super::registry::{PathFailure, PathFailureReason, PathPlanner, PathSolution, Query};
use crate::budget::Budget;
use crate::edge::{Blocked, EdgeChecker, Obstruction};
use crate::explore::{ExploreFailureReason, ExploreOptions, explore};
use crate::goal::{GoalDraw, GoalSampler};
use crate::motion::{MotionFailure, Sampling, SearchOptions, find_motion};
use crate::rrt::{RrtConnect, RrtFailureReason};

/// [`RrtConnect`].
pub(super) struct Connect;

impl PathPlanner for Connect {
    fn name(&self) -> &str {
        "rrt_connect"
    }

    fn summary(&self) -> &str {
        "Two forests grow towards each other, with goals drawn during the search."
    }

    fn plan(
        &self,
        checker: &mut dyn EdgeChecker,
        query: Query<'_>,
        budget: &Budget<'_>,
        seed: Seed,
    ) -> Result<PathSolution, PathFailure> {
        let mut search = RrtConnect::new(query.start);
        let options = &query.problem.search;
        match search.run(checker, query.constraint, query.goals, options, budget, &mut seed.rng()) {
            Ok(found) => Ok(PathSolution {
                path: found.path,
                goal: found.goal,
                iterations: found.statistics.iterations,
            }),
            Err(failure) => Err(PathFailure {
                reason: match failure.reason {
                    RrtFailureReason::Start(by) => PathFailureReason::Start(by),
                    RrtFailureReason::NoGoal => PathFailureReason::NoGoal,
                    RrtFailureReason::Iterations => PathFailureReason::Exhausted,
                    RrtFailureReason::Interrupted(i) => PathFailureReason::Interrupted(i),
                },
                iterations: failure.statistics.iterations,
                blocked: failure.statistics.blocked,
            }),
        }
    }
}

/// [`find_motion`].
pub(super) struct Lazy;

/// The key of its option: the name of a [`Sampling`].
const SAMPLING: &str = "sampling";

impl PathPlanner for Lazy {
    fn name(&self) -> &str {
        "rrt_lazy"
    }

    fn summary(&self) -> &str {
        "Two trees of motions that are only looked at; whole ways are proven. One goal after the other, no constraint."
    }

    fn plan(
        &self,
        checker: &mut dyn EdgeChecker,
        query: Query<'_>,
        budget: &Budget<'_>,
        seed: Seed,
    ) -> Result<PathSolution, PathFailure> {
        let unsupported = |what: String| early(PathFailureReason::Unsupported(what));
        if query.constraint.is_some() {
            return Err(unsupported("it knows no constraints".into()));
        }
        let sampling = match query.problem.options.get(SAMPLING) {
            None => <&Sampling>::default(),
            Some(name) => name
                .as_str()
                .and_then(Sampling::named)
                .ok_or_else(|| unsupported(format!("there is no {SAMPLING} {name}")))?,
        };
        let search = &query.problem.search;
        let goals = all_goals(query.goals, search.max_goal_draws, budget).map_err(early)?;
        let max_iterations = (search.max_iterations / goals.len() as u32).max(1);
        let options =
            SearchOptions { step: search.step, sampling, max_iterations, ..SearchOptions::default() };
        let (mut iterations, mut blocked) = (0, BTreeMap::new());
        for (goal, to) in goals.iter().enumerate() {
            let reason = match find_motion(checker, query.start, to, &options, budget, seed.at(goal as u64)) {
                Ok(found) => {
                    iterations += found.iterations;
                    return Ok(PathSolution { path: found.path, goal, iterations });
                }
                Err(MotionFailure::Start(by)) => PathFailureReason::Start(by),
                Err(MotionFailure::Interrupted(interrupt, n)) => {
                    iterations += n;
                    PathFailureReason::Interrupted(interrupt)
                }
                Err(MotionFailure::Goal(by)) => {
                    *blocked.entry(by).or_insert(0) += 1;
                    continue;
                }
                Err(MotionFailure::Iterations(n)) => {
                    iterations += n;
                    continue;
                }
            };
            return Err(PathFailure { reason, iterations, blocked });
        }
        Err(PathFailure { reason: PathFailureReason::Exhausted, iterations, blocked })
    }
}

/// All goals that a sampler has, up to a limit of draws.
fn all_goals(
    goals: &mut dyn GoalSampler,
    max_draws: u32,
    budget: &Budget<'_>,
) -> Result<Vec<Vec<f64>>, PathFailureReason> {
    let mut found = Vec::new();
    for _ in 0..max_draws {
        budget.check().map_err(PathFailureReason::Interrupted)?;
        match goals.draw(budget).map_err(PathFailureReason::Interrupted)? {
            GoalDraw::Goal(q) => found.push(q),
            GoalDraw::Pending => {}
            GoalDraw::Exhausted => break,
        }
    }
    if found.is_empty() { Err(PathFailureReason::NoGoal) } else { Ok(found) }
}

fn early(reason: PathFailureReason) -> PathFailure {
    PathFailure { reason, iterations: 0, blocked: BTreeMap::new() }
}

/// One tree from the start (LaValle, 1998): what two trees are compared with.
pub(super) struct SingleTree;

impl PathPlanner for SingleTree {
    fn name(&self) -> &str {
        "rrt"
    }

    fn summary(&self) -> &str {
        "One tree grows from the start until a goal is within a step."
    }

    fn plan(
        &self,
        checker: &mut dyn EdgeChecker,
        query: Query<'_>,
        budget: &Budget<'_>,
        seed: Seed,
    ) -> Result<PathSolution, PathFailure> {
        let search = &query.problem.search;
        let goals = all_goals(query.goals, search.max_goal_draws, budget).map_err(early)?;
        let options =
            ExploreOptions { step: search.step, local: search.local, max_iterations: search.max_iterations };
        let reach = search.step * checker.space().diameter();
        let mut goal = None;
        let rng = &mut seed.rng();
        let found = explore(
            checker,
            query.constraint,
            query.start,
            &mut |checker, q| {
                let space = checker.space();
                let near = |to: &[f64]| space.distance(q, to) <= reach;
                let near: Vec<usize> = (0..goals.len()).filter(|&i| near(&goals[i])).collect();
                goal = near.into_iter().find(|&i| checker.edge(q, &goals[i]).is_ok());
                // Being far away is no obstruction, but counts as one that nothing else uses.
                goal.map(|_| ()).ok_or(FAR)
            },
            &options,
            budget,
            rng,
        );
        match found {
            Ok(found) => {
                let goal = goal.expect("the search ends when a goal was seen");
                let mut path = found.path;
                path.push(goals[goal].clone());
                Ok(PathSolution { path, goal, iterations: found.statistics.iterations })
            }
            Err(failure) => Err(PathFailure {
                reason: match failure.reason {
                    ExploreFailureReason::Start(by) => PathFailureReason::Start(by),
                    ExploreFailureReason::Iterations => PathFailureReason::Exhausted,
                    ExploreFailureReason::Interrupted(i) => PathFailureReason::Interrupted(i),
                },
                iterations: failure.statistics.iterations,
                blocked: failure.statistics.blocked,
            }),
        }
    }
}

/// A state that no goal is near to.
const FAR: Obstruction = Obstruction::Contact(u32::MAX);

/// The straight motion to each goal.
pub(super) struct Straight;

impl PathPlanner for Straight {
    fn name(&self) -> &str {
        "straight"
    }

    fn summary(&self) -> &str {
        "The straight motion to the first goal for which it is free."
    }

    fn plan(
        &self,
        checker: &mut dyn EdgeChecker,
        query: Query<'_>,
        budget: &Budget<'_>,
        _: Seed,
    ) -> Result<PathSolution, PathFailure> {
        checker.state(query.start).map_err(|by| early(PathFailureReason::Start(by)))?;
        let draws = query.problem.search.max_goal_draws;
        let goals = all_goals(query.goals, draws, budget).map_err(early)?;
        let mut blocked = BTreeMap::new();
        for (goal, to) in goals.iter().enumerate() {
            match checker.edge(query.start, to) {
                Ok(()) => {
                    let path = vec![query.start.to_vec(), to.clone()];
                    return Ok(PathSolution { path, goal, iterations: goal as u32 + 1 });
                }
                Err(Blocked { by, .. }) => *blocked.entry(by).or_insert(0) += 1,
            }
        }
        let iterations = goals.len() as u32;
        Err(PathFailure { reason: PathFailureReason::Exhausted, iterations, blocked })
    }
}
