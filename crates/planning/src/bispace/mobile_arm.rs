//! The workspace of an arm on a base that drives on a plane.

use std::f64::consts::PI;

use nalgebra::{Matrix6xX, Translation3, UnitQuaternion, Vector3, Vector6};
use robotc_core::Pose;
use robotc_core::geom::Aabb;
use robotc_core::ik::IkSolutions;
use robotc_core::rng::Rng;

use super::workspace::Workspace;
use crate::arm::ArmModel;
use crate::space::Space;

/// Whether the tool alone may go from one pose to another.
pub type ToolCheck<'a> = dyn FnMut(&Pose, &Pose) -> bool + 'a;

/// An arm on a base. Configurations are x, y and heading of the base in the world, and then the joints of the arm.
pub struct MobileArm<'a> {
    /// The arm as it stands when the base is at the origin and looks along x.
    arm: &'a ArmModel,
    /// Where poses of the tool are sampled.
    bounds: Aabb,
    /// Metres that a radian of turning counts as.
    radian: f64,
    reach: f64,
    tool_check: &'a mut ToolCheck<'a>,
    scratch: IkSolutions,
}

/// The coordinates of the base.
const BASE: [usize; 3] = [0, 1, 2];

impl<'a> MobileArm<'a> {
    /// The arm, with the tool somewhere in `bounds` (world frame) and `tool_check` for the gripper alone. A radian of
    /// turning counts as `radian` metres.
    pub fn new(arm: &'a ArmModel, bounds: Aabb, radian: f64, tool_check: &'a mut ToolCheck<'a>) -> Self {
        // No point of a chain is farther away than its first turning joint moves it.
        let at_origin = arm.base_from_world().inverse().translation.vector;
        let tool_travel = arm.point_travel(&nalgebra::Point3::origin());
        let reach = tool_travel.iter().fold(0.0_f64, |a, &b| a.max(b)) + at_origin.xy().norm();
        Self { arm, bounds, radian, reach, tool_check, scratch: IkSolutions::new() }
    }

    fn world_from_base(q: &[f64]) -> Pose {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), q[2]);
        Pose::from_parts(Translation3::new(q[0], q[1], 0.0), turn)
    }

    /// Derivative of the tool's pose: linear, then angular velocity, in world axes; one column for each coordinate.
    fn jacobian(&self, q: &[f64]) -> Matrix6xX<f64> {
        let world_from_base = Self::world_from_base(q);
        let turn = world_from_base.rotation;
        let of_arm = self.arm.tool_jacobian(&q[3..]);
        let tool_from_centre = (world_from_base * self.arm.world_from_tool(&q[3..])).translation.vector
            - Vector3::new(q[0], q[1], 0.0);
        let mut jacobian = Matrix6xX::zeros(q.len());
        jacobian[(0, 0)] = 1.0;
        jacobian[(1, 1)] = 1.0;
        jacobian.fixed_view_mut::<3, 1>(0, 2).copy_from(&Vector3::z().cross(&tool_from_centre));
        jacobian[(5, 2)] = 1.0;
        for column in 0..q.len() - 3 {
            for row in [0, 3] {
                let in_base: Vector3<f64> = of_arm.fixed_view::<3, 1>(row, column).into_owned();
                jacobian.fixed_view_mut::<3, 1>(row, column + 3).copy_from(&(turn * in_base));
            }
        }
        jacobian
    }
}

impl Workspace for MobileArm<'_> {
    type Point = Pose;

    fn point(&self, q: &[f64]) -> Pose {
        Self::world_from_base(q) * self.arm.world_from_tool(&q[3..])
    }

    fn distance(&self, a: &Pose, b: &Pose) -> f64 {
        (a.translation.vector - b.translation.vector).norm() + self.radian * a.rotation.angle_to(&b.rotation)
    }

    fn sample(&self, rng: &mut Rng) -> Pose {
        let at = [0, 1, 2].map(|i| rng.range(self.bounds.low[i], self.bounds.high[i]));
        Pose::from_parts(Translation3::from(at), rng.rotation())
    }

    fn toward(&self, from: &Pose, to: &Pose, step: f64) -> Pose {
        let t = (step / self.distance(from, to).max(f64::MIN_POSITIVE)).min(1.0);
        let at = from.translation.vector.lerp(&to.translation.vector, t);
        let rotation = from.rotation.try_slerp(&to.rotation, t, 1e-12).unwrap_or(from.rotation);
        Pose::from_parts(at.into(), rotation)
    }

    fn tool_motion(&mut self, from: &Pose, to: &Pose) -> bool {
        (self.tool_check)(from, to)
    }

    fn pull(&self, q: &[f64], to: &Pose) -> Vec<f64> {
        let point = self.point(q);
        let linear = to.translation.vector - point.translation.vector;
        // Turns weigh as in the distance.
        let angular = (to.rotation * point.rotation.inverse()).scaled_axis() * (self.radian * self.radian);
        let error = Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z);
        let jacobian = self.jacobian(q);
        let direction = jacobian.transpose() * error;
        let moved = &jacobian * &direction;
        let scale = error.dot(&moved) / moved.norm_squared().max(1e-12);
        direction.iter().map(|d| scale * d).collect()
    }

    fn solutions(&mut self, q: &[f64], to: &Pose) -> Vec<Vec<f64>> {
        let base_from_goal = Self::world_from_base(q).inv_mul(to);
        let free: Vec<f64> = self.arm.free_variables().iter().map(|&v| q[3 + v]).collect();
        let (found, _) = self.arm.inverse(&base_from_goal, &free, &q[3..], &mut self.scratch);
        found.into_iter().map(|arm| [&q[..3], arm.as_slice()].concat()).collect()
    }

    fn base(&self) -> &[usize] {
        &BASE
    }

    fn base_distance(&self, q: &[f64], to: &Pose) -> f64 {
        (to.translation.x - q[0]).hypot(to.translation.y - q[1])
    }

    fn sample_near(&self, space: &Space, to: &Pose, rng: &mut Rng) -> Vec<f64> {
        let mut q = space.sample(rng);
        let (distance, angle) = (self.reach * rng.unit().sqrt(), rng.range(-PI, PI));
        q[0] = to.translation.x + distance * libm::cos(angle);
        q[1] = to.translation.y + distance * libm::sin(angle);
        space.clamp(&mut q);
        q
    }

    fn reach(&self) -> f64 {
        self.reach
    }
}
