//! Straight motion of the tool.

use nalgebra::Vector6;
use robotc_core::Pose;
use robotc_core::ik::IkSolutions;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::arm::ArmModel;
use crate::edge::{Blocked, EdgeChecker, Obstruction};

/// Parameters of a straight motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LineOptions {
    /// Longest way of the tool between two configurations, metres.
    pub step: f64,
    /// Largest turn of the tool between two configurations, radians.
    pub turn: f64,
    /// Largest distance of the tool from the line in between, metres; configurations are added until it holds.
    pub tolerance: f64,
    /// Largest change of any joint between two configurations, radians or metres: more is a change of branch.
    pub joint_step: f64,
}

impl LineOptions {
    /// Options for an arm of this reach, metres: steps of a seventieth of it, a tolerance of a three-thousandth.
    pub fn for_reach(reach: f64) -> Self {
        Self { step: reach / 70.0, turn: 0.1, tolerance: reach / 3000.0, joint_step: 0.4 }
    }
}

/// What ended a straight motion before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Error)]
pub enum LineObstacle {
    /// The next pose has no inverse kinematics.
    #[error("the pose is out of reach")]
    Unreachable,
    /// The next pose is reached only outside of the joint limits.
    #[error("a joint limit is in the way")]
    Limits,
    /// The next pose is reached only by a jump to another branch.
    #[error("the branch of inverse kinematics ends")]
    BranchEnds,
    /// The motion is not free.
    #[error("the way is blocked")]
    Blocked(Obstruction),
}

/// A straight motion that could not be finished.
#[derive(Debug, Clone, PartialEq)]
pub struct LineFailure {
    /// How far it got, 0 to 1.
    pub fraction: f64,
    /// What ended it.
    pub obstacle: LineObstacle,
    /// The part that works, from the start; valid by itself.
    pub path: Vec<Vec<f64>>,
}

/// Moves the tool in a straight line from where it is at `start` to `world_from_goal`, turning evenly on the way.
///
/// The path follows one branch of inverse kinematics without a jump; free variables drift as the smallest joint motion
/// asks. Between its states the tool stays within the tolerance of the line, and `checker` found all motions free.
/// `start` itself is taken to be valid. The path contains both ends.
pub fn cartesian_line<C: EdgeChecker + ?Sized>(
    arm: &ArmModel,
    checker: &mut C,
    start: &[f64],
    world_from_goal: &Pose,
    options: &LineOptions,
) -> Result<Vec<Vec<f64>>, LineFailure> {
    let world_from_start = arm.world_from_tool(start);
    let (from, to) = (world_from_start.translation.vector, world_from_goal.translation.vector);
    let turn = world_from_start.rotation.angle_to(&world_from_goal.rotation);
    let at = |fraction: f64| -> Pose {
        let translation = from + (to - from) * fraction;
        // Nearly opposite orientations have no shortest way; nalgebra then keeps the start's.
        let rotation = world_from_start
            .rotation
            .try_slerp(&world_from_goal.rotation, fraction, 1e-12)
            .unwrap_or(world_from_start.rotation);
        Pose::from_parts(translation.into(), rotation)
    };
    let steps = ((to - from).norm() / options.step).max(turn / options.turn).ceil().max(1.0);
    let mut scratch = IkSolutions::new();
    let mut path = vec![start.to_vec()];
    let mut done = 0.0;
    // Fractions still to be reached, the next one last.
    let mut ahead: Vec<f64> = (1..=steps as usize).rev().map(|k| k as f64 / steps).collect();
    while let Some(&fraction) = ahead.last() {
        let here = &path[path.len() - 1];
        let fail = |obstacle, path: &Vec<Vec<f64>>| {
            Err(LineFailure { fraction: done, obstacle, path: path.clone() })
        };
        let splittable = fraction - done > SHORTEST / steps;
        match next_on_branch(arm, here, &at(fraction), options, &mut scratch) {
            Ok(q) => {
                let middle = checker.space().interpolate(here, &q, 0.5);
                let offset = arm.world_from_tool(&middle).translation.vector
                    - at(0.5 * (done + fraction)).translation.vector;
                if offset.norm() > options.tolerance {
                    if !splittable {
                        return fail(LineObstacle::BranchEnds, &path);
                    }
                    ahead.push(0.5 * (done + fraction));
                    continue;
                }
                if let Err(Blocked { by, .. }) = checker.edge(here, &q) {
                    return fail(LineObstacle::Blocked(by), &path);
                }
                path.push(q);
                done = fraction;
                ahead.pop();
            }
            // Near a singularity joints move fast: shorter steps may stay on the branch.
            Err(LineObstacle::BranchEnds) if splittable => {
                ahead.push(0.5 * (done + fraction));
            }
            Err(obstacle) => return fail(obstacle, &path),
        }
    }
    Ok(path)
}

