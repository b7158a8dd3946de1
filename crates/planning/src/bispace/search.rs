//! The search itself (thesis algorithm 3.13).

use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use super::follow::{FollowOptions, follow};
use super::forward::Forward;
use super::goal_tree::GoalTree;
use super::metric::{FollowProbability, TreeMetric};
use super::workspace::{ToolFailure, ToolFailureReason, ToolSolution, ToolStatistics, Workspace};
use crate::budget::Budget;
use crate::edge::EdgeChecker;
use crate::goal::FixedGoals;
use crate::rrt::{RrtConnect, RrtFailureReason, RrtOptions};
use crate::subspace::Subspace;

/// Parameters of the search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BiSpaceOptions {
    /// Extensions of the tree of configurations in a round (J).
    pub forward: u32,
    /// Extensions of the tree of the tool in a round (K).
    pub backward: u32,
    /// Longest edge of the tree of configurations, as a fraction of the diameter of the space in its metric.
    pub step: f64,
    /// Longest edge of the tree of the tool, metres.
    pub goal_step: f64,
    /// Places of the base that are tried for each pose of the tool's tree; a pose without a free configuration at any of
    /// them is left out. Zero keeps all poses.
    pub support: u32,
    /// Share of extensions of the tool's tree that go towards the tool at the start.
    pub start_bias: f64,
    /// The goal is reached when the tool is nearer to it than this, metres.
    pub tolerance: f64,
    /// Distances in the tree of configurations.
    pub metric: TreeMetric,
    /// When new configurations follow the tool.
    pub probability: FollowProbability,
    /// How they do it.
    pub follow: FollowOptions,
    /// The search for the arm's way to a solution of inverse kinematics at the end of following; `None` leaves it out.
    pub inverse: Option<RrtOptions>,
    /// Attempts in a round to connect the tree of configurations with a sampled configuration at a goal. The thesis has none: they cost
    /// little, and where goal configurations are easy to sample nothing is faster.
    pub heads: u32,
    /// Extensions of the tree of configurations after which the search gives up.
    pub max_iterations: u32,
}

impl Default for BiSpaceOptions {
    fn default() -> Self {
        Self {
            forward: 10,
            backward: 1,
            step: 0.1,
            goal_step: 0.2,
            support: 2,
            start_bias: 0.1,
            tolerance: 0.02,
            metric: TreeMetric::Plain,
            probability: FollowProbability::Constant(1.0),
            follow: FollowOptions::default(),
            inverse: Some(RrtOptions { max_iterations: 200, ..RrtOptions::default() }),
            heads: 4,
            max_iterations: 5000,
        }
    }
}

/// Moves the tool from where it is at `start` to one of `goals`.
///
/// With inverse kinematics the tool ends exactly at its goal, otherwise within the tolerance.
pub fn bispace<W: Workspace + ?Sized, C: EdgeChecker + ?Sized>(
    workspace: &mut W,
    checker: &mut C,
    start: &[f64],
    goals: &[W::Point],
    options: &BiSpaceOptions,
    budget: &Budget<'_>,
    rng: &mut Rng,
) -> Result<ToolSolution, ToolFailure> {
    let mut search = Search {
        forward: Forward::new(workspace, start, goals),
        backward: GoalTree::new(goals),
        start: workspace.point(start),
        workspace,
        options,
        statistics: ToolStatistics::default(),
    };
    let outcome = search.run(checker, start, budget, rng);
    let Search { forward, backward, mut statistics, .. } = search;
    statistics.nodes = forward.tree.len();
    statistics.goal_nodes = backward.len();
    statistics.blocked = forward.blocked;
    match outcome {
        Ok(Reached { node, goal, rest }) => {
            let mut path = forward.tree.path_to_root(node);
            path.reverse();
            path.extend(rest);
            Ok(ToolSolution { path, goal, statistics })
        }
        Err(reason) => Err(ToolFailure { reason, nearest: forward.nearest.0, statistics }),
    }
}

/// Whether there is a free configuration with the tool at `point`, for one random place of the base within reach.
fn is_supported<W: Workspace + ?Sized, C: EdgeChecker + ?Sized>(
    workspace: &mut W,
    checker: &mut C,
    point: &W::Point,
    rng: &mut Rng,
) -> bool {
    let q = workspace.sample_near(checker.space(), point, rng);
    workspace.solutions(&q, point).iter().any(|q| checker.state(q).is_ok())
}

/// A node from which the goal is reached, and the way of the arm from there.
struct Reached {
    node: usize,
    goal: usize,
    rest: Vec<Vec<f64>>,
}

struct Search<'s, W: Workspace + ?Sized> {
    workspace: &'s mut W,
    forward: Forward<'s, W::Point>,
    backward: GoalTree<W::Point>,
    /// The tool at the start.
    start: W::Point,
    options: &'s BiSpaceOptions,
    statistics: ToolStatistics,
}

