//! A serial chain between two links: what an inverse-kinematics solver is made for.

use nalgebra::{Unit, Vector3};
use thiserror::Error;

use super::{Drive, JointMotion, Kinematics, Origin};
use crate::Pose;
use crate::ids::{DofIdx, JointIdx, LinkIdx};

/// How a chain joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ChainMotion {
    /// Turns about its axis; radians.
    Revolute,
    /// Slides along its axis; metres.
    Prismatic,
}

/// One moving joint of a chain: fixed joints before it are folded into `previous_from_joint`.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainJoint {
    /// Name of the joint.
    pub name: String,
    /// How it moves.
    pub motion: ChainMotion,
    /// Pose of the joint frame in the frame after the previous moving joint (or the base), at value zero.
    pub previous_from_joint: Pose,
    /// Unit axis in the joint frame.
    pub axis: Unit<Vector3<f64>>,
    /// Which variable gives it its value.
    pub variable: usize,
    /// value = multiplier * variable + offset; 1 and 0 unless the joint mimics another of the chain.
    pub multiplier: f64,
    /// See `multiplier`.
    pub offset: f64,
}

/// An unknown of a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainVariable {
    /// Name of the joint it drives directly.
    pub name: String,
    /// The degree of freedom of the robot.
    pub dof: DofIdx,
    /// Smallest value; minus infinity when continuous.
    pub lower: f64,
    /// Largest value; infinity when continuous.
    pub upper: f64,
}

/// A fixed or moving joint as written in the description: what an artefact key hashes.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenJoint {
    /// How it moves.
    pub motion: JointMotion,
    /// Its origin as written.
    pub origin: Origin,
    /// Its axis as written.
    pub axis: [f64; 3],
}

/// Why two links give no chain.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum ChainError {
    /// The tip is not below the base.
    #[error("link {tip} is not below link {base}")]
    NotBelow {
        /// The base link.
        base: String,
        /// The tip link.
        tip: String,
    },
    /// Nothing moves between the two.
    #[error("no joint moves between {base} and {tip}")]
    NoJoints {
        /// The base link.
        base: String,
        /// The tip link.
        tip: String,
    },
    /// A joint follows one that is outside of the chain.
    #[error("joint {joint} mimics {target}, which is outside of the chain")]
    MimicOutside {
        /// The follower.
        joint: String,
        /// The joint followed.
        target: String,
    },
}

/// A serial chain: `base_from_tip = product of (previous_from_joint * motion(axis, value)) * last_from_tip`.
#[derive(Debug, Clone, PartialEq)]
pub struct SerialChain {
    /// Base and tip link names, for messages.
    pub name: String,
    /// Moving joints, base to tip.
    pub joints: Vec<ChainJoint>,
    /// Unknowns, in the order in which their joints come.
    pub variables: Vec<ChainVariable>,
    /// Pose of the tip in the frame after the last moving joint.
    pub last_from_tip: Pose,
}

impl SerialChain {
    /// The chain from link `base` to link `tip`, with the calibration of `kinematics` applied.
    pub fn between(kinematics: &Kinematics, base: LinkIdx, tip: LinkIdx) -> Result<Self, ChainError> {
        let model = kinematics.model();
        let names = || (model.links()[base].name.clone(), model.links()[tip].name.clone());
        let path = model.joints_between(base, tip).ok_or_else(|| {
            let (base, tip) = names();
            ChainError::NotBelow { base, tip }
        })?;
        let own: Vec<(DofIdx, JointIdx)> = path
            .iter()
            .filter_map(|&j| match model.joints()[j].drive {
                Drive::Dof(dof) => Some((dof, j)),
                _ => None,
            })
            .collect();
        let variables: Vec<ChainVariable> = own
            .iter()
            .map(|&(dof, _)| {
                let d = &model.dofs()[dof];
                ChainVariable { name: d.name.clone(), dof, lower: d.lower, upper: d.upper }
            })
            .collect();
        let mut joints = Vec::new();
        let mut pending = Pose::identity();
        for &j in &path {
            let joint = &model.joints()[j];
            let correction = kinematics.calibration().joint(j);
            pending *= joint.parent_from_joint();
            if let Some(c) = correction {
                pending *= c.joint_from_corrected;
            }
            let (dof, multiplier, mut offset) = match joint.drive {
                Drive::Fixed => continue,
                Drive::Dof(dof) => (dof, 1.0, 0.0),
                Drive::Mimic { dof, multiplier, offset } => (dof, multiplier, offset),
            };
            offset += correction.map_or(0.0, |c| c.value_offset);
            let variable = own.iter().position(|&(d, _)| d == dof).ok_or_else(|| {
                ChainError::MimicOutside { joint: joint.name.clone(), target: model.dofs()[dof].name.clone() }
            })?;
            let motion = match joint.motion {
                JointMotion::Prismatic => ChainMotion::Prismatic,
                _ => ChainMotion::Revolute,
            };
            joints.push(ChainJoint {
                name: joint.name.clone(),
                motion,
                previous_from_joint: std::mem::replace(&mut pending, Pose::identity()),
                axis: *joint.unit_axis(),
                variable,
                multiplier,
                offset,
            });
        }
        let (base, tip) = names();
        if joints.is_empty() {
            return Err(ChainError::NoJoints { base, tip });
        }
        Ok(Self { name: format!("{base} to {tip}"), joints, variables, last_from_tip: pending })
    }

    /// The joints between two links as written, fixed ones included: the part of a key that names a chain.
    pub fn written(kinematics: &Kinematics, base: LinkIdx, tip: LinkIdx) -> Option<Vec<WrittenJoint>> {
        let model = kinematics.model();
        let path = model.joints_between(base, tip)?;
        let written = |&j: &JointIdx| {
            let joint = &model.joints()[j];
            WrittenJoint { motion: joint.motion, origin: joint.origin, axis: joint.axis }
        };
        Some(path.iter().map(written).collect())
    }

    /// `base_from_tip` at these variable values, radians or metres.
    pub fn forward(&self, variables: &[f64]) -> Pose {
        let mut pose = Pose::identity();
        for joint in &self.joints {
            let value = joint.multiplier * variables[joint.variable] + joint.offset;
            pose *= joint.previous_from_joint;
            match joint.motion {
                ChainMotion::Revolute => {
                    pose.rotation *= nalgebra::UnitQuaternion::from_axis_angle(&joint.axis, value);
                }
                ChainMotion::Prismatic => {
                    pose.translation.vector += pose.rotation * (joint.axis.into_inner() * value);
                }
            }
        }
        pose * self.last_from_tip
    }
}
