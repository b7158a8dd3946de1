//! Base, cameras, ignored pairs and weights of a robot specification.

use std::sync::Arc;

use super::document::{Node, Table};
use super::lookup;
use crate::Pose;
use crate::diag::{Diagnostic, Diagnostics};
use crate::ids::{DofIdx, LinkIdx};
use crate::model::{Configuration, Kinematics, RobotModel};
use crate::robot::{Base, Camera};

/// The `[base]` table; fixed when there is none.
pub(super) fn base(robot: &Table, model: &Arc<RobotModel>, diagnostics: &mut Diagnostics) -> Base {
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
    let holonomic = table.get("holonomic").and_then(Node::boolean).unwrap_or(false);
    let joints = table.get("joints").and_then(|list| driving(table, list, model, holonomic, diagnostics));
    Base::Planar { footprint, holonomic, joints }
}

/// The joints that a base drives by.
fn driving(
    table: &Table,
    list: &Node,
    model: &Arc<RobotModel>,
    holonomic: bool,
    diagnostics: &mut Diagnostics,
) -> Option<[DofIdx; 3]> {
    let dofs = lookup::dofs(model, table.list("joints"), diagnostics)?;
    let dofs: [DofIdx; 3] = dofs.into_iter().map(|(dof, _)| dof).collect::<Vec<_>>().try_into().ok()?;
    if !holonomic {
        diagnostics.push(
            Diagnostic::error("R0419", "a base that drives by its joints must be able to move sideways")
                .at(list.span, "these joints move it along x and y as it likes")
                .expected("`holonomic = true` beside them"),
        );
        return None;
    }
    if !moves_on_floor(model, &dofs) {
        diagnostics.push(
            Diagnostic::error("R0419", "these joints do not move the base over the floor")
                .at(list.span, "not x, y and heading of what they carry")
                .expected("a joint that slides along x of the root, one along y, and one that turns about z, in this order")
                .hint("their frames must be those of the root: no offsets, no turns"),
        );
        return None;
    }
    Some(dofs)
}

/// Whether what the last joint carries is moved by x, y and heading in the frame of the root.
fn moves_on_floor(model: &Arc<RobotModel>, dofs: &[DofIdx; 3]) -> bool {
    let kinematics = Kinematics::new(model.clone());
    let carried =
        model.links().indices().filter(|&link| dofs.iter().all(|dof| model.dofs_moving(link).contains(dof)));
    let mut rest = Configuration::neutral(model);
    rest.set(dofs, &[0.0; 3]);
    let mut moved = rest.clone();
    let place = [0.3, -0.2, 0.5];
    moved.set(dofs, &place);
    let drive = Pose::from_parts(
        nalgebra::Translation3::new(place[0], place[1], 0.0),
        nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::z_axis(), place[2]),
    );
    let mut links = carried.peekable();
    links.peek().is_some()
        && links.all(|link| {
            let expected = drive * kinematics.root_from_link(&rest, link);
            let off = expected.inv_mul(&kinematics.root_from_link(&moved, link));
            off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-9
        })
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
