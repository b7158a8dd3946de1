//! Names of a specification looked up in the model, with the nearest known name when there is none.

use std::f64::consts::TAU;

use super::describe::count;
use super::document::{Node, Table};
use crate::diag::{Diagnostic, Diagnostics, Span, nearest};
use crate::ids::{DofIdx, Idx, LinkIdx};
use crate::model::{Drive, JointMotion, Origin, RobotModel};

/// The link of this name, or a finding.
pub(super) fn link(
    model: &RobotModel,
    (name, place): (&str, Span),
    diagnostics: &mut Diagnostics,
) -> Option<LinkIdx> {
    let found = model.link_named(name);
    if found.is_none() {
        let names = model.links().iter().map(|l| l.name.as_str());
        let what = if model.joint_named(name).is_some() { "is a joint, not a link" } else { "is not a link" };
        diagnostics.push(no_such("R0401", name, what, place, names, "a link"));
    }
    found
}

/// The degree of freedom that the joint of this name drives, or a finding.
pub(super) fn dof(
    model: &RobotModel,
    (name, place): (&str, Span),
    diagnostics: &mut Diagnostics,
) -> Option<DofIdx> {
    let Some(joint) = model.joint_named(name) else {
        let names = model.dofs().iter().map(|d| d.name.as_str());
        let what = if model.link_named(name).is_some() { "is a link, not a joint" } else { "is not a joint" };
        diagnostics.push(no_such("R0402", name, what, place, names, "a moving joint"));
        return None;
    };
    let (why, hint) = match model.joints()[joint].drive {
        Drive::Dof(dof) => return Some(dof),
        Drive::Fixed => ("fixed", None),
        Drive::Mimic { dof, .. } => ("driven by another joint", Some(&model.dofs()[dof].name)),
    };
    let mut diagnostic = Diagnostic::error("R0403", format!("joint \"{name}\" has no value of its own"))
        .at(place, format!("this joint is {why}"))
        .expected("a joint with a value of its own");
    if let Some(followed) = hint {
        diagnostic = diagnostic.hint(format!("it follows \"{followed}\""));
    }
    diagnostics.push(diagnostic);
    None
}

/// All links named in a list that exist.
pub(super) fn links(
    model: &RobotModel,
    names: &[Node],
    diagnostics: &mut Diagnostics,
) -> Vec<(LinkIdx, Span)> {
    let named = names.iter().filter_map(|node| Some((node.text()?, node.span)));
    named.filter_map(|name| Some((link(model, name, diagnostics)?, name.1))).collect()
}

/// The degrees of freedom named in a list, or `None` if one of them does not exist or is named twice.
pub(super) fn dofs(
    model: &RobotModel,
    names: &[Node],
    diagnostics: &mut Diagnostics,
) -> Option<Vec<(DofIdx, Span)>> {
    let mut found: Vec<(DofIdx, Span)> = Vec::new();
    let mut complete = true;
    for node in names {
        let Some(index) = node.text().and_then(|name| dof(model, (name, node.span), diagnostics)) else {
            complete = false;
            continue;
        };
        if found.iter().any(|(earlier, _)| *earlier == index) {
            let name = &model.dofs()[index].name;
            diagnostics.push(
                Diagnostic::error("R0107", format!("joint \"{name}\" is named twice"))
                    .at(node.span, "named before")
                    .expected("each joint once"),
            );
            complete = false;
        } else {
            found.push((index, node.span));
        }
    }
    complete.then_some(found)
}

/// The numbers of `list`, one for each of `dofs` and within its limits, or a finding.
pub(super) fn values(
    model: &RobotModel,
    list: &Node,
    dofs: &[DofIdx],
    diagnostics: &mut Diagnostics,
) -> Option<Vec<f64>> {
    let numbers = list.numbers()?;
    if !one_each(model, list, numbers.len(), dofs, diagnostics) {
        return None;
    }
    let items = list.list().unwrap_or_default().iter();
    // Collected before they are judged, so that every value outside is reported.
    let values: Vec<Option<f64>> = dofs
        .iter()
        .zip(&numbers)
        .zip(items)
        .map(|((&dof, &value), node)| within_limits(model, dof, value, node.span, diagnostics))
        .collect();
    values.into_iter().collect()
}

