//! Base, cameras, ignored pairs and weights of a robot specification.

use super::document::{Node, Table};
use super::lookup;
use crate::diag::{Diagnostic, Diagnostics};
use crate::ids::{DofIdx, LinkIdx};
use crate::model::RobotModel;
use crate::robot::{Base, Camera};

/// The `[base]` table; fixed when there is none.
pub(super) fn base(robot: &Table, diagnostics: &mut Diagnostics) -> Base {
    let Some(table) = robot.table("base") else { return Base::Fixed };
    let Some(outline) = table.get("footprint") else { return Base::Fixed };
    let corners: Option<Vec<[f64; 2]>> = table.list("footprint").iter().map(Node::array::<2>).collect();
    let mut footprint = corners.unwrap_or_default();
    let area = signed_area(&footprint);
    if footprint.len() >= 3 && area.abs() < 1e-6 {
        diagnostics.push(
            Diagnostic::error("R0414", "the footprint has no area")
                .at(outline.span, "these corners lie on a line")
                .expected("corners in their order round the outline, in metres"),
        );
    }
    if area < 0.0 {
        footprint.reverse();
    }
    Base::Planar { footprint, holonomic: table.get("holonomic").and_then(Node::boolean).unwrap_or(false) }
}

/// Area of a polygon, positive when its corners go counter-clockwise.
fn signed_area(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|([ax, ay], [bx, by])| ax * by - bx * ay).sum::<f64>() / 2.0
}

/// The `[[camera]]` tables.
pub(super) fn cameras(robot: &Table, model: &RobotModel, diagnostics: &mut Diagnostics) -> Vec<Camera> {
    let mut cameras = Vec::new();
    for (table, _) in robot.tables("camera") {
        let link = table.text("link").and_then(|name| lookup::link(model, name, diagnostics));
        let size = table.list("size").iter().map(|n| n.integer().and_then(|i| u32::try_from(i).ok()));
        let size: Option<[u32; 2]> = size.collect::<Option<Vec<u32>>>().and_then(|v| v.try_into().ok());
        let intrinsics = table.get("intrinsics").and_then(Node::array::<4>);
        let name = table.text("name").map(|(name, _)| name.to_owned());
        if let (Some(name), Some(link), Some(size), Some(intrinsics)) = (name, link, size, intrinsics) {
            let link_from_camera = lookup::origin(table, "pose").pose();
            cameras.push(Camera { name, link, link_from_camera, size, intrinsics });
        }
    }
    cameras
}

/// The pairs of `self_collision.ignore`, lower index first.
pub(super) fn ignored_pairs(
    robot: &Table,
    model: &RobotModel,
    diagnostics: &mut Diagnostics,
) -> Vec<(LinkIdx, LinkIdx)> {
    let Some(table) = robot.table("self_collision") else { return Vec::new() };
    let mut pairs = Vec::new();
    for node in table.list("ignore") {
        let links = lookup::links(model, node.list().unwrap_or_default(), diagnostics);
        let [(a, _), (b, place)] = links[..] else { continue };
        if a == b {
            diagnostics.push(
                Diagnostic::error("R0411", format!("\"{}\" is paired with itself", model.links()[a].name))
                    .at(place, "the same link")
                    .expected("two different links"),
            );
        } else {
            pairs.push(lookup::ordered(a, b));
        }
    }
    pairs
}

/// The `[weights]` table, in the order of the degrees of freedom.
pub(super) fn weights(
    robot: &Table,
    model: &RobotModel,
    diagnostics: &mut Diagnostics,
) -> Vec<(DofIdx, f64)> {
    let mut weights = Vec::new();
    for entry in robot.entries("weights") {
        let dof = lookup::dof(model, (&entry.key, entry.key_span), diagnostics);
        weights.extend(dof.zip(entry.node.number()));
    }
    weights.sort_by_key(|(dof, _)| *dof);
    weights
}