/// Steps are halved until they are shorter than this fraction of the planned one: a branch that is left then is not one
/// that could be driven, and halving on would ask for inverse kinematics thousands of times.
const SHORTEST: f64 = 0.1;

/// The configuration for `world_from_tool` next to `here`.
fn next_on_branch(
    arm: &ArmModel,
    here: &[f64],
    world_from_tool: &Pose,
    options: &LineOptions,
    scratch: &mut IkSolutions,
) -> Result<Vec<f64>, LineObstacle> {
    let now = arm.world_from_tool(here);
    let linear = world_from_tool.translation.vector - now.translation.vector;
    let angular = (world_from_tool.rotation * now.rotation.inverse()).scaled_axis();
    let twist = Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z);
    let free_variables = arm.free_variables();
    let mut predicted = here.to_vec();
    if !free_variables.is_empty() {
        for (q, d) in predicted.iter_mut().zip(arm.follow(here, &twist)) {
            *q += d.clamp(-options.joint_step, options.joint_step);
        }
        arm.space().clamp(&mut predicted);
    }
    let mut outcome = LineObstacle::Unreachable;
    // The predicted free values first, then the present ones, then small steps to either side.
    for nudge in FREE_NUDGES {
        let free: Vec<f64> = free_variables
            .iter()
            .map(|&v| match nudge {
                None => predicted[v],
                Some(d) => here[v] + d * options.joint_step,
            })
            .collect();
        let in_limits = free_variables.iter().zip(&free).all(|(&v, &value)| {
            let axis = &arm.space().axes()[v];
            axis.wraps || (axis.lower..=axis.upper).contains(&value)
        });
        if in_limits {
            let (solutions, outside) = arm.inverse(world_from_tool, &free, &predicted, scratch);
            let near = solutions
                .into_iter()
                .find(|q| arm.space().difference(here, q).iter().all(|d| d.abs() <= options.joint_step));
            match near {
                Some(q) => return Ok(q),
                None if !scratch.is_empty() => {
                    outcome = if outside == scratch.len() {
                        LineObstacle::Limits
                    } else {
                        LineObstacle::BranchEnds
                    };
                }
                None => {}
            }
        }
        if free_variables.is_empty() {
            break;
        }
    }
    Err(outcome)
}

