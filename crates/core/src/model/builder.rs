//! Links and joints by name, checked and joined to a robot.

use std::collections::BTreeMap;

use nalgebra::{Unit, Vector3};
use thiserror::Error;

use super::{Dof, Drive, DynamicLimits, Geometry, Inertial, Joint, JointMotion, Link, Origin, RobotModel};
use crate::ids::{DofIdx, Idx, JointIdx, LinkIdx, TypedVec};

/// Why links and joints do not make a robot.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum ModelError {
    /// The robot has no link.
    #[error("a robot needs at least one link")]
    NoLinks,
    /// Two links or two joints share a name.
    #[error("{0} is defined twice")]
    Duplicate(String),
    /// A joint names a link that does not exist.
    #[error("joint {joint} refers to link {link}, which does not exist")]
    UnknownLink {
        /// The joint.
        joint: String,
        /// The missing link.
        link: String,
    },
    /// A link hangs on two joints.
    #[error("link {0} has two parent joints")]
    TwoParents(String),
    /// More than one link has no parent.
    #[error("several links have no parent: {}", .0.join(", "))]
    SeveralRoots(Vec<String>),
    /// Links in a circle.
    #[error("the joints form a loop through link {0}")]
    Loop(String),
    /// A moving joint's axis has no direction.
    #[error("joint {0} has a zero axis")]
    ZeroAxis(String),
    /// A mimic joint follows a joint that is missing, fixed, or follows in a circle.
    #[error("joint {joint} mimics {target}, which gives it no value")]
    BadMimic {
        /// The follower.
        joint: String,
        /// The joint followed.
        target: String,
    },
    /// No position of a joint is within all of its limits.
    #[error("joint {0} is left with no position that it may take")]
    EmptyRange(String),
    /// Not a finite number where one is needed.
    #[error("{0} has a value that is not a finite number")]
    NotFinite(String),
}

struct PendingJoint {
    name: String,
    motion: JointMotion,
    parent: String,
    child: String,
    origin: Origin,
    axis: [f64; 3],
    limits: (f64, f64, bool, DynamicLimits),
    mimic: Option<(String, f64, f64)>,
}

/// Collects links and joints by name and checks that they form a tree.
#[derive(Default)]
pub struct RobotBuilder {
    name: String,
    links: TypedVec<LinkIdx, Link>,
    joints: Vec<PendingJoint>,
}

impl RobotBuilder {
    /// An empty robot of this name.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Adds a link.
    pub fn link(
        &mut self,
        name: impl Into<String>,
        visuals: Vec<Geometry>,
        collisions: Vec<Geometry>,
        inertial: Option<Inertial>,
    ) -> &mut Self {
        self.links.push(Link {
            name: name.into(),
            parent_joint: None,
            child_joints: Vec::new(),
            visuals,
            collisions,
            inertial,
        });
        self
    }

    /// Adds a fixed joint.
    pub fn fixed(&mut self, name: &str, parent: &str, child: &str, origin: Origin) -> &mut Self {
        let limits = (0.0, 0.0, false, DynamicLimits::DEFAULT);
        self.moving(name, JointMotion::Fixed, parent, child, origin, [0.0; 3], limits, None)
    }

    /// Adds a joint; `limits` is lower, upper, continuous and speeds; `mimic` is the joint followed, factor, offset.
    pub fn moving(
        &mut self,
        name: &str,
        motion: JointMotion,
        parent: &str,
        child: &str,
        origin: Origin,
        axis: [f64; 3],
        limits: (f64, f64, bool, DynamicLimits),
        mimic: Option<(String, f64, f64)>,
    ) -> &mut Self {
        let (name, parent, child) = (name.into(), parent.into(), child.into());
        self.joints.push(PendingJoint { name, motion, parent, child, origin, axis, limits, mimic });
        self
    }

