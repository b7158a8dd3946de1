//! Guesses arms: long serial chains that end in a gripper or in nothing.

use super::bodies::{Bodies, NEITHER, WHEEL};
use super::hands::Hand;
use crate::ids::{JointIdx, LinkIdx};
use crate::model::{JointMotion, Kinematics};
use crate::spec::arms::chain_dofs;

/// Fewest joints of a chain that is called an arm.
const FEWEST: usize = 4;

/// Joints that place a tool freely: a chain this long needs no joints of the torso below it.
const ENOUGH: usize = 6;

/// Parts of names of frames that makers put where a tool goes, best first.
const TOOL_FRAMES: [&str; 6] = ["tool0", "tcp", "flange", "ee_link", "end_effector", "tool"];

/// A guessed arm.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Limb {
    pub(super) base: LinkIdx,
    pub(super) tip: LinkIdx,
    /// The gripper it ends in.
    pub(super) hand: Option<usize>,
}

/// All arms: those with a hand first, then the others, each in the order of the bodies.
pub(super) fn find(bodies: &Bodies, hands: &[Hand], kinematics: &Kinematics) -> Vec<Limb> {
    let start = below_planar_joints(bodies);
    let in_hand: Vec<usize> = hands.iter().flat_map(|hand| bodies.subtree(hand.body)).collect();
    let mut limbs: Vec<(Limb, usize)> = Vec::new();
    for (index, hand) in hands.iter().enumerate() {
        limbs.extend(limb(bodies, hands, start, hand.body, hand.palm, Some(index), kinematics));
    }
    for body in 0..bodies.all.len() {
        let named = bodies.path(start, body).iter().any(|&b| bodies.mentions(b, NEITHER));
        if bodies.all[body].children.is_empty() && !in_hand.contains(&body) && !named {
            limbs.extend(limb(bodies, hands, start, body, tool_frame(bodies, body), None, kinematics));
        }
    }
    let long = limbs.iter().any(|(_, dofs)| *dofs >= FEWEST);
    let longest = limbs.iter().map(|(_, dofs)| *dofs).max().unwrap_or(0);
    limbs.retain(|(limb, dofs)| if long { *dofs >= FEWEST || limb.hand.is_some() } else { *dofs == longest });
    limbs.into_iter().map(|(limb, _)| limb).collect()
}

/// The chain that ends at `tip`, and its number of degrees of freedom.
fn limb(
    bodies: &Bodies,
    hands: &[Hand],
    start: usize,
    body: usize,
    tip: LinkIdx,
    hand: Option<usize>,
    kinematics: &Kinematics,
) -> Option<(Limb, usize)> {
    // From the best base upwards, until the chain has joints of its own and follows none outside of it.
    let mut base_body = base_body(bodies, hands, start, body);
    loop {
        let path = bodies.path(base_body, body);
        let first = bodies.all[*path.first()?].joint?;
        let base = bodies.model.joints()[first].parent;
        if let Ok(dofs) = chain_dofs(kinematics, base, tip) {
            return Some((Limb { base, tip, hand }, dofs.len()));
        }
        base_body = bodies.all[base_body].parent?;
    }
}

/// The nearest body above that carries another limb, or, when the chain is long enough by then, anything else.
fn base_body(bodies: &Bodies, hands: &[Hand], start: usize, body: usize) -> usize {
    let mut at = body;
    let mut driven = 0;
    while at != start {
        let Some(parent) = bodies.all[at].parent else { break };
        driven += usize::from(bodies.is_driven(at));
        let others = bodies.all[parent].children.iter().filter(|&&child| child != at);
        let carries = others.clone().any(|&child| is_limb(bodies, hands, child));
        let forks = others.clone().any(|&child| bodies.is_driven(child) && !bodies.mentions(child, WHEEL));
        at = parent;
        if carries || (forks && driven >= ENOUGH) {
            break;
        }
    }
    at
}

fn is_limb(bodies: &Bodies, hands: &[Hand], body: usize) -> bool {
    let below = bodies.subtree(body);
    let depth = usize::from(bodies.is_driven(body)) + bodies.depth(body);
    depth >= 3 || hands.iter().any(|hand| below.contains(&hand.body))
}

/// The link of the last body where a tool goes: one with a telling name, else the farthest from the joint.
fn tool_frame(bodies: &Bodies, body: usize) -> LinkIdx {
    let model = bodies.model;
    let links = &bodies.all[body].links;
    let named =
        |word: &&str| links.iter().copied().find(|&l| model.links()[l].name.to_lowercase().ends_with(word));
    let leaf = || {
        let depth =
            |l: LinkIdx| model.joints_between(links[0], l).map_or(0, |path: Vec<JointIdx>| path.len());
        // The first of the deepest.
        links.iter().copied().rev().max_by_key(|&l| depth(l)).unwrap_or(links[0])
    };
    TOOL_FRAMES.iter().find_map(named).unwrap_or_else(leaf)
}

/// The body below the joints of a planar base (two slides and a turn from the root), or the root.
pub(super) fn below_planar_joints(bodies: &Bodies) -> usize {
    let mut at = 0;
    let mut slides = 0;
    for _ in 0..3 {
        let [only] = bodies.all[at].children[..] else { return 0 };
        let Some(joint) = bodies.all[only].joint else { return 0 };
        let joint = &bodies.model.joints()[joint];
        let horizontal = joint.unit_axis().z.abs() < 1e-6;
        match joint.motion {
            JointMotion::Prismatic if horizontal => slides += 1,
            JointMotion::Revolute if !horizontal && slides == 2 => return only,
            _ => return 0,
        }
        at = only;
    }
    0
}
