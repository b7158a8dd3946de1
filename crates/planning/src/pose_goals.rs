//! Goals given as poses of the tool: inverse kinematics finds the configurations while the search runs.

use robotc_core::Pose;
use robotc_core::ik::IkSolutions;
use robotc_core::rng::Rng;

use crate::arm::ArmModel;
use crate::budget::{Budget, Interrupt};
use crate::edge::EdgeChecker;
use crate::goal::{GoalDraw, GoalSampler};

/// Goal configurations, and then those of goal poses: of each pose all branches nearest to the start first, and for a redundant arm
/// one value of the free joints in each round.
pub struct PoseGoals<'a, C> {
    arm: &'a ArmModel,
    checker: C,
    world_from_tools: &'a [Pose],
    near: Vec<f64>,
    rounds: usize,
    rng: Rng,
    /// Goals still to be handed out, the next one last, each with its number among configurations and then poses.
    ready: Vec<(usize, Vec<f64>)>,
    first_pose: usize,
    next: usize,
    handed_out: Vec<usize>,
    rejected: usize,
}

impl<'a, C: EdgeChecker> PoseGoals<'a, C> {
    /// Goals that `checker` finds valid. `configurations` come first; `near` is the start. For a redundant arm `rounds` values of its
    /// free joints are tried for each pose, those of `near` first.
    pub fn new(
        arm: &'a ArmModel,
        checker: C,
        configurations: &[Vec<f64>],
        world_from_tools: &'a [Pose],
        near: &[f64],
        rounds: usize,
        rng: Rng,
    ) -> Self {
        let rounds = if arm.free_variables().is_empty() { 1 } else { rounds.max(1) };
        let ready: Vec<(usize, Vec<f64>)> = configurations.iter().cloned().enumerate().rev().collect();
        let first_pose = configurations.len();
        let (next, handed_out, rejected) = (0, Vec::new(), 0);
        let near = near.to_vec();
        Self {
            arm,
            checker,
            world_from_tools,
            near,
            rounds,
            rng,
            ready,
            first_pose,
            next,
            handed_out,
            rejected,
        }
    }

    /// For each goal that was drawn, its number: configurations count first, then poses.
    pub fn numbers(&self) -> &[usize] {
        &self.handed_out
    }

    /// Configurations that were looked at and not valid.
    pub fn rejected(&self) -> usize {
        self.rejected
    }
}

impl<C: EdgeChecker> GoalSampler for PoseGoals<'_, C> {
    fn draw(&mut self, budget: &Budget<'_>) -> Result<GoalDraw, Interrupt> {
        budget.check()?;
        if let Some((number, q)) = self.ready.pop() {
            if self.checker.state(&q).is_err() {
                self.rejected += 1;
                return Ok(GoalDraw::Pending);
            }
            self.handed_out.push(number);
            return Ok(GoalDraw::Goal(q));
        }
        let poses = self.world_from_tools.len();
        if self.next >= poses * self.rounds {
            return Ok(GoalDraw::Exhausted);
        }
        let (round, pose) = (self.next / poses, self.next % poses);
        self.next += 1;
        let free = self.arm.free_variables();
        let values: Vec<f64> = match round {
            0 => free.iter().map(|&v| self.near[v]).collect(),
            _ => {
                let sample = self.arm.space().sample(&mut self.rng);
                free.iter().map(|&v| sample[v]).collect()
            }
        };
        let scratch = &mut IkSolutions::new();
        let (solutions, _) = self.arm.inverse(&self.world_from_tools[pose], &values, &self.near, scratch);
        self.ready = solutions.into_iter().rev().map(|q| (self.first_pose + pose, q)).collect();
        Ok(GoalDraw::Pending)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testbed::{self, Limits, REST};
    use robotc_core::Seed;

    #[test]
    fn poses_are_reached_by_what_is_drawn() {
        for rail in [false, true] {
            let arm = testbed::arm(rail);
            let rest = if rail { [&[0.0], &REST[..]].concat() } else { REST.to_vec() };
            let mut far = arm.world_from_tool(&rest);
            far.translation.vector.x += 9.0;
            let poses = [far, arm.world_from_tool(&rest)];
            let rng = Seed::new(1).rng();
            let mut goals =
                PoseGoals::new(&arm, Limits::new(&arm), &[vec![9.0; rest.len()]], &poses, &rest, 3, rng);
            let mut drawn = Vec::new();
            loop {
                match goals.draw(&Budget::unlimited()).unwrap() {
                    GoalDraw::Goal(q) => drawn.push(q),
                    GoalDraw::Pending => {}
                    GoalDraw::Exhausted => break,
                }
            }
            assert!(drawn.len() >= 2 && goals.rejected() == 1, "{}", drawn.len());
            assert!(goals.numbers().iter().all(|&n| n == 2), "the reachable pose: {:?}", goals.numbers());
            for q in &drawn {
                assert!((arm.world_from_tool(q).to_homogeneous() - poses[1].to_homogeneous()).norm() < 1e-6);
            }
        }
    }
}
