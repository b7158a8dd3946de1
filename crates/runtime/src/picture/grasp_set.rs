//! Grasp sets: each object with all grasps as forks, and the hand that takes one after the other, best first. Contacts
//! stay where a hand has been.

use nalgebra::Point3;
use robotc_core::Pose;
use robotc_kb::kinds::ranked_grasps;
use robotc_kb::project::OfGripperAndObject;
use robotc_kb::{Knowledge, LoadError};
use robotc_planning::grasp::Grasp;

use super::Wanted;
use super::hand::Hand;
use crate::record::{Group, LineSet, Node, NodeIdx, Recording};

/// Grasps that the hand shows.
const SHOWN: usize = 30;
/// Seconds for each of them: coming near, closing, holding.
const SECONDS: f64 = 1.5;
/// Length of the approach that is shown, as a share of the object's size.
const APPROACH: f64 = 0.4;
/// Room between the objects of one picture, as a share of the widest.
const ROOM: f64 = 2.5;
/// Length of the mark of a contact, as a share of the object's size.
const MARK: f64 = 0.08;
const MARK_COLOUR: [f32; 4] = [0.93, 0.26, 0.35, 1.0];

pub(super) fn draw(
    knowledge: &Knowledge,
    wanted: &Wanted<'_>,
    recording: &mut Recording,
) -> Result<usize, LoadError> {
    let project = knowledge.graph().project();
    let Some(task) = project.task() else { return Ok(0) };
    let subjects = wanted.of::<OfGripperAndObject>(project);
    let sizes: Vec<f64> = subjects.iter().map(|s| size(&task.objects[s.object])).collect();
    let widest = sizes.iter().copied().fold(0.0, f64::max);
    for (i, (subject, &size)) in subjects.iter().zip(&sizes).enumerate() {
        let grasps = ranked_grasps(knowledge, subject)?;
        let world_from_object = Pose::translation(0.0, ROOM * widest * i as f64, 0.0);
        let object = &task.objects[subject.object];
        let node = recording.add_body(&object.name, Group::Object, &object.geometry, world_from_object);
        let forks = grasps.iter().map(|g| &g.object_from_tool);
        recording.add_grasps(format!("grasps of {}", object.name), node, forks, 0.3 * size, 0.25 * size);
        let hand = Hand::add(recording, project.robot(), subject.gripper, Some(node));
        for (rank, grasp) in grasps.iter().take(SHOWN).enumerate() {
            let start = rank as f64 * SECONDS;
            take(&hand, recording, grasp, start, APPROACH * size);
            mark_contacts(recording, node, grasp, rank, start, MARK * size);
            if subjects.len() == 1 {
                let name = format!("{}: epsilon {:.3}", rank + 1, grasp.epsilon);
                recording.add_stage(name, start, start + SECONDS);
            }
        }
        recording.add_fact(&object.name, count(grasps.len()));
    }
    Ok(subjects.len())
}

fn count(grasps: usize) -> String {
    match grasps {
        1 => "1 grasp".to_owned(),
        n => format!("{n} grasps"),
    }
}

/// Diagonal of an object, metres.
fn size(object: &robotc_core::task::Object) -> f64 {
    let surface = robotc_core::geom::surface(&object.geometry);
    robotc_core::geom::Aabb::of_points(&surface.vertices).map_or(0.1, |bounds| bounds.size().norm())
}

/// Comes near from `approach` metres away, closes, and holds.
fn take(hand: &Hand<'_>, recording: &mut Recording, grasp: &Grasp, start: f64, approach: f64) {
    let open = &hand.gripper.preshapes[grasp.preshape].values;
    let (there, away) = (grasp.object_from_tool, grasp.object_from_backed_off(approach));
    let poses =
        [(0.0, away, open), (0.4, there, open), (0.7, there, &grasp.closed), (0.98, there, &grasp.closed)];
    for (share, object_from_tool, fingers) in poses {
        hand.stand(recording, start + share * SECONDS, &object_from_tool, fingers);
    }
}

/// Lines along which the fingers press, drawn from the moment they do.
fn mark_contacts(
    recording: &mut Recording,
    object: NodeIdx,
    grasp: &Grasp,
    rank: usize,
    start: f64,
    length: f64,
) {
    let mut lines = LineSet::new(MARK_COLOUR, 3.0);
    for contact in &grasp.contacts {
        let from: Point3<f64> = contact.point_in_object - contact.normal_in_object.into_inner() * length;
        lines.add_segment(&from, &contact.point_in_object);
    }
    lines.times = vec![(start + SECONDS * 0.7) as f32; lines.points.len()];
    let name = format!("contacts of grasp {}", rank + 1);
    recording.add_node(Node::new(name, Group::Contact, Pose::identity()).child_of(object).with_lines(lines));
}
