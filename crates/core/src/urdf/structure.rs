//! Whether links and joints make a tree, and the repairs that have one meaning.

use std::collections::{BTreeMap, BTreeSet};

use super::canonical;
use super::draft::{Draft, JointKind, LinkDraft, Name};
use crate::diag::{Diagnostic, Diagnostics, nearest};

/// Repairs `draft` where it can, and reports everything that keeps it from being a tree.
pub(super) fn check(draft: &mut Draft, found: &mut Diagnostics) {
    if draft.links.is_empty() && draft.joints.is_empty() {
        found.push(
            Diagnostic::error("R0207", format!("robot `{}` has no links", draft.name))
                .at(draft.span, "nothing in here")
                .hint(
                    "is this a fragment that another file includes, or a xacro file that was not expanded?",
                ),
        );
        return;
    }
    unique_names(draft, found);
    declare_root_links(draft, found);
    let faults = undeclared_links(draft, found) | two_parents(draft, found);
    if !faults {
        loops(draft, found);
        roots(draft, found);
    }
    free_joints(draft, found);
    mimics(draft, found);
}

/// Two links, or two joints, of one name. Copies that say the same are one link, told twice.
fn unique_names(draft: &mut Draft, found: &mut Diagnostics) {
    let mut report = |what: &str, first: &Name, second: &Name, same: bool| {
        let message = format!("{what} `{}` is defined twice", first.text);
        found.push(match same {
            true => {
                Diagnostic::warning("R0213", format!("{message}, both times alike; the second is ignored"))
                    .at(second.span, "second definition")
            }
            false => Diagnostic::error("R0213", message)
                .at(second.span, "second definition")
                .hint(format!("rename one of the two {what}s, or delete the one that is left over")),
        });
    };
    let mut links: BTreeMap<String, LinkDraft> = BTreeMap::new();
    draft.links.retain(|link| match links.get(&link.name.text) {
        Some(first) => {
            let same = canonical::link(first) == canonical::link(link);
            report("link", &first.name, &link.name, same);
            false
        }
        None => links.insert(link.name.text.clone(), link.clone()).is_none(),
    });
    let mut joints: BTreeMap<String, Name> = BTreeMap::new();
    draft.joints.retain(|joint| match joints.get(&joint.name.text) {
        Some(first) => {
            report("joint", first, &joint.name, false);
            false
        }
        None => joints.insert(joint.name.text.clone(), joint.name.clone()).is_none(),
    });
}

/// A link that only hangs others, such as `world`, is often left undeclared: it is added when that makes one tree.
fn declare_root_links(draft: &mut Draft, found: &mut Diagnostics) {
    let declared: BTreeSet<&str> = draft.links.iter().map(|l| l.name.text.as_str()).collect();
    let children: BTreeSet<&str> = draft.joints.iter().map(|j| j.child.text.as_str()).collect();
    let has_declared_root = declared.iter().any(|l| !children.contains(l));
    let mut missing: BTreeMap<&str, &Name> = BTreeMap::new();
    for joint in &draft.joints {
        let parent = joint.parent.text.as_str();
        if !declared.contains(parent) && !children.contains(parent) {
            missing.entry(parent).or_insert(&joint.parent);
        }
    }
    let added = match missing.values().next() {
        Some(&name) if missing.len() == 1 && !has_declared_root => name.clone(),
        _ => return,
    };
    found.push(
        Diagnostic::warning(
            "R0212",
            format!("root link `{}` is never declared; it is added without any shape", added.text),
        )
        .at(added.span, "used here")
        .hint(format!("declare it: <link name=\"{}\"/>", added.text)),
    );
    draft.links.push(LinkDraft::bare(added));
}

/// Most findings of one kind: the search for what was meant compares every name with every other.
const MOST_TOLD: usize = 50;

/// Whether a joint names a link that does not exist.
fn undeclared_links(draft: &Draft, found: &mut Diagnostics) -> bool {
    let declared: BTreeSet<&str> = draft.links.iter().map(|l| l.name.text.as_str()).collect();
    let (mut any, mut told) = (false, 0);
    for joint in &draft.joints {
        for end in [&joint.parent, &joint.child] {
            if declared.contains(end.text.as_str()) {
                continue;
            }
            any = true;
            told += 1;
            if told > MOST_TOLD {
                return any;
            }
            let message =
                format!("joint `{}` refers to link `{}`, which does not exist", joint.name.text, end.text);
            let mut d = Diagnostic::error("R0212", message).at(end.span, "no such link");
            d.hint = Some(match nearest(&end.text, declared.iter().copied()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => format!("declare it: <link name=\"{}\"/>", end.text),
            });
            found.push(d);
        }
    }
    any
}

fn two_parents(draft: &Draft, found: &mut Diagnostics) -> bool {
    let mut parent_of: BTreeMap<&str, &str> = BTreeMap::new();
    let mut any = false;
    for joint in &draft.joints {
        if let Some(first) = parent_of.insert(&joint.child.text, &joint.name.text) {
            any = true;
            let message = format!(
                "link `{}` is the child of two joints, `{first}` and `{}`",
                joint.child.text, joint.name.text
            );
            found.push(
                Diagnostic::error("R0214", message)
                    .at(joint.child.span, "second parent")
                    .hint("URDF describes trees; open the loop by removing one joint"),
            );
        }
    }
    any
}