    /// The robot, or the first reason why this is not one.
    pub fn build(self) -> Result<RobotModel, ModelError> {
        let Self { name, mut links, joints: pending } = self;
        if links.is_empty() {
            return Err(ModelError::NoLinks);
        }
        let mut link_by_name = BTreeMap::new();
        for (index, link) in links.enumerate() {
            if link_by_name.insert(link.name.clone(), index).is_some() {
                return Err(ModelError::Duplicate(format!("link {}", link.name)));
            }
        }
        let find = |joint: &str, link: &str| {
            link_by_name
                .get(link)
                .copied()
                .ok_or_else(|| ModelError::UnknownLink { joint: joint.to_owned(), link: link.to_owned() })
        };

        let drives = assign_drives(&pending)?;
        let mut joints: TypedVec<JointIdx, Joint> = TypedVec::new();
        let mut dofs: TypedVec<DofIdx, Dof> = TypedVec::new();
        for (p, drive) in pending.iter().zip(&drives) {
            let numbers = p.origin.xyz.iter().chain(&p.origin.rpy).chain(&p.axis);
            if !numbers.clone().all(|x| x.is_finite()) {
                return Err(ModelError::NotFinite(format!("joint {}", p.name)));
            }
            let (parent, child) = (find(&p.name, &p.parent)?, find(&p.name, &p.child)?);
            let unit_axis = match Unit::try_new(Vector3::from(p.axis), 1e-12) {
                Some(axis) => axis,
                None if p.motion == JointMotion::Fixed => Vector3::z_axis(),
                None => return Err(ModelError::ZeroAxis(p.name.clone())),
            };
            let index = joints.push(Joint {
                name: p.name.clone(),
                motion: p.motion,
                parent,
                child,
                origin: p.origin,
                axis: p.axis,
                drive: *drive,
                parent_from_joint: p.origin.pose(),
                unit_axis,
            });
            if links[child].parent_joint.replace(index).is_some() {
                return Err(ModelError::TwoParents(p.child.clone()));
            }
            links[parent].child_joints.push(index);
            if let Drive::Dof(_) = drive {
                let (lower, upper, continuous, dynamics) = p.limits;
                dofs.push(Dof { name: p.name.clone(), joint: index, lower, upper, continuous, dynamics });
            }
        }

        let roots: Vec<LinkIdx> = links.indices().filter(|&l| links[l].parent_joint.is_none()).collect();
        let root = match roots[..] {
            [root] => root,
            [] => return Err(ModelError::Loop(links[LinkIdx::new(0)].name.clone())),
            _ => {
                return Err(ModelError::SeveralRoots(roots.iter().map(|&l| links[l].name.clone()).collect()));
            }
        };
        let order = parents_first(&links, &joints, root)?;
        Ok(RobotModel { name, links, joints, dofs, root, order })
    }
}

/// The drive of each joint, in order; degrees of freedom are numbered in joint order.
fn assign_drives(pending: &[PendingJoint]) -> Result<Vec<Drive>, ModelError> {
    let mut by_name = BTreeMap::new();
    for (i, p) in pending.iter().enumerate() {
        if by_name.insert(p.name.as_str(), i).is_some() {
            return Err(ModelError::Duplicate(format!("joint {}", p.name)));
        }
    }
    let mut own_dof = vec![None; pending.len()];
    let mut count = 0;
    for (slot, p) in own_dof.iter_mut().zip(pending) {
        if p.motion != JointMotion::Fixed && p.mimic.is_none() {
            *slot = Some(DofIdx::new(count));
            count += 1;
        }
    }
    let mut drives = Vec::with_capacity(pending.len());
    for (i, p) in pending.iter().enumerate() {
        if p.motion == JointMotion::Fixed {
            drives.push(Drive::Fixed);
            continue;
        }
        // Follow the mimicry to a joint that drives itself; factors multiply, offsets are carried along.
        let (mut at, mut multiplier, mut offset) = (i, 1.0, 0.0);
        let mut steps = 0;
        while let Some((target, m, o)) = &pending[at].mimic {
            let bad = || ModelError::BadMimic { joint: p.name.clone(), target: target.clone() };
            if !m.is_finite() || !o.is_finite() {
                return Err(ModelError::NotFinite(format!("the mimic of joint {}", p.name)));
            }
            offset += multiplier * o;
            multiplier *= m;
            at = *by_name.get(target.as_str()).ok_or_else(bad)?;
            steps += 1;
            if steps > pending.len() || pending[at].motion == JointMotion::Fixed {
                return Err(bad());
            }
        }
        let dof = own_dof[at].expect("a moving joint without mimicry has its own degree of freedom");
        drives.push(if at == i { Drive::Dof(dof) } else { Drive::Mimic { dof, multiplier, offset } });
    }
    Ok(drives)
}

fn parents_first(
    links: &TypedVec<LinkIdx, Link>,
    joints: &TypedVec<JointIdx, Joint>,
    root: LinkIdx,
) -> Result<Vec<JointIdx>, ModelError> {
    let mut order = Vec::with_capacity(joints.len());
    let mut frontier = vec![root];
    let mut next = 0;
    while next < frontier.len() {
        for &joint in &links[frontier[next]].child_joints {
            order.push(joint);
            frontier.push(joints[joint].child);
        }
        next += 1;
    }
    match links.indices().find(|l| !frontier.contains(l)) {
        Some(stray) => Err(ModelError::Loop(links[stray].name.clone())),
        None => Ok(order),
    }
}
