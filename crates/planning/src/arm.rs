//! An arm as planners need it: its configuration space, limits, tool pose and inverse kinematics.

use std::sync::Arc;

use nalgebra::{Matrix6, Matrix6xX, Point3, SVector, Vector6};
use robotc_core::ik::{IkSolutions, InverseKinematics, VariableRange};
use robotc_core::model::{ChainError, ChainMotion};
use robotc_core::robot::Robot;
use robotc_core::{Configuration, DofIdx, Kinematics, Pose, SerialChain};
use thiserror::Error;

use crate::space::{Axis, Space};
use crate::timing::MotionLimits;

/// Why an arm cannot be planned for.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum ArmError {
    /// Base and tip span no chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// The solver was made for another chain.
    #[error("the inverse kinematics has {found} variables, the arm {expected}")]
    Variables {
        /// Of the solver.
        found: usize,
        /// Of the arm.
        expected: usize,
    },
}

/// A placed arm with its tool. Joint vectors are in the order of [`dofs`](Self::dofs), base to tip.
#[derive(Clone)]
pub struct ArmModel {
    chain: SerialChain,
    dofs: Vec<DofIdx>,
    names: Vec<String>,
    /// Whether each variable is an angle.
    turns: Vec<bool>,
    ik: Arc<dyn InverseKinematics>,
    space: Space,
    limits: MotionLimits,
    world_from_base: Pose,
    tip_from_tool: Pose,
}

impl ArmModel {
    /// Arm number `arm` of a robot that stands at `world_from_robot`, its other joints as in `q`.
    ///
    /// The tool is that of the arm's gripper, or else the tip link. `weights`, in the order of the arm's degrees of
    /// freedom, are those of the metric.
    pub fn new(
        robot: &Robot,
        kinematics: &Kinematics,
        arm: usize,
        ik: Arc<dyn InverseKinematics>,
        weights: &[f64],
        world_from_robot: &Pose,
        q: &Configuration,
    ) -> Result<Self, ArmError> {
        let (model, arm) = (kinematics.model(), &robot.arms[arm]);
        let chain = SerialChain::between(kinematics, arm.base, arm.tip)?;
        let found = ik.variables();
        if found != chain.variables.len() {
            return Err(ArmError::Variables { found, expected: chain.variables.len() });
        }
        let dofs: Vec<DofIdx> = chain.variables.iter().map(|v| v.dof).collect();
        let axis = |(&dof, &weight): (&DofIdx, &f64)| {
            let d = &model.dofs()[dof];
            Axis { lower: d.lower, upper: d.upper, wraps: d.continuous, weight }
        };
        let dynamics = |dof: &DofIdx| model.dofs()[*dof].dynamics;
        let limits = MotionLimits {
            velocity: dofs.iter().map(|d| dynamics(d).velocity).collect(),
            acceleration: dofs.iter().map(|d| dynamics(d).acceleration).collect(),
            jerk: dofs.iter().map(|d| dynamics(d).jerk).collect(),
        };
        let tip_from_tool = arm.gripper.map_or_else(Pose::identity, |g| {
            let gripper = &robot.grippers[g];
            let root_from_tip = kinematics.root_from_link(q, arm.tip);
            root_from_tip.inv_mul(&kinematics.root_from_link(q, gripper.palm)) * gripper.palm_from_tool
        });
        let mut turns = vec![false; chain.variables.len()];
        for joint in &chain.joints {
            turns[joint.variable] = joint.motion == ChainMotion::Revolute;
        }
        Ok(Self {
            turns,
            names: dofs.iter().map(|&d| model.dofs()[d].name.clone()).collect(),
            space: Space::new(dofs.iter().zip(weights).map(axis).collect()),
            world_from_base: world_from_robot * kinematics.root_from_link(q, arm.base),
            chain,
            dofs,
            ik,
            limits,
            tip_from_tool,
        })
    }

    /// The same arm of a robot that stood at `world_from_robot` and stands at `world_from_new` now.
    pub fn standing_at(&self, world_from_robot: &Pose, world_from_new: &Pose) -> Self {
        let robot_from_base = world_from_robot.inv_mul(&self.world_from_base);
        Self { world_from_base: world_from_new * robot_from_base, ..self.clone() }
    }

    /// The same arm with its base at `world_from_base`.
    pub(crate) fn on(&self, world_from_base: Pose) -> Self {
        Self { world_from_base, ..self.clone() }
    }

    /// The degrees of freedom, base to tip.
    pub fn dofs(&self) -> &[DofIdx] {
        &self.dofs
    }

    /// Their joint names.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The configuration space.
    pub fn space(&self) -> &Space {
        &self.space
    }

    /// Speed limits.
    pub fn limits(&self) -> &MotionLimits {
        &self.limits
    }

