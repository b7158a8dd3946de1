//! The order in which grasps are tried.

use robotc_core::robot::Gripper;
use robotc_core::{BodyIdx, Pose};

use super::problem::Manipulation;
use crate::arm::ArmModel;
use crate::grasp::GraspSet;
use crate::reachability::Reachability;
use crate::scene::Scene;

/// What is left of the weight of a grasp with nothing in its favour: what is known beforehand is coarse, so it is tried last and
/// not left out.
const HOPELESS: f64 = 0.05;

/// Grasps of these objects where they are now, as positions of object and grasp, in the order in which they are worth trying: by falling
/// product of score, reachability, and the room around the palm (thesis section 3.1 and figure 3.2). Equal ones keep their
/// order.
///
/// The thesis measures the room at the surface of the object. The palm comes from there along the approach, and
/// tells apart grasps that take one point from the side of a wall and from the other.
pub(super) fn ranking(
    problem: &Manipulation<'_>,
    gripper: &Gripper,
    scene: &Scene,
    objects: &[(BodyIdx, &GraspSet)],
) -> Vec<(usize, usize)> {
    let tool_from_palm = gripper.palm_from_tool.inverse();
    let hand = tool_from_palm.translation.vector.norm();
    let mut weighted = Vec::new();
    for (number, (object, set)) in objects.iter().enumerate() {
        let world_from_object = scene.world_from_body(*object);
        for (index, grasp) in set.grasps.iter().enumerate() {
            let world_from_tool = world_from_object * grasp.object_from_tool;
            let reach = problem.reachability.map_or(1.0, |map| density(map, problem.arm, &world_from_tool));
            let palm = (world_from_tool * tool_from_palm).translation.vector.into();
            let room = if hand > 0.0 { scene.room_about(&palm, *object, hand) / hand } else { 1.0 };
            weighted.push((grasp.score * softened(reach) * softened(room), (number, index)));
        }
    }
    weighted.sort_by(|a, b| b.0.total_cmp(&a.0));
    weighted.into_iter().map(|(_, grasp)| grasp).collect()
}

/// How well the arm reaches a pose of its tool.
fn density(map: &dyn Reachability, arm: &ArmModel, world_from_tool: &Pose) -> f64 {
    map.density(&(arm.base_from_world() * world_from_tool * arm.tool_from_tip()))
}

/// A number from 0 to 1 as a factor that does not rule out.
fn softened(share: f64) -> f64 {
    HOPELESS + (1.0 - HOPELESS) * share
}
