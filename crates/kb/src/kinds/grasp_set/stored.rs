//! Grasps as stored: plain numbers, metres and radians.

use nalgebra::{Point3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_planning::grasp::{Contact, Grasp, Steadiness};
use serde::{Deserialize, Serialize};

use crate::kind::DecodeError;

/// A pose: position, and rotation as x, y, z, w.
#[derive(Serialize, Deserialize)]
pub(super) struct StoredPose {
    position: [f64; 3],
    rotation: [f64; 4],
}

impl StoredPose {
    /// The stored form of a pose.
    pub(super) fn of(pose: &Pose) -> Self {
        Self { position: pose.translation.vector.into(), rotation: pose.rotation.coords.into() }
    }

    /// The pose of a stored form.
    pub(super) fn pose(&self) -> Result<Pose, DecodeError> {
        let rotation = UnitQuaternion::new_unchecked(Quaternion::from(self.rotation));
        if !rotation.norm().is_finite() || (rotation.norm() - 1.0).abs() > 1e-9 {
            return Err(DecodeError::new("a rotation is not of unit length"));
        }
        // Kept as stored: normalising again could change the last bit.
        Ok(Pose::from_parts(Translation3::from(point(self.position)?), rotation))
    }
}

/// A grasp.
#[derive(Serialize, Deserialize)]
pub(super) struct Stored {
    preshape: u32,
    tool: StoredPose,
    approach: [f64; 3],
    standoff: f64,
    closed: Vec<f64>,
    contacts: Vec<[f64; 6]>,
    epsilon: f64,
    volume: Option<f64>,
    steadiness: Option<[f64; 2]>,
    score: f64,
}

impl Stored {
    /// The stored form of a grasp.
    pub(super) fn of(grasp: &Grasp) -> Self {
        let contact = |c: &Contact| {
            let (p, n) = (c.point_in_object, c.normal_in_object);
            [p.x, p.y, p.z, n.x, n.y, n.z]
        };
        Self {
            preshape: grasp.preshape as u32,
            tool: StoredPose::of(&grasp.object_from_tool),
            approach: grasp.approach_in_object.into_inner().into(),
            standoff: grasp.standoff,
            closed: grasp.closed.clone(),
            contacts: grasp.contacts.iter().map(contact).collect(),
            epsilon: grasp.epsilon,
            volume: grasp.volume,
            steadiness: grasp.steadiness.map(|s| [s.deviation, s.held]),
            score: grasp.score,
        }
    }

    /// The grasp of a stored form.
    pub(super) fn grasp(self) -> Result<Grasp, DecodeError> {
        let contacts: Result<_, _> = self
            .contacts
            .iter()
            .map(|&[x, y, z, i, j, k]| {
                let normal_in_object = direction([i, j, k])?;
                Ok(Contact { point_in_object: point([x, y, z])?, normal_in_object })
            })
            .collect();
        let numbers = [self.standoff, self.epsilon, self.score];
        let numbers = numbers.iter().chain(&self.closed).chain(&self.volume);
        if !numbers.chain(self.steadiness.iter().flatten()).all(|x| x.is_finite()) {
            return Err(DecodeError::new("a number is not finite"));
        }
        Ok(Grasp {
            preshape: self.preshape as usize,
            object_from_tool: self.tool.pose()?,
            approach_in_object: direction(self.approach)?,
            standoff: self.standoff,
            closed: self.closed,
            contacts: contacts?,
            epsilon: self.epsilon,
            volume: self.volume,
            steadiness: self.steadiness.map(|[deviation, held]| Steadiness { deviation, held }),
            score: self.score,
        })
    }
}

fn point(p: [f64; 3]) -> Result<Point3<f64>, DecodeError> {
    if p.iter().all(|x| x.is_finite()) {
        Ok(p.into())
    } else {
        Err(DecodeError::new("a point is not finite"))
    }
}

fn direction(d: [f64; 3]) -> Result<Unit<Vector3<f64>>, DecodeError> {
    let v = Vector3::from(d);
    // Kept as stored: normalising again could change the last bit.
    if (v.norm() - 1.0).abs() < 1e-9 {
        Ok(Unit::new_unchecked(v))
    } else {
        Err(DecodeError::new("a direction is not of unit length"))
    }
}