    /// An upper bound of the distance from the arm's base to its tool, metres: the lengths of all links on the way. The
    /// strokes of sliding joints are not counted, so that a long rail does not make a large arm.
    pub fn reach(&self) -> f64 {
        let bones = self.chain.joints.iter().map(|joint| &joint.previous_from_joint);
        bones
            .chain([&self.chain.last_from_tip, &self.tip_from_tool])
            .map(|p| p.translation.vector.norm())
            .sum()
    }

    /// `base_from_world`, the base being where the arm's chain starts.
    pub fn base_from_world(&self) -> Pose {
        self.world_from_base.inverse()
    }

    /// `tool_from_tip`: the link that the arm's chain ends at, in the tool frame.
    pub fn tool_from_tip(&self) -> Pose {
        self.tip_from_tool.inverse()
    }

    /// `world_from_tool` at `q`.
    pub fn world_from_tool(&self, q: &[f64]) -> Pose {
        self.world_from_base * self.chain.forward(q) * self.tip_from_tool
    }

    /// Derivative of the tool's pose at `q`: linear velocity of the tool's origin, then angular velocity, in world
    /// axes; one column for each variable.
    pub fn tool_jacobian(&self, q: &[f64]) -> Matrix6xX<f64> {
        let tool_in_world = self.world_from_tool(q).translation.vector;
        let mut jacobian = Matrix6xX::zeros(q.len());
        let mut pose = self.world_from_base;
        for joint in &self.chain.joints {
            pose *= joint.previous_from_joint;
            let value = joint.multiplier * q[joint.variable] + joint.offset;
            let axis = pose.rotation * joint.axis.into_inner();
            let (linear, angular) = match joint.motion {
                ChainMotion::Revolute => {
                    let linear = axis.cross(&(tool_in_world - pose.translation.vector));
                    pose.rotation *= nalgebra::UnitQuaternion::from_axis_angle(&joint.axis, value);
                    (linear, axis)
                }
                ChainMotion::Prismatic => {
                    pose.translation.vector += axis * value;
                    (axis, axis * 0.0)
                }
            };
            let mut column = jacobian.column_mut(joint.variable);
            for row in 0..3 {
                column[row] += joint.multiplier * linear[row];
                column[row + 3] += joint.multiplier * angular[row];
            }
        }
        jacobian
    }

    /// For each variable, how far a point fixed to the tool moves for each unit of it: metres, at most, at any values
    /// within the limits.
    pub fn point_travel(&self, point_in_tool: &Point3<f64>) -> Vec<f64> {
        let last_from_tool = self.chain.last_from_tip * self.tip_from_tool;
        // Distance of the point from the origin of the joint reached so far.
        let mut reach = (last_from_tool * point_in_tool).coords.norm();
        let mut travel = vec![0.0; self.dofs.len()];
        for joint in self.chain.joints.iter().rev() {
            let factor = joint.multiplier.abs();
            match joint.motion {
                ChainMotion::Revolute => travel[joint.variable] += factor * reach,
                ChainMotion::Prismatic => {
                    travel[joint.variable] += factor;
                    let axis = &self.space.axes()[joint.variable];
                    reach += factor * axis.lower.abs().max(axis.upper.abs()) + joint.offset.abs();
                }
            }
            reach += joint.previous_from_joint.translation.vector.norm();
        }
        travel
    }

    /// The small motion that moves the tool by `twist` (linear and angular, world axes): damped least squares, so that
    /// it stays bounded near singular configurations.
    pub fn follow(&self, q: &[f64], twist: &Vector6<f64>) -> Vec<f64> {
        const DAMPING: f64 = 1e-6;
        let jacobian = self.tool_jacobian(q);
        let gram = &jacobian * jacobian.transpose() + Matrix6::identity() * DAMPING;
        let multipliers: SVector<f64, 6> = match gram.cholesky() {
            Some(cholesky) => cholesky.solve(twist),
            None => Vector6::zeros(),
        };
        (jacobian.transpose() * multipliers).iter().copied().collect()
    }

    /// Positions of the variables that the caller of [`inverse`](Self::inverse) chooses.
    pub fn free_variables(&self) -> &[usize] {
        self.ik.free_variables()
    }