/// Whether a list has one value for each of `dofs`; a finding if not.
pub(super) fn one_each(
    model: &RobotModel,
    list: &Node,
    found: usize,
    dofs: &[DofIdx],
    diagnostics: &mut Diagnostics,
) -> bool {
    if found == dofs.len() {
        return true;
    }
    let names: Vec<&str> = dofs.iter().map(|&d| model.dofs()[d].name.as_str()).collect();
    diagnostics.push(
        Diagnostic::error("R0408", format!("{} for {}", count(found, "value"), count(dofs.len(), "joint")))
            .at(list.span, count(found, "value"))
            .expected(format!("one value for each of {}", names.join(", "))),
    );
    false
}

/// How far a value may exceed a limit and count as the limit, rounded: radians or metres.
const ROUNDING: f64 = 1e-4;

/// The value, if the limits of its joint allow it, else a finding. Values beyond a limit by no more than rounding become
/// the limit.
pub(super) fn within_limits(
    model: &RobotModel,
    index: DofIdx,
    value: f64,
    place: Span,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let dof = &model.dofs()[index];
    let nearest = value.clamp(dof.lower, dof.upper);
    let inside = (value - nearest).abs() <= ROUNDING;
    if !inside {
        let mut diagnostic =
            Diagnostic::error("R0409", format!("{value} is outside of the limits of joint \"{}\"", dof.name))
                .at(place, "outside of the limits")
                .expected(format!("a value from {} to {}", dof.lower, dof.upper));
        let turned = value.to_radians();
        let revolute = model.joints()[dof.joint].motion == JointMotion::Revolute;
        if revolute && value.abs() > TAU && dof.lower <= turned && turned <= dof.upper {
            diagnostic = diagnostic.hint(format!("angles are radians: {value} degrees are {turned:.4}"));
        }
        diagnostics.push(diagnostic);
    }
    inside.then_some(nearest)
}

/// The index of the thing of this name among `names`, or a finding.
pub(super) fn named<'a>(
    (name, place): (&str, Span),
    names: impl Iterator<Item = &'a str> + Clone,
    code: &'static str,
    thing: &str,
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    let found = names.clone().position(|known| known == name);
    if found.is_none() {
        diagnostics.push(no_such(code, name, &format!("is not {thing}"), place, names, thing));
    }
    found
}

fn no_such<'a>(
    code: &'static str,
    name: &str,
    what: &str,
    place: Span,
    names: impl Iterator<Item = &'a str> + Clone,
    thing: &str,
) -> Diagnostic {
    let all: Vec<&str> = names.clone().filter(|name| !name.is_empty()).collect();
    let expected = match all.len() {
        0 => format!("{thing}, of which there is none"),
        1..=12 => format!("{thing}: {}", all.join(", ")),
        n => format!("{thing}, one of {n}"),
    };
    let diagnostic =
        Diagnostic::error(code, format!("\"{name}\" {what}")).at(place, "unknown").expected(expected);
    match nearest(name, names) {
        Some(near) => diagnostic.hint(format!("did you mean \"{near}\"?")),
        None => diagnostic,
    }
}

/// The pose in the table at `key`; the identity where nothing is written.
pub(super) fn origin(table: &Table, key: &str) -> Origin {
    let array = |name| table.table(key).and_then(|pose| pose.get(name)).and_then(Node::array::<3>);
    Origin { xyz: array("xyz").unwrap_or_default(), rpy: array("rpy").unwrap_or_default() }
}

/// `(a, b)` with the lower index first.
pub(super) fn ordered(a: LinkIdx, b: LinkIdx) -> (LinkIdx, LinkIdx) {
    if a.index() <= b.index() { (a, b) } else { (b, a) }
}
