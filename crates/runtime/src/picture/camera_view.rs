//! What cameras see: the robot with the pyramid of each camera's free view, and across it the image with what the hand
//! hides, one preshape after the other.

use nalgebra::{Point2, Point3};
use robotc_core::geom::ConvexPolygon;
use robotc_core::model::LinkPoses;
use robotc_core::robot::Gripper;
use robotc_core::{Kinematics, Pose};
use robotc_kb::kinds::{CameraView, CameraViews};
use robotc_kb::project::{OfCamera, Subject};
use robotc_kb::{Knowledge, LoadError};

use super::{Wanted, resting};
use crate::record::{Group, LineSet, Node, Recording};

/// Seconds for each preshape.
const SECONDS: f64 = 2.0;
/// How far from the lens the image is drawn, metres.
const DEPTH: f64 = 0.3;
const IMAGE: [f32; 4] = [0.55, 0.58, 0.62, 1.0];
const SHADOW: [f32; 4] = [0.93, 0.26, 0.35, 1.0];
const VIEW: [f32; 4] = [0.16, 0.62, 0.42, 1.0];

pub(super) fn draw(
    knowledge: &Knowledge,
    wanted: &Wanted<'_>,
    recording: &mut Recording,
) -> Result<usize, LoadError> {
    let project = knowledge.graph().project();
    let subjects = wanted.of::<OfCamera>(project);
    let robot = project.robot();
    let world_from_robot = project.task().map_or_else(Pose::identity, |task| task.world_from_robot);
    let kinematics = Kinematics::new(robot.model.clone());
    let rest = resting(project);
    let mut links = LinkPoses::default();
    kinematics.link_poses(&rest, &mut links);
    let nodes = recording.add_robot(&robot.model, &world_from_robot, &links);
    let mut time = 0.0;
    for subject in &subjects {
        let views = knowledge.load::<CameraView>(subject)?;
        let camera = &robot.cameras[subject.0];
        let world_from_camera = world_from_robot * links.root_from(camera.link) * camera.link_from_camera;
        let gripper = robot.gripper_of_camera(camera);
        for mask in 0..views.masks.len() {
            let name = match gripper {
                Some(gripper) => format!("{}, {}", camera.name, gripper.preshapes[mask].name),
                None => camera.name.clone(),
            };
            let mut q = rest.clone();
            if let Some(Gripper { dofs, preshapes, .. }) = gripper {
                q.set(dofs, &preshapes[mask].values);
            }
            kinematics.link_poses(&q, &mut links);
            recording.push_frame(time, nodes.poses(&world_from_robot, &links));
            recording.push_frame(time + 0.98 * SECONDS, nodes.poses(&world_from_robot, &links));
            let share = format!("{:.0} % of the image free", 100.0 * views.share(mask));
            recording.add_stage(format!("{name}: {share}"), time, time + SECONDS);
            recording.add_fact(&name, share);
            for (what, mut lines) in lines(&views, mask) {
                lines.times = vec![time as f32; lines.points.len()];
                let node = Node::new(format!("{name}: {what}"), Group::Reach, world_from_camera);
                recording.add_node(node.with_lines(lines));
            }
            time += SECONDS;
        }
        recording.add_fact(subject.label(project), format!("{} x {}", camera.size[0], camera.size[1]));
    }
    Ok(subjects.len())
}

/// The image, what is hidden, and the pyramid of the free view, in the camera's frame.
fn lines(views: &CameraViews, mask: usize) -> [(&'static str, LineSet); 3] {
    let at = |pixel: &Point2<f64>| Point3::from(views.camera.ray(pixel) * DEPTH);
    let closed = |polygon: &ConvexPolygon| -> Vec<Point3<f64>> {
        polygon.corners().iter().chain(polygon.corners().first()).map(at).collect()
    };
    let mut hidden = LineSet::new(SHADOW, 2.0);
    for shadow in &views.masks[mask].shadows {
        hidden.add_polyline(closed(shadow));
    }
    let view = &views.masks[mask].view;
    let mut free = LineSet::polyline(closed(view), VIEW, 2.0);
    for corner in view.corners() {
        free.add_segment(&Point3::origin(), &at(corner));
    }
    let image = LineSet::polyline(closed(&views.camera.image()), IMAGE, 2.0);
    [("image", image), ("hidden", hidden), ("free view", free)]
}
