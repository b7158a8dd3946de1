//! Sphere covers: the balls of each link about its convex parts, where the link is at rest, and of objects where they stand.

use std::sync::Arc;

use nalgebra::{Point3, Vector3};
use robotc_core::Pose;
use robotc_core::model::TriMesh;
use robotc_kb::kinds::{ConvexParts, SphereCover};
use robotc_kb::project::{OfShape, Subject};
use robotc_kb::{Knowledge, LoadError};

use super::{Wanted, palette, resting_links};
use crate::record::{Group, Material, Node, Part, Recording, Surface};

/// Points of a lattice over each link, by which the volume of its cover is measured.
const LATTICE: usize = 24;

/// Rings of a ball from pole to pole, and segments of each.
const RINGS: u32 = 6;
const SEGMENTS: u32 = 10;

pub(super) fn draw(
    knowledge: &Knowledge,
    wanted: &Wanted<'_>,
    recording: &mut Recording,
) -> Result<usize, LoadError> {
    let project = knowledge.graph().project();
    let shapes: Vec<OfShape> = wanted.of(project);
    let world_from_robot = project.task().map_or_else(Pose::identity, |task| task.world_from_robot);
    let links = resting_links(project);
    recording.add_robot(&project.robot().model, &world_from_robot, &links);
    let (mut balls, mut farthest, mut drawn) = (0, 0.0_f64, 0);
    for shape in &shapes {
        let world_from_shape = match (shape, project.task()) {
            (OfShape::Link(link), _) => world_from_robot * links.root_from(*link),
            (OfShape::Object(object), Some(task)) => task.objects[*object].world_from_object,
            _ => continue,
        };
        let cover = knowledge.load::<SphereCover>(shape)?;
        let parts = knowledge.load::<ConvexParts>(shape)?;
        let mut mesh = TriMesh::default();
        for ball in cover.leaves() {
            add_ball(&mut mesh, &ball.centre, ball.outer);
        }
        let surface = recording.add_surface(Surface::smoothed(&Arc::new(mesh)));
        let mut node = Node::new(shape.label(project), Group::Reach, world_from_shape);
        let material = Material::matt(palette::distinct(drawn));
        node.parts.push(Part { surface, material, node_from_part: Pose::identity() });
        recording.add_node(node);
        let (count, out) = (cover.leaves().count(), cover.overshoot());
        recording.add_fact(
            shape.label(project),
            format!("{count} balls, {:.1} mm, {:.2} x", 1e3 * out, cover.swelling(&parts, LATTICE)),
        );
        balls += count;
        farthest = farthest.max(out);
        drawn += 1;
    }
    recording.add_fact("balls", balls).add_fact("stand out at most", format!("{:.1} mm", 1e3 * farthest));
    Ok(drawn)
}

fn add_ball(mesh: &mut TriMesh, centre: &Point3<f64>, radius: f64) {
    let first = mesh.vertices.len() as u32;
    for ring in 0..=RINGS {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(RINGS);
        for segment in 0..SEGMENTS {
            let turn = std::f64::consts::TAU * f64::from(segment) / f64::from(SEGMENTS);
            let (sin, cos) = (libm::sin(polar), libm::cos(polar));
            let direction = Vector3::new(sin * libm::cos(turn), sin * libm::sin(turn), cos);
            mesh.vertices.push(centre + direction * radius);
        }
    }
    for ring in 0..RINGS {
        for segment in 0..SEGMENTS {
            let at = |ring: u32, segment: u32| first + ring * SEGMENTS + segment % SEGMENTS;
            let [a, b] = [at(ring, segment), at(ring, segment + 1)];
            let [c, d] = [at(ring + 1, segment), at(ring + 1, segment + 1)];
            mesh.faces.extend([[a, c, d], [a, d, b]]);
        }
    }
}
