//! Loose grips: each door or drawer where it stands at the start, all tools as forks, and the hand that takes one grip after the
//! other, loose and then closed.

use nalgebra::Point3;
use robotc_core::Pose;
use robotc_kb::kinds::{Cage, CageHold, CagingSet};
use robotc_kb::project::OfGripperAndArticle;
use robotc_kb::{Knowledge, LoadError};
use robotc_planning::Mechanism;

use super::Wanted;
use super::hand::Hand;
use crate::record::{Group, LineSet, Node, Recording};

/// Grips of each article that the hand shows, evenly from all kinds of hold.
const SHOWN: usize = 24;
/// Seconds for each of them.
const SECONDS: f64 = 1.2;
/// Depth and opening of a fork, metres.
const FORK: f64 = 0.04;

/// Colours of forks: both ways, opening, closing.
const HOLDS: [(CageHold, &str, [f32; 4]); 3] = [
    (CageHold::Both, "cage", [0.16, 0.62, 0.42, 0.9]),
    (CageHold::Opening, "only open", [0.20, 0.45, 0.85, 0.9]),
    (CageHold::Closing, "only close", [0.90, 0.55, 0.15, 0.9]),
];

pub(super) fn draw(
    knowledge: &Knowledge,
    wanted: &Wanted<'_>,
    recording: &mut Recording,
) -> Result<usize, LoadError> {
    let project = knowledge.graph().project();
    let Some(task) = project.task() else { return Ok(0) };
    let subjects = wanted.of::<OfGripperAndArticle>(project);
    let mut start = 0.0;
    for subject in &subjects {
        let article = &task.articles[subject.article];
        for &(_, body) in &article.bodies {
            let body = &task.obstacles[body];
            recording.add_body(&body.name, Group::Object, &body.geometry, body.world_from_obstacle);
        }
        let cages = knowledge.load::<CagingSet>(subject)?;
        let Some(mechanism) = Mechanism::of_article(article) else { continue };
        let world_from_part = mechanism.world_from_part(article.value());
        for (hold, title, colour) in HOLDS {
            let held: Vec<Pose> =
                cages.iter().filter(|cage| cage.hold == hold).map(|cage| cage.grasp.part_from_tool).collect();
            let forks = LineSet::forks(&held, FORK, FORK, colour);
            let name = format!("{}: {title}", article.name);
            recording.add_node(Node::new(&name, Group::Reach, world_from_part).with_lines(forks));
            recording.add_fact(name, held.len());
        }
        recording.add_node(axis(&mechanism, article.name.as_str()));
        let hand = Hand::add(recording, project.robot(), subject.gripper, None);
        for cage in spread(&cages) {
            let world_from_tool = world_from_part * cage.grasp.part_from_tool;
            for (share, fingers) in
                [(0.0, &cage.loose), (0.5, &cage.loose), (0.7, &cage.closed), (0.98, &cage.closed)]
            {
                hand.stand(recording, start + share * SECONDS, &world_from_tool, fingers);
            }
            recording.add_stage(stage(&article.name, cage), start, start + SECONDS);
            start += SECONDS;
        }
    }
    Ok(subjects.len())
}

fn stage(article: &str, cage: &Cage) -> String {
    let hold = HOLDS.iter().find(|(hold, ..)| *hold == cage.hold).map_or("", |(_, title, _)| title);
    let contact = if cage.grasp.contact { ", in contact when closed" } else { "" };
    format!("{article}: {hold}{contact}")
}

/// Some of the grips, evenly over the list.
fn spread(cages: &[Cage]) -> impl Iterator<Item = &Cage> {
    cages.iter().step_by(cages.len().div_ceil(SHOWN).max(1))
}

/// The axis that an article turns about or slides along.
fn axis(mechanism: &Mechanism, name: &str) -> Node {
    let line = LineSet::polyline(
        [Point3::new(0.0, 0.0, -0.5), Point3::new(0.0, 0.0, 0.5)],
        [0.93, 0.26, 0.35, 1.0],
        2.0,
    );
    Node::new(format!("axis of {name}"), Group::Contact, mechanism.world_from_axis).with_lines(line)
}
