//! A robot: links and joints in a tree.

use super::{Dof, Drive, Joint, JointMotion, Link};
use crate::ids::{DofIdx, JointIdx, LinkIdx, TypedVec};

/// A robot: a tree of links and joints. Immutable; share it in an [`Arc`](std::sync::Arc).
#[derive(Debug, Clone)]
pub struct RobotModel {
    pub(super) name: String,
    pub(super) links: TypedVec<LinkIdx, Link>,
    pub(super) joints: TypedVec<JointIdx, Joint>,
    pub(super) dofs: TypedVec<DofIdx, Dof>,
    pub(super) root: LinkIdx,
    /// Joints ordered parents first.
    pub(super) order: Vec<JointIdx>,
}

impl RobotModel {
    /// Name of the robot.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// All links, in file order.
    pub fn links(&self) -> &TypedVec<LinkIdx, Link> {
        &self.links
    }

    /// All joints, fixed ones included, in file order.
    pub fn joints(&self) -> &TypedVec<JointIdx, Joint> {
        &self.joints
    }

    /// All independently driven values, in the file order of their joints.
    pub fn dofs(&self) -> &TypedVec<DofIdx, Dof> {
        &self.dofs
    }

    /// The link with no parent.
    pub fn root(&self) -> LinkIdx {
        self.root
    }

    /// Joints ordered so that a parent comes before its children.
    pub fn topological_order(&self) -> &[JointIdx] {
        &self.order
    }

    /// The link of this name.
    pub fn link_named(&self, name: &str) -> Option<LinkIdx> {
        self.links.position(|l| l.name == name)
    }

    /// The joint of this name.
    pub fn joint_named(&self, name: &str) -> Option<JointIdx> {
        self.joints.position(|j| j.name == name)
    }

    /// The degree of freedom that drives the joint of this name.
    pub fn dof_named(&self, joint_name: &str) -> Option<DofIdx> {
        self.dofs.position(|d| d.name == joint_name)
    }

    /// The link above, or `None` for the root.
    pub fn parent(&self, link: LinkIdx) -> Option<LinkIdx> {
        self.links[link].parent_joint.map(|j| self.joints[j].parent)
    }

    /// Joints from `ancestor` down to `link`, or `None` when `link` is not below `ancestor`.
    pub fn joints_between(&self, ancestor: LinkIdx, link: LinkIdx) -> Option<Vec<JointIdx>> {
        let mut path = Vec::new();
        let mut at = link;
        while at != ancestor {
            let joint = self.links[at].parent_joint?;
            path.push(joint);
            at = self.joints[joint].parent;
        }
        path.reverse();
        Some(path)
    }

    /// Whether `joint` is on the way from the root to `link`.
    pub fn joint_moves_link(&self, joint: JointIdx, link: LinkIdx) -> bool {
        let mut at = Some(link);
        while let Some(l) = at {
            if self.links[l].parent_joint == Some(joint) {
                return true;
            }
            at = self.parent(l);
        }
        false
    }

    /// Degrees of freedom that move `link`, ascending; mimic joints count as the one they follow.
    pub fn dofs_moving(&self, link: LinkIdx) -> Vec<DofIdx> {
        let joints = self.joints_between(self.root, link).unwrap_or_default();
        let mut dofs: Vec<DofIdx> = joints.iter().filter_map(|&j| self.driving_dof(j)).collect();
        dofs.sort();
        dofs.dedup();
        dofs
    }

    /// The degree of freedom that gives `joint` its value, directly or through mimicry.
    pub fn driving_dof(&self, joint: JointIdx) -> Option<DofIdx> {
        match self.joints[joint].drive {
            Drive::Fixed => None,
            Drive::Dof(dof) | Drive::Mimic { dof, .. } => Some(dof),
        }
    }

    /// All links at or below `link`, parents first.
    pub fn subtree(&self, link: LinkIdx) -> Vec<LinkIdx> {
        let mut found = vec![link];
        let mut next = 0;
        while next < found.len() {
            for &joint in &self.links[found[next]].child_joints {
                found.push(self.joints[joint].child);
            }
            next += 1;
        }
        found
    }

    /// Links joined to `link` by fixed joints, itself included: one rigid body. Ascending.
    pub fn rigid_group(&self, link: LinkIdx) -> Vec<LinkIdx> {
        let mut top = link;
        while let Some(joint) = self.links[top].parent_joint {
            if self.joints[joint].motion != JointMotion::Fixed {
                break;
            }
            top = self.joints[joint].parent;
        }
        let mut found = vec![top];
        let mut next = 0;
        while next < found.len() {
            for &joint in &self.links[found[next]].child_joints {
                if self.joints[joint].motion == JointMotion::Fixed {
                    found.push(self.joints[joint].child);
                }
            }
            next += 1;
        }
        found.sort();
        found
    }
}
