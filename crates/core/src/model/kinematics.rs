//! Forward kinematics and Jacobians.

use std::sync::Arc;

use nalgebra::{Matrix6xX, Point3, Translation3, UnitQuaternion, Vector3};

use super::{Calibration, Configuration, Drive, JointMotion, RobotModel};
use crate::Pose;
use crate::ids::{DofIdx, Idx, JointIdx, LinkIdx, TypedVec};

/// Poses of all links in the root frame: scratch space of forward kinematics, refilled by each call.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LinkPoses {
    root_from_link: TypedVec<LinkIdx, Pose>,
}

impl LinkPoses {
    /// `root_from_link` of a link.
    pub fn root_from(&self, link: LinkIdx) -> &Pose {
        &self.root_from_link[link]
    }

    /// `root_from_link` of all links, in index order.
    pub fn as_slice(&self) -> &[Pose] {
        self.root_from_link.as_slice()
    }
}

/// A robot model with its calibration: everything poses depend on besides joint values. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Kinematics {
    model: Arc<RobotModel>,
    calibration: Arc<Calibration>,
}

impl Kinematics {
    /// The model as described.
    pub fn new(model: Arc<RobotModel>) -> Self {
        Self { model, calibration: Arc::new(Calibration::none()) }
    }

    /// The same model with this calibration.
    pub fn with_calibration(&self, calibration: Calibration) -> Self {
        Self { model: self.model.clone(), calibration: Arc::new(calibration) }
    }

    /// The model.
    pub fn model(&self) -> &Arc<RobotModel> {
        &self.model
    }

    /// The calibration.
    pub fn calibration(&self) -> &Calibration {
        &self.calibration
    }

    /// Value of a joint at `q`: its own, the followed one's, or zero when fixed.
    pub fn joint_value(&self, joint: JointIdx, q: &Configuration) -> f64 {
        match self.model.joints()[joint].drive {
            Drive::Fixed => 0.0,
            Drive::Dof(dof) => q[dof],
            Drive::Mimic { dof, multiplier, offset } => multiplier * q[dof] + offset,
        }
    }

    /// `parent_from_child` of one joint at this value (radians or metres), corrections applied.
    pub fn parent_from_child(&self, joint: JointIdx, value: f64) -> Pose {
        let described = &self.model.joints()[joint];
        match self.calibration.joint(joint) {
            None => described.parent_from_child(value),
            Some(c) => {
                let axis = described.unit_axis();
                let value = value + c.value_offset;
                let joint_from_child = match described.motion {
                    JointMotion::Fixed => Pose::identity(),
                    JointMotion::Revolute => Pose::from_parts(
                        Translation3::identity(),
                        UnitQuaternion::from_axis_angle(axis, value),
                    ),
                    JointMotion::Prismatic => {
                        Translation3::from(axis.into_inner() * value) * UnitQuaternion::identity()
                    }
                };
                described.parent_from_joint() * c.joint_from_corrected * joint_from_child
            }
        }
    }

    /// `parent_from_joint` with its correction, at value zero.
    fn parent_from_joint(&self, joint: JointIdx) -> Pose {
        let described = self.model.joints()[joint].parent_from_joint();
        match self.calibration.joint(joint) {
            None => *described,
            Some(c) => described * c.joint_from_corrected,
        }
    }

    /// Poses of all links in the root frame at `q`.
    pub fn link_poses(&self, q: &Configuration, out: &mut LinkPoses) {
        let model = &*self.model;
        if out.root_from_link.len() != model.links().len() {
            out.root_from_link = model.links().iter().map(|_| Pose::identity()).collect();
        }
        out.root_from_link[model.root()] = Pose::identity();
        for &j in model.topological_order() {
            let joint = &model.joints()[j];
            let parent_from_child = self.parent_from_child(j, self.joint_value(j, q));
            out.root_from_link[joint.child] = out.root_from_link[joint.parent] * parent_from_child;
        }
    }

    /// Pose of one link in the root frame at `q`.
    pub fn root_from_link(&self, q: &Configuration, link: LinkIdx) -> Pose {
        let mut pose = Pose::identity();
        let mut at = link;
        while let Some(j) = self.model.links()[at].parent_joint {
            pose = self.parent_from_child(j, self.joint_value(j, q)) * pose;
            at = self.model.joints()[j].parent;
        }
        pose
    }

    /// Geometric Jacobian of a point fixed to `link`, in the root frame at `q`.
    ///
    /// `point_in_link` is in metres. Six rows: linear velocity of the point, then angular velocity of the link, both in
    /// root axes. One column for each degree of freedom of the model; mimic joints add to the one they follow.
    /// `poses` must be those of `q`.
    pub fn jacobian(&self, poses: &LinkPoses, link: LinkIdx, point_in_link: &Point3<f64>) -> Matrix6xX<f64> {
        let model = &*self.model;
        let point_in_root = poses.root_from(link) * point_in_link;
        let mut jacobian = Matrix6xX::zeros(model.dofs().len());
        let mut at = link;
        while let Some(j) = model.links()[at].parent_joint {
            let joint = &model.joints()[j];
            at = joint.parent;
            let (dof, factor): (DofIdx, f64) = match joint.drive {
                Drive::Fixed => continue,
                Drive::Dof(dof) => (dof, 1.0),
                Drive::Mimic { dof, multiplier, .. } => (dof, multiplier),
            };
            let root_from_joint = poses.root_from(joint.parent) * self.parent_from_joint(j);
            let axis_in_root: Vector3<f64> = root_from_joint.rotation * joint.unit_axis().into_inner();
            let (linear, angular) = match joint.motion {
                JointMotion::Prismatic => (axis_in_root, Vector3::zeros()),
                _ => (
                    axis_in_root.cross(&(point_in_root.coords - root_from_joint.translation.vector)),
                    axis_in_root,
                ),
            };
            let mut column = jacobian.column_mut(dof.index());
            for row in 0..3 {
                column[row] += factor * linear[row];
                column[row + 3] += factor * angular[row];
            }
        }
        jacobian
    }
}