    /// All joint vectors within the limits that put the tool at `world_from_tool`, the free variables as in `free`,
    /// nearest to `near` first (ties in solver order).
    ///
    /// Each angle is the one of its aliases 2 pi apart that is within the limits and nearest to `near`. The second
    /// value counts solutions outside of the limits.
    pub fn inverse(
        &self,
        world_from_tool: &Pose,
        free: &[f64],
        near: &[f64],
        scratch: &mut IkSolutions,
    ) -> (Vec<Vec<f64>>, usize) {
        let world_from_tip = world_from_tool * self.tip_from_tool.inverse();
        self.ik.solve(&self.world_from_base.inv_mul(&world_from_tip), free, scratch);
        let mut outside = 0;
        let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
        for solution in scratch.iter() {
            let values = self.space.axes().iter().zip(&self.turns).zip(solution.iter().zip(near));
            let within: Option<Vec<f64>> =
                values.map(|((axis, &turns), (&value, &near))| alias(axis, turns, value, near)).collect();
            match within {
                Some(q) => found.push((self.space.squared_distance(&q, near), q)),
                None => outside += 1,
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        (found.into_iter().map(|(_, q)| q).collect(), outside)
    }
}

/// The value within the limits of an axis, of angles the alias nearest to `near`.
fn alias(axis: &Axis, turns: bool, value: f64, near: f64) -> Option<f64> {
    if turns && axis.wraps {
        return Some(value);
    }
    let motion = if turns { ChainMotion::Revolute } else { ChainMotion::Prismatic };
    VariableRange { motion, lower: axis.lower, upper: axis.upper }.nearest(value, near)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testbed::{self, REST};
    use proptest::prelude::*;

    #[test]
    fn the_reach_is_that_of_the_stretched_arm() {
        let stretched = testbed::arm(false).world_from_tool(&[0.0; 6]).translation.vector;
        let along_the_links = stretched.x.abs() + stretched.y.abs() + stretched.z.abs();
        for rail in [false, true] {
            assert!((testbed::arm(rail).reach() - along_the_links).abs() < 1e-12);
        }
    }

    #[test]
    fn the_jacobian_is_the_derivative_of_the_tool_pose() {
        let arm = testbed::arm(true);
        let q = [0.1, 0.3, -0.6, 1.1, 0.4, 0.7, -0.2];
        let jacobian = arm.tool_jacobian(&q);
        for i in 0..7 {
            let moved = |d: f64| {
                let mut q = q;
                q[i] += d;
                arm.world_from_tool(&q)
            };
            let (a, b) = (moved(-1e-6), moved(1e-6));
            let linear = (b.translation.vector - a.translation.vector) / 2e-6;
            let angular = (b.rotation * a.rotation.inverse()).scaled_axis() / 2e-6;
            for row in 0..3 {
                assert!((jacobian[(row, i)] - linear[row]).abs() < 1e-6);
                assert!((jacobian[(row + 3, i)] - angular[row]).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn no_point_of_the_tool_travels_farther_than_its_bound() {
        let arm = testbed::arm(true);
        let point = Point3::new(0.1, 0.05, -0.2);
        let travel = arm.point_travel(&point);
        let mut rng = robotc_core::Seed::new(6).rng();
        for _ in 0..200 {
            let q = arm.space().sample(&mut rng);
            let moved = arm.space().sample_near(&q, 0.01, &mut rng);
            let way = nalgebra::distance(
                &(arm.world_from_tool(&q) * point),
                &(arm.world_from_tool(&moved) * point),
            );
            let difference = arm.space().difference(&q, &moved);
            let bound: f64 = travel.iter().zip(&difference).map(|(t, d)| t * d.abs()).sum();
            assert!(way <= bound + 1e-12, "{way} {bound}");
        }
    }

    #[test]
    fn small_motions_follow_the_twist() {
        let arm = testbed::arm(false);
        let twist = Vector6::new(1e-4, -2e-4, 1e-4, 2e-4, 1e-4, -1e-4);
        let step = arm.follow(&REST, &twist);
        let moved: Vec<f64> = REST.iter().zip(&step).map(|(q, d)| q + d).collect();
        let (a, b) = (arm.world_from_tool(&REST), arm.world_from_tool(&moved));
        let linear = b.translation.vector - a.translation.vector;
        assert!((linear - twist.fixed_rows::<3>(0)).norm() < 1e-6);
        let angular = (b.rotation * a.rotation.inverse()).scaled_axis();
        assert!((angular - twist.fixed_rows::<3>(3)).norm() < 1e-6);
    }

    proptest! {
        #![proptest_config(crate::properties::cases(64))]
        #[test]
        fn inverse_solutions_reach_the_pose_and_recover_the_joints(
            q in prop::array::uniform6(-1.9..1.9f64),
            rail in -0.4..0.4f64,
        ) {
            let arm = testbed::arm(true);
            let q = [rail, q[0], q[1], q[2], q[3], q[4], q[5]];
            let pose = arm.world_from_tool(&q);
            let (solutions, _) = arm.inverse(&pose, &[rail], &q, &mut IkSolutions::new());
            prop_assert!(!solutions.is_empty());
            for s in &solutions {
                prop_assert!((arm.world_from_tool(s).to_homogeneous() - pose.to_homogeneous()).norm() < 1e-8);
                prop_assert!(arm.space().contains(s));
            }
            prop_assert!(solutions[0].iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-5), "{:?} {q:?}", solutions[0]);
        }
    }
}
