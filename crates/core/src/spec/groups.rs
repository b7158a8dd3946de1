//! What an SRDF says about arms and pairs of links.

use super::{arms, lookup};
use crate::ids::{DofIdx, LinkIdx};
use crate::model::{Kinematics, RobotModel};
use crate::robot::{Arm, Gripper};
use crate::srdf::{Group, Srdf};

/// Names of group states that hold a resting position, best first.
const RESTING: [&str; 3] = ["home", "ready", "default"];

/// The pairs of links that need no test, lower index first. Pairs of links that the model does not have are left out.
pub(super) fn disabled_pairs(srdf: &Srdf, model: &RobotModel) -> Vec<(LinkIdx, LinkIdx)> {
    let pair = |first: &str, second: &str| {
        let (first, second) = (model.link_named(first)?, model.link_named(second)?);
        (first != second).then(|| lookup::ordered(first, second))
    };
    srdf.disabled_pairs.iter().filter_map(|p| pair(&p.first.text, &p.second.text)).collect()
}

/// The groups that are serial chains, as arms, in file order. Groups of end effectors and of other groups are no arms.
///
/// An arm carries the first gripper whose palm is fixed to its tip, and rests in the state called `home` or `ready`.
pub(super) fn chains(srdf: &Srdf, kinematics: &Kinematics, grippers: &[Gripper]) -> Vec<Arm> {
    let model = kinematics.model();
    let is_tool = |group: &Group| srdf.end_effectors.iter().any(|e| e.group.text == group.name.text);
    let mut found: Vec<Arm> = Vec::new();
    for group in srdf.groups.iter().filter(|g| g.subgroups.is_empty() && !is_tool(g)) {
        let Some((base, tip)) = ends(group, model) else { continue };
        let Ok(dofs) = arms::chain_dofs(kinematics, base, tip) else { continue };
        let on_tip = model.rigid_group(tip);
        found.push(Arm {
            name: name_of(&group.name.text),
            base,
            tip,
            gripper: grippers.iter().position(|g| on_tip.contains(&g.palm)),
            free: None,
            home: resting(srdf, group, model, &dofs),
            dofs,
        });
    }
    found
}

/// Base and tip link of a group that is one serial chain.
fn ends(group: &Group, model: &RobotModel) -> Option<(LinkIdx, LinkIdx)> {
    if let [(base, tip)] = &group.chains[..] {
        return Some((model.link_named(&base.text)?, model.link_named(&tip.text)?));
    }
    // Joints, and the joints above links, in an order from the root down; each must hang on the one before.
    let named = group.joints.iter().filter_map(|j| model.joint_named(&j.text));
    let above = group.links.iter().filter_map(|l| model.links()[model.link_named(&l.text)?].parent_joint);
    let members: Vec<_> = named.chain(above).collect();
    let path: Vec<_> = model.topological_order().iter().filter(|j| members.contains(j)).collect();
    let (first, last) = (**path.first()?, **path.last()?);
    let (base, tip) = (model.joints()[first].parent, model.joints()[last].child);
    let between = model.joints_between(base, tip)?;
    path.iter().all(|j| between.contains(j)).then_some((base, tip))
}

/// The values of the group's resting state for `dofs`, if it has one that is complete and within the limits.
fn resting(srdf: &Srdf, group: &Group, model: &RobotModel, dofs: &[DofIdx]) -> Option<Vec<f64>> {
    let state = RESTING.iter().find_map(|name| {
        srdf.states.iter().find(|s| s.group.text == group.name.text && s.name.text.eq_ignore_ascii_case(name))
    })?;
    let value = |dof: &DofIdx| {
        let dof = &model.dofs()[*dof];
        let (_, value) = state.values.iter().find(|(joint, _)| joint.text == dof.name)?;
        (dof.lower <= *value && *value <= dof.upper).then_some(value + 0.0)
    };
    dofs.iter().map(value).collect()
}

/// A name as specifications allow it: other characters become `_`.
pub(super) fn name_of(text: &str) -> String {
    let allowed = |c: char| if c.is_ascii_alphanumeric() || "_.-".contains(c) { c } else { '_' };
    let name: String = text.chars().map(allowed).collect();
    match name.trim_start_matches(['.', '-']) {
        "" => "unnamed".to_owned(),
        name => name.to_owned(),
    }
}
