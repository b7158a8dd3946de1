//! A gripper on its own: the links that can touch an object and how its fingers move them, without the arm.

use robotc_core::Pose;
use robotc_core::geom::ConvexParts;
use robotc_core::ids::{DofIdx, Idx, JointIdx, LinkIdx};
use robotc_core::model::{Drive, Kinematics};
use robotc_core::robot::Gripper;

/// A part of the hand that moves as one.
pub(super) struct HandLink<'a> {
    /// The link.
    pub(super) link: LinkIdx,
    /// Its convex parts, in the link frame.
    pub(super) parts: &'a ConvexParts,
    /// Degrees of freedom of the gripper that move it, positions in [`Gripper::dofs`]; empty: rigid with the palm.
    pub(super) moved_by: Vec<usize>,
    /// Whether it may touch the object.
    pub(super) is_finger: bool,
}

/// The links rigid with or below the palm that have geometry.
pub(super) struct Hand<'a> {
    kinematics: &'a Kinematics,
    gripper: &'a Gripper,
    /// Links with geometry: palm side first, then fingers, ascending link index in each.
    pub(super) links: Vec<HandLink<'a>>,
    /// How to reach every link below the palm from its parent: position of the parent, joint, position of the child.
    walk: Vec<(usize, JointIdx, usize)>,
    /// Palm-relative pose slots: one for each entry of `slot_of`.
    slots: usize,
    slot_of: Vec<usize>,
    rigid: Vec<(usize, Pose)>,
}

impl<'a> Hand<'a> {
    /// The hand of `gripper`; `parts_of` gives the convex parts of a link (empty when it has none).
    pub(super) fn new(
        kinematics: &'a Kinematics,
        gripper: &'a Gripper,
        parts_of: impl Fn(LinkIdx) -> Option<&'a ConvexParts>,
    ) -> Self {
        let model = kinematics.model();
        let subtree = model.subtree(gripper.palm);
        let mut slots: Vec<LinkIdx> = subtree.clone();
        let mut walk = Vec::new();
        for (child, &link) in subtree.iter().enumerate().skip(1) {
            let joint = model.links()[link].parent_joint.expect("links below the palm have a parent joint");
            let parent = model.joints()[joint].parent;
            let parent =
                subtree.iter().position(|&l| l == parent).expect("a subtree is closed under parents");
            walk.push((parent, joint, child));
        }
        // Links above the palm but rigid with it (a flange, a force sensor) can touch as well.
        let neutral = robotc_core::Configuration::neutral(model);
        let root_from_palm = kinematics.root_from_link(&neutral, gripper.palm);
        let mut rigid = Vec::new();
        for link in model.rigid_group(gripper.palm) {
            if !subtree.contains(&link) {
                rigid.push((
                    slots.len(),
                    root_from_palm.inverse() * kinematics.root_from_link(&neutral, link),
                ));
                slots.push(link);
            }
        }
        let mut links = Vec::new();
        let mut slot_of = Vec::new();
        for (slot, &link) in slots.iter().enumerate() {
            let Some(parts) = parts_of(link).filter(|p| !p.is_empty()) else { continue };
            let moved_by = gripper
                .dofs
                .iter()
                .enumerate()
                .filter(|(_, dof)| moves(kinematics, **dof, link))
                .map(|(i, _)| i)
                .collect();
            links.push(HandLink { link, parts, moved_by, is_finger: gripper.fingers.contains(&link) });
            slot_of.push(slot);
        }
        Self { kinematics, gripper, links, walk, slots: slots.len(), slot_of, rigid }
    }

    /// The gripper this is the hand of.
    pub(super) fn gripper(&self) -> &Gripper {
        self.gripper
    }

    /// `palm_from_link` of each of `links` when the fingers have these values (in the order of [`Gripper::dofs`]).
    pub(super) fn palm_from_links(&self, values: &[f64]) -> Vec<Pose> {
        let model = self.kinematics.model();
        let mut palm_from = vec![Pose::identity(); self.slots];
        for &(parent, joint, child) in &self.walk {
            let value = match model.joints()[joint].drive {
                Drive::Fixed => 0.0,
                Drive::Dof(dof) => self.value_of(dof, values),
                Drive::Mimic { dof, multiplier, offset } => multiplier * self.value_of(dof, values) + offset,
            };
            palm_from[child] = palm_from[parent] * self.kinematics.parent_from_child(joint, value);
        }
        for (slot, pose) in &self.rigid {
            palm_from[*slot] = *pose;
        }
        self.slot_of.iter().map(|&slot| palm_from[slot]).collect()
    }

    /// Degrees of freedom outside of the gripper stay where the model is neutral.
    fn value_of(&self, dof: DofIdx, values: &[f64]) -> f64 {
        match self.gripper.dofs.iter().position(|&d| d == dof) {
            Some(i) => values[i],
            None => {
                let d = &self.kinematics.model().dofs()[dof];
                0.0_f64.clamp(d.lower, d.upper)
            }
        }
    }

    /// Range of a finger value, in the order of [`Gripper::dofs`].
    pub(super) fn range(&self, finger: usize) -> (f64, f64) {
        self.kinematics.model().dofs()[self.gripper.dofs[finger]].sampling_range()
    }

    /// Farthest that any point of the links moved by `finger` travels for one unit of its value, metres.
    pub(super) fn travel_bound(&self, finger: usize) -> f64 {
        let model = self.kinematics.model();
        let dof = self.gripper.dofs[finger];
        let mut bound: f64 = 0.0;
        for link in self.links.iter().filter(|l| l.moved_by.contains(&finger)) {
            let reach = link.parts.points().map(|p| p.coords.norm()).fold(0.0, f64::max);
            let mut travel = 0.0;
            let mut distance = reach;
            let mut at = link.link;
            while at != self.gripper.palm {
                let Some(j) = model.links()[at].parent_joint else { break };
                let joint = &model.joints()[j];
                let factor = match joint.drive {
                    Drive::Dof(d) if d == dof => 1.0,
                    Drive::Mimic { dof: d, multiplier, .. } if d == dof => multiplier.abs(),
                    _ => 0.0,
                };
                travel += match joint.motion {
                    robotc_core::model::JointMotion::Prismatic => factor,
                    _ => factor * distance,
                };
                distance += joint.parent_from_joint().translation.vector.norm();
                at = joint.parent;
            }
            bound = bound.max(travel);
        }
        bound
    }
}

/// Whether `dof` moves `link`, directly or through a joint that mimics it.
fn moves(kinematics: &Kinematics, dof: DofIdx, link: LinkIdx) -> bool {
    kinematics.model().dofs_moving(link).iter().any(|d| d.index() == dof.index())
}
