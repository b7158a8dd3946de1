//! SRDF: what the parts of a robot are for, as MoveIt writes it down beside a URDF.

use std::collections::BTreeSet;
use std::path::Path;

use crate::diag::{Diagnostic, Diagnostics, Sources, Span, nearest};
use crate::model::RobotModel;
use crate::system::System;
use crate::xml::{self, Element};

/// A name and where it is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// The name.
    pub text: String,
    /// The place.
    pub span: Span,
}

/// A set of links and joints that is planned for together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Unique among groups.
    pub name: Name,
    /// Chains, each as base and tip link.
    pub chains: Vec<(Name, Name)>,
    /// Joints.
    pub joints: Vec<Name>,
    /// Links; each stands for the joint above it.
    pub links: Vec<Name>,
    /// Other groups that belong to this one.
    pub subgroups: Vec<Name>,
}

/// A tool at the end of a group.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EndEffector {
    /// Unique among end effectors.
    pub name: Name,
    /// The link that carries it.
    pub parent_link: Name,
    /// The group of its own links and joints.
    pub group: Name,
    /// The group it is carried by, if said.
    pub parent_group: Option<Name>,
}

/// Joint values of a group under a name.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupState {
    /// Unique in its group.
    pub name: Name,
    /// The group.
    pub group: Name,
    /// Joint and value (radians or metres), in file order.
    pub values: Vec<(Name, f64)>,
}

/// Two links that need no collision test.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DisabledPair {
    /// One link.
    pub first: Name,
    /// The other.
    pub second: Name,
    /// Why, in the words of the file: `Adjacent`, `Never`, ...; empty if it gives no reason.
    pub reason: String,
}

/// A semantic description.
#[derive(Debug, Clone, PartialEq)]
pub struct Srdf {
    /// Name of the robot that it describes.
    pub name: String,
    /// Groups, in file order.
    pub groups: Vec<Group>,
    /// End effectors, in file order.
    pub end_effectors: Vec<EndEffector>,
    /// Named states, in file order.
    pub states: Vec<GroupState>,
    /// Pairs without collision test, in file order.
    pub disabled_pairs: Vec<DisabledPair>,
    /// Joints that are not driven.
    pub passive_joints: Vec<Name>,
}

impl Srdf {
    /// The group of this name.
    pub fn group(&self, name: &str) -> Option<&Group> {
        self.groups.iter().find(|g| g.name.text == name)
    }
}

/// Reads the SRDF file at `path`. `None` when the file is no SRDF at all; else everything that could be understood.
///
/// With a `model`, names that it does not have are warned of: one SRDF often serves several variants of a robot.
pub fn load(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    model: Option<&RobotModel>,
) -> (Option<Srdf>, Diagnostics) {
    let (root, mut found) = xml::load(system, sources, path);
    let srdf = root.and_then(|root| read(&root, &mut found));
    if let (Some(srdf), Some(model)) = (&srdf, model) {
        check_names(srdf, model, &mut found);
    }
    (srdf, found)
}

fn read(root: &Element, found: &mut Diagnostics) -> Option<Srdf> {
    if root.name != "robot" {
        let message = format!("the root element is `<{}>`: not a semantic robot description", root.name);
        found.push(Diagnostic::error("R0260", message).at(root.span, "not `<robot>`").expected("`<robot>`"));
        return None;
    }
    let mut srdf = Srdf {
        name: root.value("name").unwrap_or_default().to_owned(),
        groups: Vec::new(),
        end_effectors: Vec::new(),
        states: Vec::new(),
        disabled_pairs: Vec::new(),
        passive_joints: Vec::new(),
    };
    for element in root.elements() {
        match element.name.as_str() {
            "group" => srdf.groups.extend(group(element, found)),
            "end_effector" => srdf.end_effectors.extend(end_effector(element, found)),
            "group_state" => srdf.states.extend(state(element, found)),
            "disable_collisions" => srdf.disabled_pairs.extend(disabled(element, found)),
            "passive_joint" => srdf.passive_joints.extend(name(element, "name", found)),
            _ => {}
        }
    }
    for (i, group) in srdf.groups.iter().enumerate() {
        if srdf.groups[..i].iter().any(|g| g.name.text == group.name.text) {
            let message = format!("group `{}` is defined twice", group.name.text);
            found.push(Diagnostic::error("R0260", message).at(group.name.span, "second definition"));
        }
    }
    Some(srdf)
}

