//! The grippers of a robot specification.

use nalgebra::{Unit, Vector3};

use super::document::Table;
use super::lookup;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::ids::{DofIdx, LinkIdx};
use crate::model::RobotModel;
use crate::robot::{Gripper, Hold, Preshape};

/// A `[[gripper]]` table as a gripper, or `None` with findings.
pub(super) fn read(table: &Table, model: &RobotModel, diagnostics: &mut Diagnostics) -> Option<Gripper> {
    let name = table.text("name")?.0.to_owned();
    let palm = table.text("palm").and_then(|palm| lookup::link(model, palm, diagnostics));
    let approach = approach(table, diagnostics);
    let joints = lookup::dofs(model, table.list("joints"), diagnostics);
    let fingers = lookup::links(model, table.list("fingers"), diagnostics);
    if let Some(palm) = palm {
        below_palm(model, palm, joints.as_deref().unwrap_or_default(), &fingers, diagnostics);
    }
    let attracts = table.text("hold").is_some_and(|(hold, _)| hold == "attract");
    let hold = if attracts { Hold::Attract } else { Hold::Close };
    let dofs: Vec<DofIdx> =
        joints.filter(|j| attracts || !j.is_empty())?.into_iter().map(|(dof, _)| dof).collect();
    let closing = if attracts { Some(Vec::new()) } else { closing(table, model, &dofs, diagnostics) };
    let preshapes = if attracts {
        vec![Preshape { name: "open".to_owned(), values: Vec::new() }]
    } else {
        preshapes(table, model, &dofs, closing.as_deref(), diagnostics)
    };
    let gripper = Gripper {
        name,
        palm: palm?,
        palm_from_tool: lookup::origin(table, "tool").pose(),
        approach_in_tool: approach?,
        hold,
        closing: closing?,
        fingers: fingers.into_iter().map(|(link, _)| link).collect(),
        preshapes,
        dofs,
    };
    Some(gripper)
}

fn approach(table: &Table, diagnostics: &mut Diagnostics) -> Option<Unit<Vector3<f64>>> {
    let Some(node) = table.get("approach") else { return Some(Vector3::z_axis()) };
    let direction = Unit::try_new(Vector3::from(node.array::<3>()?), 1e-9);
    if direction.is_none() {
        diagnostics.push(
            Diagnostic::error("R0418", "the approach has no direction")
                .at(node.span, "this has no length")
                .expected("a direction such as [0.0, 0.0, 1.0]"),
        );
    }
    direction
}

/// Fingers and their joints must hang below the palm, or moving the palm would not move them.
fn below_palm(
    model: &RobotModel,
    palm: LinkIdx,
    joints: &[(DofIdx, Span)],
    fingers: &[(LinkIdx, Span)],
    diagnostics: &mut Diagnostics,
) {
    let body: Vec<LinkIdx> = model.rigid_group(palm).iter().flat_map(|&l| model.subtree(l)).collect();
    let palm_name = &model.links()[palm].name;
    for &(dof, place) in joints {
        let joint = &model.joints()[model.dofs()[dof].joint];
        if !body.contains(&joint.parent) {
            diagnostics.push(
                Diagnostic::error(
                    "R0410",
                    format!("joint \"{}\" is not below palm \"{palm_name}\"", joint.name),
                )
                .at(place, "not part of this gripper")
                .expected("a joint that moves a finger against the palm"),
            );
        }
    }
    for &(link, place) in fingers {
        if !body.contains(&link) {
            let name = &model.links()[link].name;
            diagnostics.push(
                Diagnostic::error("R0410", format!("link \"{name}\" is not below palm \"{palm_name}\""))
                    .at(place, "not part of this gripper")
                    .expected("a link that hangs on the palm"),
            );
        }
    }
}

/// The signs of `closing`, one for each joint.
fn closing(
    table: &Table,
    model: &RobotModel,
    dofs: &[DofIdx],
    diagnostics: &mut Diagnostics,
) -> Option<Vec<f64>> {
    let node = table.get("closing")?;
    let signs = node.numbers().filter(|signs| !signs.is_empty())?;
    for (sign, item) in signs.iter().zip(node.list().unwrap_or_default()) {
        if sign.abs() < 1.0 && *sign != 0.0 {
            diagnostics.push(
                Diagnostic::error("R0105", format!("`gripper.closing` holds {sign}"))
                    .at(item.span, "not a direction")
                    .expected("1, -1 or 0"),
            );
        }
    }
    if signs.iter().all(|sign| *sign == 0.0) {
        diagnostics.push(
            Diagnostic::error("R0416", "no joint closes this gripper")
                .at(node.span, "all zero")
                .expected("1 or -1 for at least one joint"),
        );
    }
    lookup::one_each(model, node, signs.len(), dofs, diagnostics).then_some(signs)
}

fn preshapes(
    table: &Table,
    model: &RobotModel,
    dofs: &[DofIdx],
    closing: Option<&[f64]>,
    diagnostics: &mut Diagnostics,
) -> Vec<Preshape> {
    if table.get("preshape").is_none() {
        let values = open_values(model, dofs, closing.unwrap_or_default());
        return vec![Preshape { name: "open".to_owned(), values }];
    }
    let read = |(preshape, _): (&Table, Span)| {
        let values = lookup::values(model, preshape.get("values")?, dofs, diagnostics)?;
        Some(Preshape { name: preshape.text("name")?.0.to_owned(), values })
    };
    table.tables("preshape").filter_map(read).collect()
}

/// Every closing joint at the limit it opens to, the others as near to zero as their limits allow.
pub(super) fn open_values(model: &RobotModel, dofs: &[DofIdx], closing: &[f64]) -> Vec<f64> {
    let value = |(dof, sign): (&DofIdx, &f64)| {
        let dof = &model.dofs()[*dof];
        match *sign {
            s if s > 0.0 && dof.lower.is_finite() => dof.lower,
            s if s < 0.0 && dof.upper.is_finite() => dof.upper,
            _ => 0.0_f64.clamp(dof.lower, dof.upper),
        }
    };
    dofs.iter().zip(closing).map(value).collect()
}
