//! What a robot sees of itself is no obstacle: points of clouds that are its own.

use std::sync::Arc;

use robotc_core::geom::{ConvexParts, PaddedParts, outside_of_bodies};
use robotc_core::ids::TypedVec;
use robotc_core::model::{Geometry, Shape};
use robotc_core::{Kinematics, LinkIdx, LinkPoses, Pose, Task};

/// The task without the points that are near to the robot where it starts, where its clouds ask for that (thesis, section 5.1).
/// `links` are the convex parts of the links.
pub(crate) fn without_own_points(
    task: &Arc<Task>,
    kinematics: &Kinematics,
    links: &TypedVec<LinkIdx, Arc<ConvexParts>>,
) -> Arc<Task> {
    if task.obstacles.iter().all(|obstacle| obstacle.without_robot.is_none()) {
        return task.clone();
    }
    let mut poses = LinkPoses::default();
    kinematics.link_poses(&task.start, &mut poses);
    let mut task = Task::clone(task);
    for obstacle in &mut task.obstacles {
        let Some(margin) = obstacle.without_robot else { continue };
        let padded: Vec<(PaddedParts, Pose)> = links
            .enumerate()
            .map(|(link, parts)| {
                (PaddedParts::new(parts, margin), task.world_from_robot * poses.root_from(link))
            })
            .collect();
        let element = |element: &Geometry| {
            let Shape::Cloud { cloud, uri } = &element.shape else { return Some(element.clone()) };
            let cloud_from_world = (obstacle.world_from_obstacle * element.origin.pose()).inverse();
            let bodies =
                padded.iter().map(|(parts, world_from_link)| (parts, cloud_from_world * world_from_link));
            let mut outside = outside_of_bodies(cloud.points(), bodies).into_iter();
            let cloud = cloud.filtered(|_| outside.next().unwrap_or(true))?;
            let shape = Shape::Cloud { cloud: Arc::new(cloud), uri: uri.clone() };
            Some(Geometry { shape, ..element.clone() })
        };
        obstacle.geometry = Arc::new(obstacle.geometry.iter().filter_map(element).collect());
    }
    Arc::new(task)
}