fn name(element: &Element, attribute: &str, found: &mut Diagnostics) -> Option<Name> {
    let given = element.attribute(attribute).filter(|a| !a.value.trim().is_empty());
    if given.is_none() {
        let message = format!("`<{}>` has no attribute `{attribute}`", element.name);
        found.push(Diagnostic::error("R0260", message).at(element.span, format!("`{attribute}` is missing")));
    }
    given.map(|a| Name { text: a.value.trim().to_owned(), span: a.span })
}

fn group(element: &Element, found: &mut Diagnostics) -> Option<Group> {
    let mut group = Group {
        name: name(element, "name", found)?,
        chains: Vec::new(),
        joints: Vec::new(),
        links: Vec::new(),
        subgroups: Vec::new(),
    };
    for part in element.elements() {
        match part.name.as_str() {
            "chain" => {
                let (base, tip) = (name(part, "base_link", found), name(part, "tip_link", found));
                group.chains.extend(base.zip(tip));
            }
            "joint" => group.joints.extend(name(part, "name", found)),
            "link" => group.links.extend(name(part, "name", found)),
            "group" => group.subgroups.extend(name(part, "name", found)),
            _ => {}
        }
    }
    Some(group)
}

fn end_effector(element: &Element, found: &mut Diagnostics) -> Option<EndEffector> {
    let (own, parent_link, group) =
        (name(element, "name", found), name(element, "parent_link", found), name(element, "group", found));
    let parent_group = element.attribute("parent_group").and_then(|_| name(element, "parent_group", found));
    Some(EndEffector { name: own?, parent_link: parent_link?, group: group?, parent_group })
}

fn state(element: &Element, found: &mut Diagnostics) -> Option<GroupState> {
    let (own, group) = (name(element, "name", found), name(element, "group", found));
    let mut values = Vec::new();
    for joint in element.named("joint") {
        let Some(joint_name) = name(joint, "name", found) else { continue };
        let Some(value) = name(joint, "value", found) else { continue };
        match value.text.parse::<f64>() {
            Ok(x) if x.is_finite() => values.push((joint_name, x)),
            _ => found.push(
                Diagnostic::error("R0260", format!("`{}` is not one joint value", value.text))
                    .at(value.span, "not a number")
                    .expected("a number, radians or metres"),
            ),
        }
    }
    Some(GroupState { name: own?, group: group?, values })
}

fn disabled(element: &Element, found: &mut Diagnostics) -> Option<DisabledPair> {
    let (first, second) = (name(element, "link1", found), name(element, "link2", found));
    let reason = element.value("reason").unwrap_or_default().to_owned();
    Some(DisabledPair { first: first?, second: second?, reason })
}

/// Warns of each name that the model (or, for groups, the file itself) does not have; once for each name.
fn check_names(srdf: &Srdf, model: &RobotModel, found: &mut Diagnostics) {
    let links: Vec<&str> = model.links().iter().map(|l| l.name.as_str()).collect();
    let joints: Vec<&str> = model.joints().iter().map(|j| j.name.as_str()).collect();
    let groups: Vec<&str> = srdf.groups.iter().map(|g| g.name.text.as_str()).collect();
    let mut told: BTreeSet<(&str, &str)> = BTreeSet::new();
    for (kind, name) in names(srdf) {
        let known = match kind {
            "link" => &links,
            "joint" => &joints,
            _ => &groups,
        };
        if known.contains(&name.text.as_str()) || !told.insert((kind, &name.text)) {
            continue;
        }
        let mut d = Diagnostic::warning("R0261", format!("the robot has no {kind} `{}`", name.text))
            .at(name.span, format!("no such {kind}"));
        if let Some(meant) = nearest(&name.text, known.iter().copied()) {
            d = d.hint(format!("did you mean `{meant}`?"));
        }
        found.push(d);
    }
}

