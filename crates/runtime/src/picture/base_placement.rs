//! Where a base can stand: for each object that a gripper grasps, the floor in the colours of how much of the arm's freedom
//! the grasps have from there, with some bases drawn from that distribution.

use std::sync::Arc;

use nalgebra::Point3;
use robotc_core::model::{LinkPoses, TriMesh};
use robotc_core::{Pose, Seed};
use robotc_kb::kinds::reachability::{Placement, Placements, ReachabilityMap, Target, Trust};
use robotc_kb::kinds::{GraspSet, Reachability};
use robotc_kb::project::{OfArm, OfGripperAndObject};
use robotc_kb::{Knowledge, LoadError};

use super::plot::Panel;
use super::{Wanted, palette, resting_links};
use crate::record::{Group, LineSet, Material, Node, Part, Recording, Surface};

/// Squares of the floor along each side, and the half side in reaches of the map.
const SQUARES: usize = 72;
const HALF: f64 = 1.5;

/// Steps of the colours.
const SHADES: usize = 12;

/// Grasps that count, and bases that are drawn.
const GRASPS: usize = 400;
const BASES: usize = 24;

const BASE_COLOUR: [f32; 4] = [0.93, 0.26, 0.35, 1.0];

pub(super) fn draw(
    knowledge: &Knowledge,
    wanted: &Wanted<'_>,
    recording: &mut Recording,
) -> Result<usize, LoadError> {
    let project = knowledge.graph().project();
    let Some(task) = project.task() else { return Ok(0) };
    let links = resting_links(project);
    let map = knowledge.load::<Reachability>(&OfArm(task.arm))?;
    let subjects: Vec<_> = wanted.of::<OfGripperAndObject>(project);
    recording.add_robot(&project.robot().model, &task.world_from_robot, &links);
    recording.add_bodies(task);
    for subject in &subjects {
        let Bases { placements, floor, targets, object } = Bases::of(knowledge, *subject, &map, &links)?;
        let name = format!("bases for {object}");
        let mut node = Node::new(&name, Group::Reach, task.world_from_robot);
        for (shade, mesh) in floor.tiles(&placements).into_iter().enumerate() {
            if !mesh.faces.is_empty() {
                let surface = recording.add_surface(Surface::smoothed(&Arc::new(mesh)));
                let material = Material::matt(palette::ramp((shade as f32 + 0.5) / SHADES as f32));
                node.parts.push(Part { surface, material, node_from_part: Pose::identity() });
            }
        }
        let mut rng = Seed::new(0).split("pictures of bases").rng();
        let drawn: Vec<Placement> = (0..BASES).filter_map(|_| placements.sample(&mut rng)).collect();
        recording.add_node(node.with_lines(arrows(&drawn, 3.0 * floor.step)));
        recording.add_fact(name, format!("{targets} grasps, {:.2} m2 of free motion", placements.mass()));
    }
    Ok(subjects.len())
}

/// How much weight each place of the floor has, seen from above, in the frame of the robot's root.
pub(super) fn plot(knowledge: &Knowledge, wanted: &Wanted<'_>) -> Result<Vec<Panel>, LoadError> {
    let project = knowledge.graph().project();
    let Some(task) = project.task() else { return Ok(Vec::new()) };
    let links = resting_links(project);
    let map = knowledge.load::<Reachability>(&OfArm(task.arm))?;
    let panel = |subject: OfGripperAndObject| {
        let Bases { placements, floor, targets, object } = Bases::of(knowledge, subject, &map, &links)?;
        let half = 0.5 * SQUARES as f64 * floor.step;
        let centre = [floor.corner[0] + half, floor.corner[1] + half];
        Ok(Panel {
            title: format!("bases for {targets} grasps of {object}"),
            axes: ["x (m)", "y (m)"],
            corner: floor.corner,
            step: floor.step,
            columns: SQUARES,
            values: placements.distribution(floor.corner, floor.step, SQUARES, SQUARES),
            scale: "share of the weight, for each square",
            marks: vec![(centre, object), ([0.0, 0.0], "robot".into())],
        })
    };
    wanted.of::<OfGripperAndObject>(project).into_iter().map(panel).collect()
}

/// Bases for the best grasps of an object.
struct Bases {
    placements: Placements,
    floor: Floor,
    /// How many grasps.
    targets: usize,
    object: String,
}

impl Bases {
    fn of(
        knowledge: &Knowledge,
        subject: OfGripperAndObject,
        map: &ReachabilityMap,
        links: &LinkPoses,
    ) -> Result<Self, LoadError> {
        let project = knowledge.graph().project();
        let task = project.task().expect("an object belongs to a task");
        let robot = project.robot();
        let arm = &robot.arms[task.arm];
        let gripper = &robot.grippers[subject.gripper];
        let tip_from_palm = links.root_from(arm.tip).inv_mul(links.root_from(gripper.palm));
        let tool_from_tip = (tip_from_palm * gripper.palm_from_tool).inverse();
        let object = &task.objects[subject.object];
        // The plane is that of the robot's root.
        let root_from_object = task.world_from_robot.inv_mul(&object.world_from_object);
        let grasps = knowledge.load::<GraspSet>(&subject)?;
        let target = |grasp: &robotc_planning::grasp::Grasp| Target {
            world_from_tip: root_from_object * grasp.object_from_tool * tool_from_tip,
            weight: grasp.score,
        };
        let targets: Vec<Target> = grasps.iter().take(GRASPS).map(target).collect();
        let placements = Placements::new(map, &targets, &[*links.root_from(arm.base)], Trust::Whole);
        let half = HALF * map.grid.radial as f64 * map.grid.step;
        let centre = root_from_object.translation.vector;
        let floor = Floor { corner: [centre.x - half, centre.y - half], step: 2.0 * half / SQUARES as f64 };
        Ok(Self { placements, floor, targets: targets.len(), object: object.name.clone() })
    }
}

/// Squares of the robot's plane.
struct Floor {
    corner: [f64; 2],
    step: f64,
}

impl Floor {
    /// Squares in which the base can stand, for each shade of how much weight they have.
    fn tiles(&self, placements: &Placements) -> Vec<TriMesh> {
        let shares = placements.distribution(self.corner, self.step, SQUARES, SQUARES);
        let most = shares.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let mut meshes = vec![TriMesh { vertices: Vec::new(), faces: Vec::new() }; SHADES];
        for (square, share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let mesh = &mut meshes[((share / most * SHADES as f64) as usize).min(SHADES - 1)];
            let first = mesh.vertices.len() as u32;
            let x = self.corner[0] + self.step * (square % SQUARES) as f64;
            let y = self.corner[1] + self.step * (square / SQUARES) as f64;
            let side = 0.94 * self.step;
            // Just above the floor, which is drawn too.
            let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
            mesh.vertices.extend(corners.map(|[a, b]| Point3::new(x + a, y + b, 0.05 * self.step)));
            mesh.faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        meshes
    }
}

/// Bases as arrows along their x axes.
fn arrows(bases: &[Placement], length: f64) -> LineSet {
    let mut lines = LineSet::new(BASE_COLOUR, 2.5);
    for base in bases {
        let at =
            |x: f64, y: f64| base.world_from_mobile() * Point3::new(x * length, y * length, 0.1 * length);
        lines.add_segment(&at(0.0, 0.0), &at(1.0, 0.0));
        lines.add_polyline([at(0.7, 0.2), at(1.0, 0.0), at(0.7, -0.2)]);
    }
    lines
}
