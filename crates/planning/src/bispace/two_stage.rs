//! Configurations at the goal first, then RRT-Connect to them. A baseline, and a goal sampler of its own.

use robotc_core::Seed;
use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use super::workspace::{ToolFailure, ToolFailureReason, ToolSolution, ToolStatistics, Workspace};
use crate::budget::{Budget, Interrupt};
use crate::edge::EdgeChecker;
use crate::goal::{FixedGoals, GoalDraw, GoalSampler};
use crate::rrt::{RrtConnect, RrtFailureReason, RrtOptions};

/// Parameters of the two stages.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TwoStageOptions {
    /// Goal configurations to find before the search begins; it uses all of them.
    pub goals: u32,
    /// Places of the base tried before the sampling gives up.
    pub max_draws: u32,
    /// The search.
    pub rrt: RrtOptions,
}

impl Default for TwoStageOptions {
    fn default() -> Self {
        Self { goals: 1, max_draws: 20_000, rrt: RrtOptions::default() }
    }
}

/// Free configurations with the tool at one of its goals, for random places of the base within reach.
pub struct SampledGoals<'a, W: Workspace + ?Sized, C: ?Sized> {
    workspace: &'a mut W,
    checker: &'a mut C,
    goals: &'a [W::Point],
    rng: Rng,
    /// Places of the base tried so far.
    pub draws: u32,
    /// For each goal configuration handed out, the number of the goal.
    pub of_goal: Vec<usize>,
}

impl<'a, W: Workspace + ?Sized, C: EdgeChecker + ?Sized> SampledGoals<'a, W, C> {
    /// Configurations at these goals.
    pub fn new(workspace: &'a mut W, checker: &'a mut C, goals: &'a [W::Point], seed: Seed) -> Self {
        Self { workspace, checker, goals, rng: seed.rng(), draws: 0, of_goal: Vec::new() }
    }
}

impl<W: Workspace + ?Sized, C: EdgeChecker + ?Sized> GoalSampler for SampledGoals<'_, W, C> {
    fn draw(&mut self, _: &Budget<'_>) -> Result<GoalDraw, Interrupt> {
        if self.goals.is_empty() {
            return Ok(GoalDraw::Exhausted);
        }
        self.draws += 1;
        let number = self.rng.below(self.goals.len());
        let goal = &self.goals[number];
        let q = self.workspace.sample_near(self.checker.space(), goal, &mut self.rng);
        for solution in self.workspace.solutions(&q, goal) {
            if self.checker.state(&solution).is_ok() {
                self.of_goal.push(number);
                return Ok(GoalDraw::Goal(solution));
            }
        }
        Ok(GoalDraw::Pending)
    }
}

/// Samples configurations at the goals, then plans to them.
pub fn two_stage<W: Workspace + ?Sized, C: EdgeChecker + ?Sized>(
    workspace: &mut W,
    checker: &mut C,
    start: &[f64],
    goals: &[W::Point],
    options: &TwoStageOptions,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<ToolSolution, ToolFailure> {
    let mut statistics = ToolStatistics::default();
    let fail = |reason, statistics| Err(ToolFailure { reason, nearest: f64::INFINITY, statistics });
    let mut found = Vec::new();
    let mut sampler = SampledGoals::new(&mut *workspace, &mut *checker, goals, seed.split("goals"));
    while found.len() < options.goals.max(1) as usize && sampler.draws < options.max_draws {
        match budget.check().and_then(|()| sampler.draw(budget)) {
            Ok(GoalDraw::Goal(q)) => found.push(q),
            Ok(GoalDraw::Pending) => {}
            Ok(GoalDraw::Exhausted) => break,
            Err(interrupt) => {
                statistics.inverse_tests = sampler.draws;
                return fail(ToolFailureReason::Interrupted(interrupt), statistics);
            }
        }
    }
    statistics.inverse_tests = sampler.draws;
    let of_goal = std::mem::take(&mut sampler.of_goal);
    if found.is_empty() {
        return fail(ToolFailureReason::NoGoal, statistics);
    }
    let mut search = RrtConnect::new(start);
    let mut rng = seed.split("search").rng();
    let outcome = search.run(checker, None, &mut FixedGoals::new(found), &options.rrt, budget, &mut rng);
    let (result, counts) = match outcome {
        Ok(solution) => (Ok((solution.path, of_goal[solution.goal])), solution.statistics),
        Err(failure) => (Err(failure.reason), failure.statistics),
    };
    statistics.iterations = counts.iterations;
    statistics.nodes = counts.start_nodes + counts.goal_nodes;
    statistics.blocked = counts.blocked;
    match result {
        Ok((path, goal)) => Ok(ToolSolution { path, goal, statistics }),
        Err(RrtFailureReason::Start(by)) => fail(ToolFailureReason::Start(by), statistics),
        Err(RrtFailureReason::Interrupted(i)) => fail(ToolFailureReason::Interrupted(i), statistics),
        Err(RrtFailureReason::Iterations) => fail(ToolFailureReason::Iterations, statistics),
        Err(RrtFailureReason::NoGoal) => fail(ToolFailureReason::NoGoal, statistics),
    }
}
