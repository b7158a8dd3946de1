//! The articles of a task specification: doors, drawers, levers.

use super::document::Table;
use super::file::{self, SpecFile};
use super::lookup;
use crate::diag::{Diagnostic, Diagnostics, Sources};
use crate::model::{Configuration, Kinematics, LinkPoses};
use crate::system::{ReadError, System};
use crate::task::{Article, Obstacle};
use crate::urdf::{self, LoadOptions};

/// An `[[article]]` table as an article, or `None` with findings. Its links with shapes are added to the obstacles, where they
/// are at its value.
pub(super) fn read(
    system: &dyn System,
    sources: &mut Sources,
    file: &SpecFile,
    table: &Table,
    obstacles: &mut Vec<Obstacle>,
    diagnostics: &mut Diagnostics,
) -> Option<Article> {
    let name = table.text("name")?.0.to_owned();
    let (description, place) = table.text("description")?;
    let description = file::resolve(system, &file.folder, description);
    if !system.exists(&description) {
        diagnostics.push(
            Diagnostic::unreadable(&description, &ReadError::NotFound)
                .at(place, "named here")
                .expected("a URDF or xacro file, relative to the folder of this specification"),
        );
        return None;
    }
    let (model, found) = urdf::load(system, sources, &description, &LoadOptions::default());
    diagnostics.extend(found);
    let model = std::sync::Arc::new(model?);
    let joint = table.text("joint").and_then(|joint| lookup::dof(&model, joint, diagnostics));
    let handle = table.text("handle").map(|handle| (lookup::link(&model, handle, diagnostics), handle.1));
    let dof = joint?;
    let moving = model.joints()[model.dofs()[dof].joint].child;
    let handle = match handle {
        None => moving,
        Some((link, place)) => {
            let link = link?;
            if !model.dofs_moving(link).contains(&dof) {
                let (link, joint) = (&model.links()[link].name, &model.dofs()[dof].name);
                diagnostics.push(
                    Diagnostic::error("R0508", format!("joint \"{joint}\" does not move link \"{link}\""))
                        .at(place, "stands still")
                        .expected("a link that moves with the joint"),
                );
                return None;
            }
            link
        }
    };
    let mut configuration = Configuration::neutral(&model);
    if let Some(value) = table.get("value")
        && let Some(number) = value.number()
    {
        configuration[dof] = lookup::within_limits(&model, dof, number, value.span, diagnostics)?;
    }
    let world_from_root = lookup::origin(table, "pose").pose();
    let mut poses = LinkPoses::default();
    Kinematics::new(model.clone()).link_poses(&configuration, &mut poses);
    let mut bodies = Vec::new();
    for link in model.links().indices().filter(|&link| !model.links()[link].collisions.is_empty()) {
        bodies.push((link, obstacles.len()));
        obstacles.push(Obstacle {
            name: format!("{name}/{}", model.links()[link].name),
            geometry: std::sync::Arc::new(model.links()[link].collisions.clone()),
            world_from_obstacle: world_from_root * poses.root_from(link),
            without_robot: None,
        });
    }
    let friction = table.number("friction").unwrap_or(0.5);
    Some(Article { name, dof, handle, friction, world_from_root, configuration, bodies, model })
}
