//! Links, joints, geometry and limits of a robot.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Translation3, Unit, UnitQuaternion, Vector3};
use thiserror::Error;

use super::TriMesh;
use crate::Pose;
use crate::ids::{DofIdx, Idx, JointIdx, LinkIdx, TypedVec};

/// A rigid transform as a description file writes it: translation, then fixed-axis roll, pitch, yaw.
///
/// Kept as written because artefact keys hash these numbers, never a matrix made of them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Origin {
    /// Translation, metres.
    pub xyz: [f64; 3],
    /// Roll, pitch and yaw about fixed x, y, z; radians.
    pub rpy: [f64; 3],
}

impl Origin {
    /// The transform.
    pub fn pose(&self) -> Pose {
        let [roll, pitch, yaw] = self.rpy;
        Pose::from_parts(
            Translation3::new(self.xyz[0], self.xyz[1], self.xyz[2]),
            UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        )
    }
}

/// The shape of a visual or collision element, in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Box with full edge lengths, centred.
    Box {
        /// Full edge lengths along x, y, z.
        size: [f64; 3],
    },
    /// Cylinder along z, centred.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Full length.
        length: f64,
    },
    /// Cylinder along z with half spheres at its ends, centred; `length` without the caps.
    Capsule {
        /// Radius of cylinder and caps.
        radius: f64,
        /// Length of the cylindrical part.
        length: f64,
    },
    /// Sphere, centred.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// Triangle mesh in metres: file units, up axis and scale are already applied.
    Mesh {
        /// The triangles, shared by all that refer to the same file and scale.
        mesh: Arc<TriMesh>,
        /// The reference as written in the description.
        uri: String,
    },
}

/// A visual or collision element of a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Where the shape sits in the link, as written.
    pub origin: Origin,
    /// The shape.
    pub shape: Shape,
    /// Red, green, blue, opacity in 0..=1, when the description gives a colour.
    pub colour: Option<[f32; 4]>,
}

/// Mass properties of a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertial {
    /// Centre of mass and inertia axes in the link frame.
    pub origin: Origin,
    /// Kilograms.
    pub mass: f64,
    /// ixx, ixy, ixz, iyy, iyz, izz in kg m^2.
    pub inertia: [f64; 6],
}

/// A rigid part of a robot.
#[derive(Debug, Clone)]
pub struct Link {
    /// Unique name.
    pub name: String,
    /// The joint that moves this link; `None` for the root.
    pub parent_joint: Option<JointIdx>,
    /// Joints that hang on this link.
    pub child_joints: Vec<JointIdx>,
    /// What it looks like.
    pub visuals: Vec<Geometry>,
    /// What it touches with.
    pub collisions: Vec<Geometry>,
    /// Mass properties, if given.
    pub inertial: Option<Inertial>,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JointMotion {
    /// Not at all.
    Fixed,
    /// Turns about its axis; radians.
    Revolute,
    /// Slides along its axis; metres.
    Prismatic,
}

/// What gives a joint its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// Nothing: the joint is fixed.
    Fixed,
    /// Its own degree of freedom.
    Dof(DofIdx),
    /// Follows another: value = multiplier * value(dof) + offset.
    Mimic {
        /// The degree of freedom followed.
        dof: DofIdx,
        /// Factor.
        multiplier: f64,
        /// Added after the factor.
        offset: f64,
    },
}

/// A joint between two links.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Unique name.
    pub name: String,
    /// How it moves.
    pub motion: JointMotion,
    /// The link it hangs on.
    pub parent: LinkIdx,
    /// The link it moves.
    pub child: LinkIdx,
    /// `parent_from_joint` at value zero, as written.
    pub origin: Origin,
    /// Axis in the joint frame as written (not normalised); unused when fixed.
    pub axis: [f64; 3],
    /// What gives it its value.
    pub drive: Drive,
    parent_from_joint: Pose,
    unit_axis: Unit<Vector3<f64>>,
}

impl Joint {
    /// `parent_from_child` at this joint value (radians or metres).
    pub fn parent_from_child(&self, value: f64) -> Pose {
        match self.motion {
            JointMotion::Fixed => self.parent_from_joint,
            JointMotion::Revolute => {
                self.parent_from_joint * UnitQuaternion::from_axis_angle(&self.unit_axis, value)
            }
            JointMotion::Prismatic => {
                self.parent_from_joint * Translation3::from(self.unit_axis.into_inner() * value)
            }
        }
    }

    /// `parent_from_joint`: the pose of the joint frame in its parent link at value zero.
    pub fn parent_from_joint(&self) -> &Pose {
        &self.parent_from_joint
    }

    /// The unit axis in the joint frame, which turns with neither its own value nor the child.
    pub fn unit_axis(&self) -> &Unit<Vector3<f64>> {
        &self.unit_axis
    }
}

/// How fast a degree of freedom may go, and whether a description said so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DynamicLimits {
    /// rad/s or m/s.
    pub velocity: f64,
    /// rad/s^2 or m/s^2.
    pub acceleration: f64,
    /// rad/s^3 or m/s^3.
    pub jerk: f64,
    /// Whether velocity, acceleration and jerk were given (`false`: a default of this program).
    pub given: [bool; 3],
}

impl DynamicLimits {
    /// Used where nothing is given: 1 rad/s (m/s) in half a second, that acceleration in a tenth of a second.
    pub const DEFAULT: Self = Self { velocity: 1.0, acceleration: 2.0, jerk: 20.0, given: [false; 3] };
}

/// An independently driven joint value.
#[derive(Debug, Clone, PartialEq)]
pub struct Dof {
    /// Name of the joint it drives.
    pub name: String,
    /// The joint it drives.
    pub joint: JointIdx,
    /// Smallest value, radians or metres; minus infinity for continuous joints.
    pub lower: f64,
    /// Largest value; infinity for continuous joints.
    pub upper: f64,
    /// Whether values 2 pi apart are the same position.
    pub continuous: bool,
    /// Speed limits.
    pub dynamics: DynamicLimits,
}

impl Dof {
    /// Bounds for sampling: the limits, or (-pi, pi) when continuous.
    pub fn sampling_range(&self) -> (f64, f64) {
        if self.continuous { (-std::f64::consts::PI, std::f64::consts::PI) } else { (self.lower, self.upper) }
    }
}

/// A robot: a tree of links and joints. Immutable; share it in an [`Arc`].
#[derive(Debug, Clone)]
pub struct RobotModel {
    name: String,
    links: TypedVec<LinkIdx, Link>,
    joints: TypedVec<JointIdx, Joint>,
    pub(super) dofs: TypedVec<DofIdx, Dof>,
    root: LinkIdx,
    /// Joints ordered parents first.
    order: Vec<JointIdx>,
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