/// Free values tried, as fractions of the joint step from the present ones; `None`: as predicted.
const FREE_NUDGES: [Option<f64>; 8] =
    [None, Some(0.0), Some(0.1), Some(-0.1), Some(0.3), Some(-0.3), Some(0.9), Some(-0.9)];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Space;
    use crate::testbed::{self, REST};
    use nalgebra::{Translation3, UnitQuaternion, Vector3};
    use robotc_core::ik::InverseKinematics;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering};

    /// Joint limits, and a wall that the tool may not pass.
    struct Wall<'a> {
        arm: &'a ArmModel,
        x: f64,
    }

    impl EdgeChecker for Wall<'_> {
        fn space(&self) -> &Space {
            self.arm.space()
        }
        fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
            if !self.arm.space().contains(q) {
                return Err(Obstruction::Bounds);
            }
            let x = self.arm.world_from_tool(q).translation.x;
            if x > self.x { Err(Obstruction::Contact(7)) } else { Ok(0.0) }
        }
        fn travel(&self, difference: &[f64]) -> f64 {
            difference.iter().map(|d| d.abs()).sum()
        }
        fn resolution(&self) -> f64 {
            0.01
        }
    }

    fn check_line(arm: &ArmModel, path: &[Vec<f64>], goal: &Pose) {
        let start = arm.world_from_tool(&path[0]);
        let direction = (goal.translation.vector - start.translation.vector).normalize();
        let mut last = -1e-9;
        for pair in path.windows(2) {
            for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let p =
                    arm.world_from_tool(&arm.space().interpolate(&pair[0], &pair[1], t)).translation.vector;
                let along = (p - start.translation.vector).dot(&direction);
                let off = (p - start.translation.vector - direction * along).norm();
                assert!(off < 6e-4, "{off}");
                assert!(along >= last - 1e-9, "the tool never goes back");
                last = along;
            }
            assert!(arm.space().difference(&pair[0], &pair[1]).iter().all(|d| d.abs() <= 0.4));
        }
        let end = arm.world_from_tool(path.last().unwrap());
        assert!((end.to_homogeneous() - goal.to_homogeneous()).norm() < 1e-8);
    }

    #[test]
    fn the_tool_keeps_to_the_line() {
        for rail in [false, true] {
            let arm = testbed::arm(rail);
            let start = if rail { [&[0.1], &REST[..]].concat() } else { REST.to_vec() };
            let pose = arm.world_from_tool(&start);
            for (offset, turn) in [
                (Vector3::new(0.15, 0.0, 0.0), 0.0),
                (Vector3::new(0.0, 0.3, 0.1), 0.3),
                (Vector3::new(-0.1, -0.1, -0.2), -0.5),
            ] {
                let goal = Pose::from_parts(
                    Translation3::from(pose.translation.vector + offset),
                    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn) * pose.rotation,
                );
                let mut checker = Wall { arm: &arm, x: f64::INFINITY };
                let path =
                    cartesian_line(&arm, &mut checker, &start, &goal, &LineOptions::for_reach(1.5)).unwrap();
                assert_eq!(path[0], start);
                check_line(&arm, &path, &goal);
            }
        }
    }

    #[test]
    fn a_failure_tells_how_far_it_got() {
        let arm = testbed::arm(false);
        let pose = arm.world_from_tool(&REST);
        let goal = Translation3::new(0.2, 0.0, 0.0) * pose;
        let mut wall = Wall { arm: &arm, x: pose.translation.x + 0.1 };
        let stopped =
            cartesian_line(&arm, &mut wall, &REST, &goal, &LineOptions::for_reach(1.5)).unwrap_err();
        assert_eq!(stopped.obstacle, LineObstacle::Blocked(Obstruction::Contact(7)));
        assert!((0.35..=0.5).contains(&stopped.fraction), "{}", stopped.fraction);
        let reached = arm.world_from_tool(stopped.path.last().unwrap()).translation.x - pose.translation.x;
        assert!((reached - 0.2 * stopped.fraction).abs() < 1e-8);

        let far = Translation3::new(2.0, 0.0, 0.0) * pose;
        let mut open = Wall { arm: &arm, x: f64::INFINITY };
        let beyond = cartesian_line(&arm, &mut open, &REST, &far, &LineOptions::for_reach(1.5)).unwrap_err();
        assert!(beyond.fraction > 0.05 && beyond.fraction < 0.5, "{}", beyond.fraction);
        assert!(matches!(beyond.obstacle, LineObstacle::Unreachable | LineObstacle::BranchEnds));
    }

    /// Changes from one elbow to the other at a height, and counts how often it is asked.
    struct Flips {
        inner: testbed::ClosedForm,
        height: f64,
        asked: AtomicU32,
    }

    impl InverseKinematics for Flips {
        fn variables(&self) -> usize {
            self.inner.variables()
        }
        fn free_variables(&self) -> &[usize] {
            self.inner.free_variables()
        }
        fn solve(&self, base_from_tip: &Pose, free: &[f64], out: &mut IkSolutions) {
            self.asked.fetch_add(1, Ordering::Relaxed);
            let mut all = IkSolutions::new();
            self.inner.solve(base_from_tip, free, &mut all);
            out.reset(self.variables());
            let above = base_from_tip.translation.z > self.height;
            all.iter().filter(|q| (q[2] > 0.0) == above).for_each(|q| out.push(q));
        }
    }

    #[test]
    fn a_branch_that_ends_is_left_soon_and_never_jumped_from() {
        // Nearly stretched, both elbows are a small change of the joints apart, and no straight motion joins them.
        let start = [0.0, -0.2, 0.1, 0.0, 0.3, 0.0];
        let pose = testbed::arm(false).world_from_tool(&start);
        let tip_height = (pose * testbed::arm(false).tool_from_tip()).translation.z;
        let flips = Arc::new(Flips {
            inner: testbed::ClosedForm { rail: false },
            height: tip_height - 0.024,
            asked: AtomicU32::new(0),
        });
        let arm = testbed::arm_with(false, flips.clone());
        let goal = Translation3::new(0.0, 0.0, -0.06) * pose;
        let mut open = Wall { arm: &arm, x: f64::INFINITY };
        let stopped =
            cartesian_line(&arm, &mut open, &start, &goal, &LineOptions::for_reach(1.5)).unwrap_err();
        assert_eq!(stopped.obstacle, LineObstacle::BranchEnds);
        assert!((0.3..=0.4).contains(&stopped.fraction), "{}", stopped.fraction);
        let asked = flips.asked.load(Ordering::Relaxed);
        assert!(asked < 40, "asked {asked} times");
    }
}