impl<W: Workspace + ?Sized> Search<'_, W> {
    fn run<C: EdgeChecker + ?Sized>(
        &mut self,
        checker: &mut C,
        start: &[f64],
        budget: &Budget<'_>,
        rng: &mut Rng,
    ) -> Result<Reached, ToolFailureReason> {
        checker.state(start).map_err(ToolFailureReason::Start)?;
        if self.backward.len() == 0 {
            return Err(ToolFailureReason::NoGoal);
        }
        let options = self.options;
        // Many goals are reached by going straight to them.
        let pose = self.backward.nearest(&*self.workspace, &self.start);
        if let Some(reached) = self.follow(checker, 0, pose, budget, rng)? {
            return Ok(reached);
        }
        loop {
            for _ in 0..options.heads {
                budget.check().map_err(ToolFailureReason::Interrupted)?;
                if let Some(reached) = self.head_for_a_goal(checker, rng) {
                    return Ok(reached);
                }
            }
            for _ in 0..options.backward {
                budget.check().map_err(ToolFailureReason::Interrupted)?;
                let mut supported = |workspace: &mut W, point: &W::Point, rng: &mut Rng| {
                    options.support == 0
                        || (0..options.support).any(|_| is_supported(workspace, &mut *checker, point, rng))
                };
                self.backward.extend(
                    &mut *self.workspace,
                    &self.start,
                    options.start_bias,
                    options.goal_step,
                    rng,
                    &mut supported,
                );
            }
            for _ in 0..options.forward.max(1) {
                budget.check().map_err(ToolFailureReason::Interrupted)?;
                if self.statistics.iterations >= options.max_iterations {
                    return Err(ToolFailureReason::Iterations);
                }
                self.statistics.iterations += 1;
                let extended =
                    self.forward.extend(&*self.workspace, checker, options.metric, options.step, rng);
                let Some(node) = extended else { continue };
                let probability = match options.probability {
                    FollowProbability::Constant(p) => p,
                    FollowProbability::Near(least) => self.forward.nearness(node).max(least),
                };
                // Where following has failed before, it is less likely to help.
                let point = self.workspace.point(self.forward.tree.state(node));
                let pose = self.backward.nearest(&*self.workspace, &point);
                let discount = 1.0 / f64::from(1 + self.backward.dead_ends(pose));
                if rng.unit() < discount * probability
                    && let Some(reached) = self.follow(checker, node, pose, budget, rng)?
                {
                    return Ok(reached);
                }
            }
        }
    }

    /// Samples a free configuration at a goal, and goes from the nearest node straight towards it as far as that is free.
    fn head_for_a_goal<C: EdgeChecker + ?Sized>(
        &mut self,
        checker: &mut C,
        rng: &mut Rng,
    ) -> Option<Reached> {
        self.statistics.inverse_tests += 1;
        let goal = rng.below(self.forward.goals().len());
        let point = self.forward.goals()[goal].clone();
        let sample = self.workspace.sample_near(checker.space(), &point, rng);
        let solutions = self.workspace.solutions(&sample, &point);
        let end = solutions.into_iter().find(|q| checker.state(q).is_ok())?;
        let space = checker.space().clone();
        let step = self.options.step * space.diameter();
        let mut node = self.forward.tree.nearest_by(|_, q| space.distance(q, &end));
        loop {
            let from = self.forward.tree.state(node).to_vec();
            let length = space.distance(&from, &end);
            let next =
                if length > step { space.interpolate(&from, &end, step / length) } else { end.clone() };
            if !self.forward.is_free(checker, &from, &next) {
                return None;
            }
            node = self.forward.push(&*self.workspace, node, &next);
            if length <= step {
                return Some(Reached { node, goal, rest: vec![] });
            }
        }
    }

    /// Follows the tool from `node` to a goal, with inverse kinematics at the end.
    fn follow<C: EdgeChecker + ?Sized>(
        &mut self,
        checker: &mut C,
        node: usize,
        pose: usize,
        budget: &Budget<'_>,
        rng: &mut Rng,
    ) -> Result<Option<Reached>, ToolFailureReason> {
        self.statistics.follows += 1;
        let options = self.options;
        let goal = self.backward.root(pose);
        let goal_point = self.backward.point(goal).clone();
        if let Some(rest) = self.finish(checker, node, &goal_point, budget, rng)? {
            return Ok(Some(Reached { node, goal, rest }));
        }
        let first = node;
        let node = follow(
            &*self.workspace,
            checker,
            &mut self.forward,
            &mut self.backward,
            node,
            pose,
            &options.follow,
            options.tolerance,
            0.5 * options.goal_step,
            budget,
            rng,
        )
        .map_err(ToolFailureReason::Interrupted)?;
        if node != first
            && let Some(rest) = self.finish(checker, node, &goal_point, budget, rng)?
        {
            return Ok(Some(Reached { node, goal, rest }));
        }
        let q = self.forward.tree.state(node);
        let near = self.workspace.distance(&self.workspace.point(q), &goal_point) < options.tolerance;
        Ok(near.then(|| Reached { node, goal, rest: vec![] }))
    }

    /// The way of the arm from `node` to inverse kinematics of the goal, without the node itself.
    fn finish<C: EdgeChecker + ?Sized>(
        &mut self,
        checker: &mut C,
        node: usize,
        goal: &W::Point,
        budget: &Budget<'_>,
        rng: &mut Rng,
    ) -> Result<Option<Vec<Vec<f64>>>, ToolFailureReason> {
        let Some(rrt) = &self.options.inverse else { return Ok(None) };
        self.statistics.inverse_tests += 1;
        let q = self.forward.tree.state(node).to_vec();
        for solution in self.workspace.solutions(&q, goal) {
            if checker.state(&solution).is_err() {
                continue;
            }
            let arm: Vec<usize> = (0..q.len()).filter(|i| !self.workspace.base().contains(i)).collect();
            let mut of_arm = Subspace::new(&mut *checker, &arm, &q);
            let from = of_arm.select(&q);
            let mut goals = FixedGoals::new(vec![of_arm.select(&solution)]);
            return match RrtConnect::new(&from).run(&mut of_arm, None, &mut goals, rrt, budget, rng) {
                Ok(found) => Ok(Some(found.path.iter().skip(1).map(|q| of_arm.embed(q)).collect())),
                // Where one branch is out of the arm's reach, another hardly is not.
                Err(failure) => match failure.reason {
                    RrtFailureReason::Interrupted(i) => Err(ToolFailureReason::Interrupted(i)),
                    _ => Ok(None),
                },
            };
        }
        Ok(None)
    }
}
