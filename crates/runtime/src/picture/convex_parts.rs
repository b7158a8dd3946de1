//! Convex parts, each in a colour of its own, where their bodies are at rest.

use std::sync::Arc;

use robotc_core::Pose;
use robotc_core::geom::ConvexPart;
use robotc_kb::kinds::ConvexParts;
use robotc_kb::project::{OfShape, Project, Subject};
use robotc_kb::{Knowledge, LoadError};

use super::{Wanted, palette, resting_links};
use crate::record::{Group, Material, Node, Part, Recording, Surface};

pub(super) fn draw(
    knowledge: &Knowledge,
    wanted: &Wanted<'_>,
    recording: &mut Recording,
) -> Result<usize, LoadError> {
    let project = knowledge.graph().project();
    let shapes = wanted.of::<OfShape>(project);
    let (mut count, mut corners, mut litres) = (0, 0, 0.0);
    for shape in &shapes {
        let parts = knowledge.load::<ConvexParts>(shape)?;
        let mut node = Node::new(shape.label(project), group(shape), place(shape, project));
        for part in parts.iter() {
            let surface = recording.add_surface(Surface::smoothed(&Arc::new(part.mesh())));
            let material = Material::matt(palette::distinct(count));
            node.parts.push(Part { surface, material, node_from_part: Pose::identity() });
            count += 1;
            corners += part.points().len();
        }
        litres += 1e3 * parts.iter().map(ConvexPart::volume).sum::<f64>();
        recording.add_node(node);
    }
    recording
        .add_fact("bodies", shapes.len())
        .add_fact("parts", count)
        .add_fact("corners", corners)
        .add_fact("volume", format!("{litres:.2} l"));
    Ok(shapes.len())
}

fn group(shape: &OfShape) -> Group {
    match shape {
        OfShape::Link(_) => Group::Robot,
        OfShape::Object(_) => Group::Object,
        OfShape::Obstacle(_) => Group::Obstacle,
    }
}

/// `world_from_body`; without a task the robot stands in the origin.
fn place(shape: &OfShape, project: &Project) -> Pose {
    let task = project.task();
    match *shape {
        OfShape::Link(link) => {
            let world_from_robot = task.map_or_else(Pose::identity, |task| task.world_from_robot);
            world_from_robot * resting_links(project).root_from(link)
        }
        OfShape::Object(object) => task.expect("objects belong to a task").objects[object].world_from_object,
        OfShape::Obstacle(obstacle) => {
            task.expect("obstacles belong to a task").obstacles[obstacle].world_from_obstacle
        }
    }
}
