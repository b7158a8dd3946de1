//! Free motions of the arm: searched, smoothed, and explained where there is none.

use robotc_core::Configuration;
use robotc_core::rng::Rng;

use super::plan::{GoalFailure, Nearest, SegmentKind, Stage};
use super::problem::GoalContext;
use super::sequence::Observer;
use super::stretch::{cause, fine_checker};
use crate::budget::Budget;
use crate::constraint::Constraint;
use crate::edge::{EdgeChecker, Obstruction};
use crate::goal::GoalSampler;
use crate::rrt::{RrtConnect, RrtFailure, RrtFailureReason, RrtSolution};
use crate::scene::{RobotChecker, Rules, Scene};
use crate::smooth::smooth;

/// Rules of free motion; without a margin when the robot already stands too near to something to keep it.
pub(super) fn start_rules(cx: &GoalContext<'_>, scene: &Scene, q: &Configuration, start: &[f64]) -> Rules {
    let rules = cx.free(None);
    let keeps = fine_checker(cx, scene, q, rules.clone()).state(start);
    match keeps {
        Err(Obstruction::Contact(_)) => Rules { margin: 0.0, ..rules },
        _ => rules,
    }
}

/// A search for a free motion of the arm.
pub(super) struct FreeMotion<'c, 'a> {
    pub(super) cx: &'c GoalContext<'a>,
    pub(super) scene: &'c Scene,
    pub(super) q: &'c Configuration,
    pub(super) rules: Rules,
    pub(super) constraint: Option<&'c dyn Constraint>,
    pub(super) kind: SegmentKind,
}

impl<'c> FreeMotion<'c, '_> {
    fn checker(&self) -> RobotChecker<'c> {
        let arm = self.cx.problem.arm;
        let resolution = self.cx.options.resolution;
        RobotChecker::new(self.scene, arm.space(), arm.dofs(), self.q, self.rules.clone(), resolution)
            .with_constraint(self.constraint)
    }

    pub(super) fn search(
        &mut self,
        from: &[f64],
        goals: &mut dyn GoalSampler,
        budget: &Budget<'_>,
        rng: &mut Rng,
        observer: &mut dyn Observer,
    ) -> Result<RrtSolution, RrtFailure> {
        let mut search = RrtConnect::new(from);
        let options = &self.cx.options.rrt;
        let outcome = search.run(&mut self.checker(), self.constraint, goals, options, budget, rng);
        let statistics = match &outcome {
            Ok(solution) => &solution.statistics,
            Err(failure) => &failure.statistics,
        };
        observer.searched(self.cx.number, self.kind, &search, statistics);
        outcome
    }

    pub(super) fn smoothed(&self, path: Vec<Vec<f64>>, budget: &Budget<'_>, rng: &mut Rng) -> Vec<Vec<f64>> {
        smooth(&mut self.checker(), path, &self.cx.options.smoothers, budget, rng)
    }

    /// The failure with what stopped the edges, and how near it came.
    pub(super) fn failed(&self, failure: &RrtFailure) -> Box<GoalFailure> {
        let stage = if self.kind == SegmentKind::Carry { Stage::Carry } else { Stage::Reach };
        let mut missed = GoalFailure::new(self.cx.object_name(), stage);
        let done = &failure.statistics;
        missed.message = match failure.reason {
            RrtFailureReason::Interrupted(_) => {
                format!("{} iterations towards {} goals", done.iterations, done.goals)
            }
            RrtFailureReason::Start(by) => format!("the start is not free: {}", cause(self.scene, by)),
            _ => failure.to_string(),
        };
        if let RrtFailureReason::Interrupted(interrupt) = failure.reason {
            missed.interrupt = Some(interrupt);
        }
        missed.rejections.edges = done.blocked.iter().map(|(&by, &n)| (cause(self.scene, by), n)).collect();
        missed.nearest = done.nearest.as_ref().map(|gap| {
            let arm = self.cx.problem.arm;
            let apart = arm.world_from_tool(&gap.from_start).inv_mul(&arm.world_from_tool(&gap.from_goal));
            Nearest { distance: apart.translation.vector.norm(), angle: apart.rotation.angle() }
        });
        missed
    }
}
