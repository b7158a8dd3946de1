//! A single tree, pulled to the goal by the transposed Jacobian: RRT-JT (Vande Weghe, Ferguson and Srinivasa, "Randomized
//! path planning for redundant manipulators without inverse kinematics", 2007). A baseline.

use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use super::forward::Forward;
use super::metric::TreeMetric;
use super::workspace::{ToolFailure, ToolFailureReason, ToolSolution, ToolStatistics, Workspace};
use crate::budget::Budget;
use crate::edge::EdgeChecker;

/// Parameters of the search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct JacobianOptions {
    /// Longest edge of the tree, as a fraction of the diameter of the space.
    pub step: f64,
    /// Share of extensions that go straight to the goal.
    pub pull: f64,
    /// Longest edge when going to the goal, as a fraction of the diameter of the space.
    pub pull_step: f64,
    /// Steps of one such extension.
    pub pull_steps: u32,
    /// The goal is reached when the tool is nearer to it than this, metres.
    pub tolerance: f64,
    /// Extensions after which the search gives up.
    pub max_iterations: u32,
}

impl Default for JacobianOptions {
    fn default() -> Self {
        Self {
            step: 0.1,
            pull: 0.2,
            pull_step: 0.02,
            pull_steps: 200,
            tolerance: 0.02,
            max_iterations: 20_000,
        }
    }
}

/// Moves the tool from where it is at `start` to within the tolerance of one of `goals`.
pub fn rrt_jt<W: Workspace + ?Sized, C: EdgeChecker + ?Sized>(
    workspace: &mut W,
    checker: &mut C,
    start: &[f64],
    goals: &[W::Point],
    options: &JacobianOptions,
    budget: &Budget<'_>,
    rng: &mut Rng,
) -> Result<ToolSolution, ToolFailure> {
    let mut forward = Forward::new(&*workspace, start, goals);
    let mut statistics = ToolStatistics::default();
    let outcome = grow(workspace, checker, start, goals, options, budget, rng, &mut forward, &mut statistics);
    statistics.nodes = forward.tree.len();
    statistics.blocked = forward.blocked;
    let (distance, node, goal) = forward.nearest;
    match outcome {
        Ok(()) => {
            let mut path = forward.tree.path_to_root(node);
            path.reverse();
            Ok(ToolSolution { path, goal, statistics })
        }
        Err(reason) => Err(ToolFailure { reason, nearest: distance, statistics }),
    }
}

/// Ends when the nearest node is near enough.
fn grow<W: Workspace + ?Sized, C: EdgeChecker + ?Sized>(
    workspace: &W,
    checker: &mut C,
    start: &[f64],
    goals: &[W::Point],
    options: &JacobianOptions,
    budget: &Budget<'_>,
    rng: &mut Rng,
    forward: &mut Forward<'_, W::Point>,
    statistics: &mut ToolStatistics,
) -> Result<(), ToolFailureReason> {
    checker.state(start).map_err(ToolFailureReason::Start)?;
    if goals.is_empty() {
        return Err(ToolFailureReason::NoGoal);
    }
    let longest = options.pull_step * checker.space().diameter();
    // The nearest node has been pulled as far as it goes; the next one pulled is another.
    let mut pulled = None;
    while forward.nearest.0 >= options.tolerance {
        budget.check().map_err(ToolFailureReason::Interrupted)?;
        if statistics.iterations >= options.max_iterations {
            return Err(ToolFailureReason::Iterations);
        }
        statistics.iterations += 1;
        if rng.unit() >= options.pull {
            forward.extend(workspace, checker, TreeMetric::Plain, options.step, rng);
            continue;
        }
        statistics.follows += 1;
        let (_, nearest, goal) = forward.nearest;
        let mut node = if pulled == Some(nearest) { forward.tree.len() - 1 } else { nearest };
        for _ in 0..options.pull_steps {
            budget.check().map_err(ToolFailureReason::Interrupted)?;
            let from = forward.tree.state(node).to_vec();
            let here = workspace.distance(&workspace.point(&from), &goals[goal]);
            if here < options.tolerance {
                break;
            }
            let pull = workspace.pull(&from, &goals[goal]);
            let mut q: Vec<f64> = from.iter().zip(&pull).map(|(x, d)| x + d).collect();
            let length = checker.space().distance(&from, &q);
            if length > longest {
                q = checker.space().interpolate(&from, &q, longest / length);
            }
            checker.space().clamp(&mut q);
            let closer = workspace.distance(&workspace.point(&q), &goals[goal]) < here;
            if !closer || !forward.is_free(checker, &from, &q) {
                break;
            }
            node = forward.push(workspace, node, &q);
        }
        pulled = Some(forward.nearest.1);
    }
    Ok(())
}
