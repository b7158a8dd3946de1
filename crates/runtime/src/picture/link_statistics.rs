//! Link statistics: each joint in turn moves all that it carries through its limits, beside what is known of it; as a plot the
//! cross-sections of the volumes that joints sweep.

use nalgebra::{Point3, Vector3};
use robotc_core::ids::Idx;
use robotc_core::model::{JointMotion, LinkPoses};
use robotc_core::{Kinematics, Pose};
use robotc_kb::kinds::{LinkStatistics, SweptSection};
use robotc_kb::project::OfRobot;
use robotc_kb::{Knowledge, LoadError};

use super::plot::Panel;
use super::{Wanted, palette, resting};
use crate::record::{Group, LineSet, Node, Recording};

/// Seconds for each joint, and pictures of each motion.
const SECONDS: f64 = 3.0;
const FRAMES: usize = 24;

/// Segments of a circle.
const ROUND: usize = 72;

pub(super) fn draw(
    knowledge: &Knowledge,
    wanted: &Wanted<'_>,
    recording: &mut Recording,
) -> Result<usize, LoadError> {
    let project = knowledge.graph().project();
    let subjects = wanted.of::<OfRobot>(project);
    if subjects.is_empty() {
        return Ok(0);
    }
    let statistics = knowledge.load::<LinkStatistics>(&OfRobot)?;
    let robot = project.robot();
    let world_from_robot = project.task().map_or_else(Pose::identity, |task| task.world_from_robot);
    let dofs = robot.model.dofs();
    let kinematics = Kinematics::new(robot.model.clone());
    let rest = resting(project);
    let mut links = LinkPoses::default();
    kinematics.link_poses(&rest, &mut links);
    let nodes = recording.add_robot(&robot.model, &world_from_robot, &links);
    let heaviest = statistics.iter().map(|row| row.weight).fold(f64::MIN_POSITIVE, f64::max);
    recording.add_fact("joint", "weight (moved volume)");
    for (dof, row) in dofs.indices().zip(statistics.iter()) {
        let (name, start) = (dofs[dof].name.clone(), dof.index() as f64 * SECONDS);
        let (low, high) = dofs[dof].sampling_range();
        let middle = rest.values()[dof.index()];
        for k in 0..=FRAMES {
            // From where it rests to one end, to the other, and back.
            let share = k as f64 / FRAMES as f64;
            let value = match share {
                s if s < 0.25 => middle + (high - middle) * 4.0 * s,
                s if s < 0.75 => high + (low - high) * 2.0 * (s - 0.25),
                s => low + (middle - low) * 4.0 * (s - 0.75),
            };
            let mut q = rest.clone();
            q.set(&[dof], &[value]);
            kinematics.link_poses(&q, &mut links);
            let poses: Vec<_> = nodes.poses(&world_from_robot, &links).collect();
            recording.push_frame(start + share * SECONDS * 0.98, poses);
        }
        kinematics.link_poses(&rest, &mut links);
        recording.add_stage(
            format!("{name}: weight {:.3}, reach {:.2} m", row.weight, row.reach),
            start,
            start + SECONDS,
        );
        recording.add_fact(&name, format!("{:.3} ({:.1} l)", row.weight, 1e3 * row.moved_volume));
        let joint = &robot.model.joints()[dofs[dof].joint];
        if joint.motion != JointMotion::Prismatic {
            let world_from_axis = world_from_robot * links.root_from(joint.child);
            let colour = palette::ramp((row.weight / heaviest) as f32);
            let mut node = Node::new(format!("reach of {name}"), Group::Reach, world_from_axis);
            node = node.with_lines(circle(joint.unit_axis(), row.reach, colour, start as f32));
            recording.add_node(node);
        }
    }
    Ok(1)
}

/// The volume that each joint sweeps, cut by a half plane through its axis, or across it for what slides.
pub(super) fn plot(knowledge: &Knowledge, wanted: &Wanted<'_>) -> Result<Vec<Panel>, LoadError> {
    let project = knowledge.graph().project();
    if wanted.of::<OfRobot>(project).is_empty() {
        return Ok(Vec::new());
    }
    let statistics = knowledge.load::<LinkStatistics>(&OfRobot)?;
    let model = &project.robot().model;
    let mut panels = Vec::new();
    for (dof, row) in model.dofs().indices().zip(statistics.iter()) {
        let name = &model.dofs()[dof].name;
        let axes = match model.joints()[model.dofs()[dof].joint].motion {
            JointMotion::Prismatic => ["x across the axis (m)", "y across the axis (m)"],
            _ => ["distance from the axis (m)", "height along the axis (m)"],
        };
        for section in row.sections.iter().filter(|section| !section.rows.is_empty()) {
            panels.push(panel(
                format!("{name}: {:.3} m2, weight {:.3}", row.cross_section, row.weight),
                axes,
                section,
            ));
        }
    }
    Ok(panels)
}

fn panel(title: String, axes: [&'static str; 2], section: &SweptSection) -> Panel {
    let rows = &section.rows;
    let ends = |row: &robotc_kb::kinds::SectionRow| (row.first, row.first + row.swept.len() as i32);
    let from = rows.iter().map(|row| ends(row).0).min().unwrap_or(0);
    let to = rows.iter().map(|row| ends(row).1).max().unwrap_or(0);
    let (bottom, top) = (rows.first().map_or(0, |row| row.height), rows.last().map_or(-1, |row| row.height));
    let columns = (to - from) as usize;
    let mut values = vec![0.0; columns * (top - bottom + 1) as usize];
    for row in rows {
        let start = (row.height - bottom) as usize * columns + (row.first - from) as usize;
        for (value, swept) in values[start..].iter_mut().zip(&row.swept) {
            *value = f64::from(*swept) / 64.0;
        }
    }
    let corner = [from, bottom].map(|edges| f64::from(edges) * section.cell);
    let scale = "share of the directions in which it is swept";
    Panel { title, axes, corner, step: section.cell, columns, values, scale, marks: Vec::new() }
}

/// A circle about the origin, drawn from a moment on.
fn circle(axis: &Vector3<f64>, radius: f64, colour: [f32; 4], time: f32) -> LineSet {
    let across = axis.cross(&Vector3::x());
    let x = if across.norm() > 0.1 { across.normalize() } else { axis.cross(&Vector3::y()).normalize() };
    let y = axis.cross(&x);
    let at = |k: usize| {
        let angle = k as f64 * std::f64::consts::TAU / ROUND as f64;
        Point3::from((x * libm::cos(angle) + y * libm::sin(angle)) * radius)
    };
    let mut lines = LineSet::polyline((0..=ROUND).map(at), colour, 2.0);
    lines.times = vec![time; lines.points.len()];
    lines
}