/// Every link has at most one parent here, so a walk upwards that comes back has found a loop.
fn loops(draft: &Draft, found: &mut Diagnostics) {
    let up: BTreeMap<&str, usize> =
        draft.joints.iter().enumerate().map(|(i, j)| (j.child.text.as_str(), i)).collect();
    let mut settled: BTreeSet<&str> = BTreeSet::new();
    for link in &draft.links {
        let mut path: Vec<usize> = Vec::new();
        let mut on_path: BTreeSet<&str> = BTreeSet::new();
        let mut at = link.name.text.as_str();
        while !settled.contains(at) && on_path.insert(at) {
            let Some(&joint) = up.get(at) else { break };
            path.push(joint);
            at = &draft.joints[joint].parent.text;
        }
        let closes = !settled.contains(at) && up.contains_key(at);
        settled.extend(on_path);
        if closes {
            let start = path.iter().position(|&j| draft.joints[j].child.text == at).unwrap_or(0);
            let names: Vec<String> =
                path[start..].iter().rev().map(|&j| format!("`{}`", draft.joints[j].name.text)).collect();
            found.push(
                Diagnostic::error("R0216", format!("the joints {} form a loop", names.join(", ")))
                    .at(draft.joints[path[start]].child.span, "this child is above its parent")
                    .hint("URDF describes trees; open the loop by removing one joint"),
            );
        }
    }
}

/// Links without any joint are dropped; several trees are an error.
fn roots(draft: &mut Draft, found: &mut Diagnostics) {
    let children: BTreeSet<String> = draft.joints.iter().map(|j| j.child.text.clone()).collect();
    let parents: BTreeSet<String> = draft.joints.iter().map(|j| j.parent.text.clone()).collect();
    let is_root = |link: &LinkDraft| !children.contains(&link.name.text);
    if draft.links.iter().filter(|l| is_root(l)).count() < 2 {
        return;
    }
    let trees: Vec<Name> = draft
        .links
        .iter()
        .filter(|l| is_root(l) && parents.contains(&l.name.text))
        .map(|l| l.name.clone())
        .collect();
    if let [_] = trees[..] {
        for stray in draft.links.iter().filter(|l| is_root(l) && !parents.contains(&l.name.text)) {
            let message = format!("link `{}` is joined to nothing; it is dropped", stray.name.text);
            found.push(Diagnostic::warning("R0217", message).at(stray.name.span, "no joint names it"));
        }
        draft.links.retain(|l| !is_root(l) || parents.contains(&l.name.text));
        return;
    }
    let roots: Vec<&Name> = draft.links.iter().filter(|l| is_root(l)).map(|l| &l.name).collect();
    let names: Vec<String> = roots.iter().map(|r| format!("`{}`", r.text)).collect();
    found.push(
        Diagnostic::error(
            "R0215",
            format!("the robot is in {} pieces, with the roots {}", roots.len(), names.join(", ")),
        )
        .at(roots[1].span, "nothing joins this link to the rest")
        .hint("join the pieces by fixed joints, or put each into a file of its own"),
    );
}

/// A floating or planar joint that only places the robot in the world is fixed; elsewhere it is refused.
fn free_joints(draft: &mut Draft, found: &mut Diagnostics) {
    let children: BTreeSet<String> = draft.joints.iter().map(|j| j.child.text.clone()).collect();
    for joint in &mut draft.joints {
        if !matches!(joint.kind, JointKind::Floating | JointKind::Planar) {
            continue;
        }
        let kind = joint.kind.name();
        if children.contains(&joint.parent.text) {
            let message = format!("joint `{}` is {kind}, but not at the root", joint.name.text);
            let hint = match joint.kind {
                JointKind::Planar => "write it as two prismatic joints and a revolute one",
                _ => "write it as three prismatic and three revolute joints, or as a fixed one",
            };
            found.push(
                Diagnostic::error("R0221", message).at(joint.name.span, "six unknowns at once").hint(hint),
            );
        } else {
            let message = format!("{kind} joint `{}` at the root is taken as fixed", joint.name.text);
            found.push(
                Diagnostic::warning("R0221", message)
                    .at(joint.name.span, "taken as fixed")
                    .hint("where the robot stands is said by the task, and how it drives by its base"),
            );
        }
        joint.kind = JointKind::Fixed;
        joint.mimic = None;
    }
}

/// A mimic joint whose leader is missing, fixed or itself is made independent, or refused if it follows in a circle.
fn mimics(draft: &mut Draft, found: &mut Diagnostics) {
    let kinds: BTreeMap<String, JointKind> =
        draft.joints.iter().map(|j| (j.name.text.clone(), j.kind)).collect();
    let leader: BTreeMap<String, String> = draft
        .joints
        .iter()
        .filter_map(|j| Some((j.name.text.clone(), j.mimic.as_ref()?.joint.text.clone())))
        .collect();
    for joint in &mut draft.joints {
        if joint.kind == JointKind::Fixed {
            joint.mimic = None;
        }
        let Some(mimic) = &joint.mimic else { continue };
        let target = mimic.joint.text.as_str();
        let circle = || {
            let mut at = target;
            (0..=leader.len()).all(|_| match leader.get(at) {
                Some(next) => {
                    at = next;
                    true
                }
                None => false,
            })
        };
        let fault = match kinds.get(target) {
            None => format!(
                "does not exist{}",
                match nearest(target, kinds.keys().map(String::as_str)) {
                    Some(meant) => format!(" (did you mean `{meant}`?)"),
                    None => String::new(),
                }
            ),
            Some(JointKind::Fixed) => "is fixed".to_owned(),
            Some(_) if circle() => "follows in a circle".to_owned(),
            Some(_) => continue,
        };
        let message = format!("joint `{}` mimics `{target}`, which {fault}", joint.name.text);
        found.push(Diagnostic::error("R0226", message).at(mimic.joint.span, "gives no value"));
    }
}