/// All names that refer to something, with what kind of thing they name.
fn names(srdf: &Srdf) -> Vec<(&'static str, &Name)> {
    let mut names = Vec::new();
    for group in &srdf.groups {
        names.extend(group.chains.iter().flat_map(|(base, tip)| [("link", base), ("link", tip)]));
        names.extend(group.joints.iter().map(|n| ("joint", n)));
        names.extend(group.links.iter().map(|n| ("link", n)));
        names.extend(group.subgroups.iter().map(|n| ("group", n)));
    }
    for tool in &srdf.end_effectors {
        names.extend([("link", &tool.parent_link), ("group", &tool.group)]);
        names.extend(tool.parent_group.iter().map(|n| ("group", n)));
    }
    for state in &srdf.states {
        names.push(("group", &state.group));
        names.extend(state.values.iter().map(|(n, _)| ("joint", n)));
    }
    names.extend(srdf.disabled_pairs.iter().flat_map(|pair| [("link", &pair.first), ("link", &pair.second)]));
    names.extend(srdf.passive_joints.iter().map(|n| ("joint", n)));
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Origin, RobotBuilder};
    use crate::system::MemorySystem;

    fn read(text: &str, model: Option<&RobotModel>) -> (Option<Srdf>, String) {
        let mut system = MemorySystem::new();
        system.insert("r.srdf", text);
        let mut sources = Sources::new();
        let (srdf, found) = load(&system, &mut sources, Path::new("r.srdf"), model);
        (srdf, found.to_plain_text(&sources))
    }

    const TEXT: &str = "<robot name=\"r\">
  <group name=\"arm\"><chain base_link=\"base\" tip_link=\"hand\"/></group>
  <group name=\"tool\"><link name=\"finger\"/><joint name=\"grip\"/><group name=\"arm\"/></group>
  <end_effector name=\"e\" parent_link=\"hand\" group=\"tool\"/>
  <group_state name=\"home\" group=\"arm\"><joint name=\"grip\" value=\" 0.5 \"/></group_state>
  <disable_collisions link1=\"base\" link2=\"hnad\" reason=\"Adjacent\"/>
  <disable_collisions link1=\"hnad\" link2=\"base\"/>
</robot>";

    #[test]
    fn all_parts_are_read() {
        let (srdf, text) = read(TEXT, None);
        let srdf = srdf.unwrap();
        assert_eq!(text, "");
        assert_eq!(srdf.groups[0].chains[0].1.text, "hand");
        let tool = srdf.group("tool").unwrap();
        assert_eq!((tool.links.len(), tool.joints.len(), tool.subgroups.len()), (1, 1, 1));
        assert_eq!(srdf.states[0].values[0].1, 0.5);
        assert_eq!(srdf.disabled_pairs[0].reason, "Adjacent");
        assert_eq!(srdf.end_effectors[0].parent_group, None);
    }

    #[test]
    fn unknown_names_are_warned_of_once() {
        let mut builder = RobotBuilder::new("r");
        for link in ["base", "hand", "finger"] {
            builder.link(link, Vec::new(), Vec::new(), None);
        }
        builder.fixed("mount", "base", "hand", Origin::default());
        builder.fixed("grip", "hand", "finger", Origin::default());
        let model = builder.build().unwrap();
        let (_, text) = read(TEXT, Some(&model));
        let warning =
            "r.srdf:6:43: warning[R0261]: the robot has no link `hnad`; hint: did you mean `hand`?\n";
        assert_eq!(text, warning);
    }

    #[test]
    fn faults_are_told_and_the_rest_is_kept() {
        let (srdf, text) = read(
            "<robot>\n<group><joint name=\"a\"/></group>\n<group_state name=\"s\" group=\"g\">\
             <joint name=\"j\" value=\"x\"/></group_state>\n</robot>",
            None,
        );
        assert_eq!(srdf.unwrap().states.len(), 1);
        assert_eq!(text.lines().count(), 2, "{text}");
        assert!(
            text.contains("r.srdf:2:1: error[R0260]") && text.contains("r.srdf:3:56: error[R0260]"),
            "{text}"
        );
    }
}
