//! Reachability maps: what the tip reaches about the first axis, cut open, in the colours of how well.

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::Point3;
use robotc_core::Pose;
use robotc_core::model::TriMesh;
use robotc_kb::kinds::Reachability;
use robotc_kb::kinds::reachability::{ReachabilityMap, SECTORS};
use robotc_kb::project::OfArm;
use robotc_kb::{Knowledge, LoadError};

use super::plot::Panel;
use super::{Wanted, palette, resting_links};
use crate::record::{Group, Material, Node, Part, Recording, Surface};

/// Sectors that are left out, so that one looks inside: a third of the turn, where the camera is at first.
const OPEN: std::ops::Range<usize> = 22..32;

/// Steps of the colours.
const SHADES: usize = 12;

pub(super) fn draw(
    knowledge: &Knowledge,
    wanted: &Wanted<'_>,
    recording: &mut Recording,
) -> Result<usize, LoadError> {
    let project = knowledge.graph().project();
    let robot = project.robot();
    let arms = wanted.of::<OfArm>(project);
    let links = resting_links(project);
    let world_from_robot = project.task().map_or_else(Pose::identity, |task| task.world_from_robot);
    recording.add_robot(&robot.model, &world_from_robot, &links);
    for arm in &arms {
        let map = knowledge.load::<Reachability>(arm)?;
        let named = &robot.arms[arm.0];
        let world_from_axis = world_from_robot * links.root_from(named.base) * map.grid.base_from_axis;
        let mut node = Node::new(format!("reach of {}", named.name), Group::Reach, world_from_axis);
        for (shade, mesh) in skin(&map).into_iter().enumerate().filter(|(_, mesh)| !mesh.faces.is_empty()) {
            let surface = recording.add_surface(Surface::smoothed(&Arc::new(mesh)));
            let material = Material::matt(palette::ramp((shade as f32 + 0.5) / SHADES as f32));
            node.parts.push(Part { surface, material, node_from_part: Pose::identity() });
        }
        recording.add_node(node);
        let [some, whole, _] = map.counts();
        let share = |count: usize| format!("{:.1} %", 100.0 * count as f64 / map.grid.len() as f64);
        recording
            .add_fact("cells", format!("{} of {:.0} mm", map.grid.len(), 1e3 * map.grid.step))
            .add_fact("rotations", map.grid.rotations().len())
            .add_fact("reached as a whole", share(whole))
            .add_fact("reached in part", share(some - whole));
    }
    Ok(arms.len())
}

/// Two cuts through each map: along the first axis, and across it where most is reached.
pub(super) fn plot(knowledge: &Knowledge, wanted: &Wanted<'_>) -> Result<Vec<Panel>, LoadError> {
    let project = knowledge.graph().project();
    let mut panels = Vec::new();
    for arm in wanted.of::<OfArm>(project) {
        let map = knowledge.load::<Reachability>(&arm)?;
        let name = &project.robot().arms[arm.0].name;
        let densities = map.densities();
        let (radial, step) = (map.grid.radial, map.grid.step);
        let vertical = 2 * radial;
        let (half, sectors) = (radial as f64 * step, SECTORS as usize);
        let column = |height: usize| -> f64 {
            (0..radial).map(|r| (r as f64 + 0.5) * densities[r * vertical + height].iter().sum::<f64>()).sum()
        };
        let widest = (0..vertical).max_by(|a, b| column(*a).total_cmp(&column(*b))).unwrap_or(radial);
        // To the right azimuth zero, to the left the opposite.
        let along = (0..vertical).flat_map(|height| {
            let right = (0..radial).map(move |r| (r, 0));
            let left = (0..radial).rev().map(move |r| (r, sectors / 2));
            left.chain(right).map(move |(r, sector)| (r * vertical + height, sector))
        });
        let across = (0..vertical).flat_map(|row| (0..vertical).map(move |column| (row, column))).map(
            |(row, column)| {
                let centre = |i: usize| (i as f64 + 0.5 - radial as f64) * step;
                let (x, y) = (centre(column), centre(row));
                let place = ((x * x + y * y).sqrt() / step) as usize;
                let turn = libm::atan2(y, x).rem_euclid(TAU) / TAU;
                let sector = ((turn * sectors as f64) as usize).min(sectors - 1);
                if place < radial { densities[place * vertical + widest][sector] } else { 0.0 }
            },
        );
        let panel = |title: String, axes: [&'static str; 2], values: Vec<f64>| Panel {
            title,
            axes,
            corner: [-half, -half],
            step,
            columns: vertical,
            values,
            scale: "density over all rotations",
            marks: Vec::new(),
        };
        let height = map.grid.corner(widest).1 + 0.5 * step;
        panels.push(panel(
            format!("{name}: cut along the first axis"),
            ["distance from the axis, at azimuth 0 (m)", "height along the axis (m)"],
            along.map(|(place, sector)| densities[place][sector]).collect(),
        ));
        panels.push(panel(
            format!("{name}: cut across the first axis at {height:.2} m"),
            ["x of the axis frame (m)", "y of the axis frame (m)"],
            across.collect(),
        ));
    }
    Ok(panels)
}

/// The faces between places that are reached in some rotation and those that are not, or that are cut away, for each shade
/// of density; in the frame of the axis.
fn skin(map: &ReachabilityMap) -> Vec<TriMesh> {
    let densities = map.densities();
    let most = densities.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max);
    let vertical = 2 * map.grid.radial;
    let sectors = SECTORS as usize;
    let at = |radial: usize, height: usize, sector: usize| -> f64 {
        let shown = radial < map.grid.radial && height < vertical && !OPEN.contains(&(sector % sectors));
        if shown { densities[radial * vertical + height][sector % sectors] } else { 0.0 }
    };
    let mut meshes = vec![TriMesh { vertices: Vec::new(), faces: Vec::new() }; SHADES];
    for radial in 0..map.grid.radial {
        for height in 0..vertical {
            for sector in 0..sectors {
                let density = at(radial, height, sector);
                if density <= 0.0 {
                    continue;
                }
                let mesh = &mut meshes[((density / most * SHADES as f64) as usize).min(SHADES - 1)];
                let (r, z) = map.grid.corner(radial * vertical + height);
                let corner = |outer: usize, upper: usize, later: usize| {
                    let angle = (sector + later) as f64 * TAU / SECTORS as f64;
                    let r = r + outer as f64 * map.grid.step;
                    Point3::new(r * libm::cos(angle), r * libm::sin(angle), z + upper as f64 * map.grid.step)
                };
                let mut face = |corners: [[usize; 3]; 4]| {
                    let first = mesh.vertices.len() as u32;
                    mesh.vertices.extend(corners.map(|[o, u, l]| corner(o, u, l)));
                    mesh.faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
                };
                if at(radial + 1, height, sector) <= 0.0 {
                    face([[1, 0, 0], [1, 0, 1], [1, 1, 1], [1, 1, 0]]);
                }
                if radial > 0 && at(radial - 1, height, sector) <= 0.0 {
                    face([[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1]]);
                }
                if at(radial, height + 1, sector) <= 0.0 {
                    face([[0, 1, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1]]);
                }
                if height == 0 || at(radial, height - 1, sector) <= 0.0 {
                    face([[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]]);
                }
                if at(radial, height, sector + 1) <= 0.0 {
                    face([[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]);
                }
                if at(radial, height, sector + sectors - 1) <= 0.0 {
                    face([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]);
                }
            }
        }
    }
    meshes
}
