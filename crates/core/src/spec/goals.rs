//! The goals of a task specification.

use super::document::{Node, Table};
use super::extent::extent;
use super::lookup;
use crate::Pose;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::task::{Article, Destination, Goal, Object, Obstacle, Target};

/// A `[[goal]]` table as a goal, or `None` with findings.
pub(super) fn read(
    table: &Table,
    objects: &[Object],
    obstacles: &[Obstacle],
    articles: &[Article],
    diagnostics: &mut Diagnostics,
) -> Option<Goal> {
    if let Some(name) = table.text("open") {
        let known = articles.iter().map(|a| a.name.as_str());
        let article = lookup::named(name, known, "R0510", "an article of this task", diagnostics)?;
        let Article { model, dof, .. } = &articles[article];
        let to = match table.get("to").and_then(|node| Some((node.number()?, node.span))) {
            Some((to, place)) => lookup::within_limits(model, *dof, to, place, diagnostics)?,
            None => model.dofs()[*dof].upper,
        };
        return Some(Goal::Open { article, to });
    }
    let first = table.get("place")?;
    let mut named: Vec<usize> = Vec::new();
    for node in std::iter::once(first).chain(table.list("or")) {
        let object = object_named((node.text()?, node.span), objects, obstacles, diagnostics)?;
        if named.contains(&object) {
            diagnostics.push(
                Diagnostic::error("R0504", format!("\"{}\" is named twice", objects[object].name))
                    .at(node.span, "named before")
                    .expected("each object of a goal once")
                    .hint("leave one of them out"),
            );
            return None;
        }
        named.push(object);
    }
    let destination = |object: usize| match (table.table("at"), table.table("region")) {
        (Some(_), _) => Some(Destination::Pose {
            world_from_object: lookup::origin(table, "at").pose(),
            any_yaw: table.get("any_yaw").and_then(Node::boolean).unwrap_or(false),
        }),
        (None, Some(region)) => Some(Destination::Region {
            world_from_region: lookup::origin(region, "pose").pose(),
            size: region.get("size").and_then(Node::array::<2>)?,
            origin_height: -extent(&objects[object].geometry, &Pose::identity())?.low.z,
        }),
        (None, None) => None,
    };
    let target = |object: usize| Some(Target { object, destination: destination(object)? });
    let targets = named.into_iter().map(target).collect::<Option<Vec<Target>>>()?;
    Some(Goal::Place { targets, keep_upright: table.number("keep_upright") })
}

/// The object of this name, or `None` with a finding.
fn object_named(
    name: (&str, Span),
    objects: &[Object],
    obstacles: &[Obstacle],
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    if obstacles.iter().any(|o| o.name == name.0) {
        diagnostics.push(
            Diagnostic::error("R0504", format!("\"{}\" is an obstacle, which stays where it is", name.0))
                .at(name.1, "an obstacle")
                .expected("an object")
                .hint("write it as `[[object]]` if it can be moved"),
        );
        return None;
    }
    let known = objects.iter().map(|o| o.name.as_str());
    lookup::named(name, known, "R0504", "an object of this task", diagnostics)
}
