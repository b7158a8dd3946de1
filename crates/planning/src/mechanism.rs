//! Doors and drawers: a body with one degree of freedom.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::model::{Joint, JointMotion, Kinematics};
use robotc_core::task::Article;
use serde::{Deserialize, Serialize};

/// How a mechanism moves along its axis, the z axis of its frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MechanismMotion {
    /// Turns about z: a door, a lid, a lever. Values are radians.
    Hinge,
    /// Slides along z: a drawer. Values are metres.
    Slide,
}

/// A moving part on a hinge or a slide.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    /// The axis at rest: z is what the part turns about or slides along.
    pub world_from_axis: Pose,
    /// What the part does there.
    pub motion: MechanismMotion,
    /// Smallest and largest value.
    pub range: (f64, f64),
}

impl Mechanism {
    /// What the joint of an article does, with its other joints where they are at the start; `None` for a joint that neither turns
    /// nor slides.
    pub fn of_article(article: &Article) -> Option<Self> {
        let dof = &article.model.dofs()[article.dof];
        let joint = &article.model.joints()[dof.joint];
        let motion = match joint.motion {
            JointMotion::Revolute => MechanismMotion::Hinge,
            JointMotion::Prismatic => MechanismMotion::Slide,
            JointMotion::Fixed => return None,
        };
        let kinematics = Kinematics::new(article.model.clone());
        let root_from_parent = kinematics.root_from_link(&article.configuration, joint.parent);
        let world_from_rest = article.world_from_root * root_from_parent * joint.parent_from_joint();
        let world_from_axis = world_from_rest * Self::link_from_axis(joint);
        Some(Self { world_from_axis, motion, range: (dof.lower, dof.upper) })
    }

    /// The axis frame, moved with the part, in the frame of the link that a joint moves: a turn that takes z to the joint's axis.
    pub fn link_from_axis(joint: &Joint) -> Pose {
        let turn = UnitQuaternion::rotation_between(&Vector3::z(), joint.unit_axis());
        let turn =
            turn.unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        Pose::from_parts(Translation3::identity(), turn)
    }

    /// `world_from_part` at `value`: the axis frame, moved with the part.
    pub fn world_from_part(&self, value: f64) -> Pose {
        self.world_from_axis * self.axis_from_part(value)
    }

    /// `axis_from_part` at `value`.
    fn axis_from_part(&self, value: f64) -> Pose {
        match self.motion {
            MechanismMotion::Hinge => {
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), value);
                Pose::from_parts(Translation3::identity(), turn)
            }
            MechanismMotion::Slide => Pose::translation(0.0, 0.0, value),
        }
    }

    /// `count` values from `from` to `to`, both included and evenly spaced; at least two.
    pub fn steps(from: f64, to: f64, count: usize) -> Vec<f64> {
        let last = count.max(2) - 1;
        (0..=last).map(|i| from + (to - from) * i as f64 / last as f64).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn doors_turn_and_drawers_slide() {
        let mut mechanism = Mechanism {
            world_from_axis: Pose::translation(1.0, 0.0, 0.0),
            motion: MechanismMotion::Hinge,
            range: (0.0, 1.5),
        };
        let handle = Point3::new(0.5, 0.0, 0.2);
        let quarter = mechanism.world_from_part(std::f64::consts::FRAC_PI_2) * handle;
        assert!((quarter - Point3::new(1.0, 0.5, 0.2)).norm() < 1e-12);
        mechanism.motion = MechanismMotion::Slide;
        assert!((mechanism.world_from_part(0.3) * handle - Point3::new(1.5, 0.0, 0.5)).norm() < 1e-12);
        assert_eq!(Mechanism::steps(0.0, 1.0, 3), [0.0, 0.5, 1.0]);
    }
}
