//! The arms of a robot specification.

use super::document::Table;
use super::lookup;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::ids::{DofIdx, LinkIdx};
use crate::model::{ChainError, Kinematics, RobotModel, SerialChain};
use crate::robot::{Arm, Gripper};

/// An `[[arm]]` table as an arm, or `None` with findings. `gripper_names` are all that the file defines, in order, also
/// those that could not be read.
pub(super) fn read(
    table: &Table,
    place: Span,
    kinematics: &Kinematics,
    gripper_names: &[&str],
    diagnostics: &mut Diagnostics,
) -> Option<Arm> {
    let model = kinematics.model();
    let gripper = table.text("gripper").and_then(|name| {
        let names = gripper_names.iter().copied();
        lookup::named(name, names, "R0405", "a gripper of this robot", diagnostics)
    });
    let base = table.text("base").and_then(|name| lookup::link(model, name, diagnostics));
    let tip = table.text("tip").and_then(|name| lookup::link(model, name, diagnostics));
    let (base, tip) = (base?, tip?);
    let dofs = match chain_dofs(kinematics, base, tip) {
        Ok(dofs) => dofs,
        Err(error) => {
            let place = table.get("tip").map_or(place, |node| node.span);
            diagnostics.push(no_chain(model, base, tip, &error).at(place, "no chain ends here"));
            return None;
        }
    };
    let home = table.get("home").and_then(|list| lookup::values(model, list, &dofs, diagnostics));
    Some(Arm {
        name: table.text("name")?.0.to_owned(),
        base,
        tip,
        gripper,
        free: free(table, model, &dofs, diagnostics),
        home,
        dofs,
    })
}

/// The degrees of freedom of the chain from `base` to `tip`, base to tip.
pub(super) fn chain_dofs(
    kinematics: &Kinematics,
    base: LinkIdx,
    tip: LinkIdx,
) -> Result<Vec<DofIdx>, ChainError> {
    let chain = SerialChain::between(kinematics, base, tip)?;
    Ok(chain.variables.iter().map(|v| v.dof).collect())
}

fn no_chain(model: &RobotModel, base: LinkIdx, tip: LinkIdx, error: &ChainError) -> Diagnostic {
    let diagnostic = Diagnostic::error("R0404", error.to_string())
        .expected("a link below the base with moving joints between");
    match error {
        ChainError::NotBelow { base: base_name, tip: tip_name }
            if model.joints_between(tip, base).is_some() =>
        {
            diagnostic.hint(format!("\"{base_name}\" is below \"{tip_name}\": swap base and tip"))
        }
        ChainError::NotBelow { .. } => {
            let common = common_ancestor(model, base, tip);
            diagnostic.hint(format!("both are below \"{}\"", model.links()[common].name))
        }
        ChainError::MimicOutside { target, .. } => {
            diagnostic.hint(format!("start the chain above joint \"{target}\""))
        }
        ChainError::NoJoints { .. } => diagnostic,
    }
}

fn common_ancestor(model: &RobotModel, a: LinkIdx, b: LinkIdx) -> LinkIdx {
    let mut at = a;
    while model.joints_between(at, b).is_none() {
        at = model.parent(at).expect("every link is below the root");
    }
    at
}

fn free(
    table: &Table,
    model: &RobotModel,
    dofs: &[DofIdx],
    diagnostics: &mut Diagnostics,
) -> Option<Vec<DofIdx>> {
    table.get("free")?;
    let named = lookup::dofs(model, table.list("free"), diagnostics)?;
    for &(dof, place) in named.iter().filter(|(dof, _)| !dofs.contains(dof)) {
        let names: Vec<&str> = dofs.iter().map(|&d| model.dofs()[d].name.as_str()).collect();
        diagnostics.push(
            Diagnostic::error(
                "R0407",
                format!("joint \"{}\" is not in the arm's chain", model.dofs()[dof].name),
            )
            .at(place, "not between base and tip")
            .expected(format!("one of {}", names.join(", "))),
        );
    }
    Some(named.into_iter().map(|(dof, _)| dof).collect())
}

/// A finding when the gripper of an arm could move against the arm's tip.
pub(super) fn check_mounting(
    arm: &Arm,
    gripper: &Gripper,
    place: Span,
    model: &RobotModel,
    diagnostics: &mut Diagnostics,
) {
    let on_tip = model.rigid_group(arm.tip);
    let name = |link: LinkIdx| &model.links()[link].name;
    if !on_tip.contains(&gripper.palm) {
        let names: Vec<&str> = on_tip.iter().map(|&l| name(l).as_str()).collect();
        diagnostics.push(
            Diagnostic::error(
                "R0406",
                format!("palm \"{}\" is not fixed to tip \"{}\"", name(gripper.palm), name(arm.tip)),
            )
            .at(place, "this gripper is elsewhere")
            .expected(format!("a palm among {}", names.join(", "))),
        );
    }
    for &dof in gripper.dofs.iter().filter(|dof| arm.dofs.contains(dof)) {
        diagnostics.push(
            Diagnostic::error(
                "R0406",
                format!("joint \"{}\" moves both the arm and its gripper", model.dofs()[dof].name),
            )
            .at(place, "shares a joint with the arm")
            .expected("a tip above all joints of the gripper"),
        );
    }
}
