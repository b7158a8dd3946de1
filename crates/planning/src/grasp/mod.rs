//! Grasps of one object by one gripper: what a grasp-set generator makes and a planner draws its goals from.
//!
//! A grasp is given relative to the object, so a set stays valid wherever the object stands (thesis section 3.1).

mod closure;
mod hull;
mod strength;
mod wrench;

use nalgebra::{Point3, Unit, Vector3};
use robotc_core::Pose;

pub use closure::closes;
pub use hull::{Epsilon, epsilon, volume};
pub use strength::{bears, strength};
pub use wrench::{ContactModel, tangents, wrenches};

/// A place where the closed gripper touches the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Where, in the object frame; metres.
    pub point_in_object: Point3<f64>,
    /// Direction in which the finger pushes: the surface normal turned into the object, in the object frame.
    pub normal_in_object: Unit<Vector3<f64>>,
}

/// One way to hold an object.
#[derive(Debug, Clone, PartialEq)]
pub struct Grasp {
    /// Position in `Gripper::preshapes` of the finger position to approach with.
    pub preshape: usize,
    /// Where the tool frame is when the fingers close.
    pub object_from_tool: Pose,
    /// Direction of the last straight motion towards the object, in the object frame.
    pub approach_in_object: Unit<Vector3<f64>>,
    /// How far, metres, the gripper stood back from the first touch of its approach when the fingers closed.
    pub standoff: f64,
    /// Finger values when closed on the object, in the order of `Gripper::dofs`.
    pub closed: Vec<f64>,
    /// Where the closed gripper touches.
    pub contacts: Vec<Contact>,
    /// Radius of the largest ball of wrenches that unit contact forces resist, torques scaled by object size; positive
    /// for a force-closure grasp.
    pub epsilon: f64,
    /// Volume of the hull of the wrenches that unit contact forces exert, torques scaled by object size; `None` when it was not
    /// computed.
    pub volume: Option<f64>,
    /// How it stood disturbances of the object; `None` when that was not tested.
    pub steadiness: Option<Steadiness>,
    /// What grasps are ranked by; larger is better: [`strength`] times the share of disturbed grasps that hold.
    pub score: f64,
}

/// What becomes of a grasp when the object is not quite where it should be (thesis, algorithm 4.1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steadiness {
    /// Standard deviation of the hand over the disturbed grasps, metres: of its position, plus that of its farthest moved link
    /// through the finger values. A grasp that slips deviates more than the object.
    pub deviation: f64,
    /// Share of the disturbed grasps whose open hand stays clear of the object where it was planned to stand, and which then close and
    /// bear half of what the grasp bears.
    pub held: f64,
}

impl Grasp {
    /// The tool frame backed off by `distance` metres against the direction of approach.
    pub fn object_from_backed_off(&self, distance: f64) -> Pose {
        let mut pose = self.object_from_tool;
        pose.translation.vector -= self.approach_in_object.into_inner() * distance;
        pose
    }
}

/// The known grasps of one object by one gripper, best score first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GraspSet {
    /// Name of the gripper.
    pub gripper: String,
    /// Name of the object.
    pub object: String,
    /// The grasps, by falling score.
    pub grasps: Vec<Grasp>,
}

impl GraspSet {
    /// A set of these grasps. Sorts by falling score; equal scores keep their order.
    pub fn new(gripper: impl Into<String>, object: impl Into<String>, mut grasps: Vec<Grasp>) -> Self {
        grasps.sort_by(|a, b| b.score.total_cmp(&a.score));
        Self { gripper: gripper.into(), object: object.into(), grasps }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grasp(score: f64) -> Grasp {
        Grasp {
            preshape: 0,
            object_from_tool: Pose::translation(0.0, 0.0, 0.1),
            approach_in_object: -Vector3::z_axis(),
            standoff: 0.0,
            closed: vec![],
            contacts: vec![],
            epsilon: 0.1,
            volume: None,
            steadiness: None,
            score,
        }
    }

    #[test]
    fn sets_are_sorted_by_falling_score() {
        let set = GraspSet::new("hand", "mug", vec![grasp(0.2), grasp(0.9), grasp(0.5)]);
        let scores: Vec<f64> = set.grasps.iter().map(|g| g.score).collect();
        assert_eq!(scores, [0.9, 0.5, 0.2]);
    }

    #[test]
    fn backing_off_goes_against_the_approach() {
        let pose = grasp(1.0).object_from_backed_off(0.05);
        assert!((pose.translation.z - 0.15).abs() < 1e-15);
    }
}
