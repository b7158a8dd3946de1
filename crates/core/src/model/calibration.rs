//! What a calibration found, apart from the model.

use std::collections::BTreeMap;

use crate::Pose;
use crate::ids::JointIdx;

/// How one real joint differs from its description.
#[derive(Debug, Clone, PartialEq)]
pub struct JointCorrection {
    /// Added to the commanded value before it moves the joint; radians or metres.
    pub value_offset: f64,
    /// `described_from_actual`: applied after the described `parent_from_joint`.
    pub joint_from_corrected: Pose,
}

impl Default for JointCorrection {
    fn default() -> Self {
        Self { value_offset: 0.0, joint_from_corrected: Pose::identity() }
    }
}

/// Corrections to a robot model. The empty one is the model as described.
///
/// The model itself is never changed: forward kinematics, inverse kinematics and artefact keys see model and
/// calibration side by side, so that a new calibration rebuilds only what reads it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Calibration {
    joints: BTreeMap<JointIdx, JointCorrection>,
}

impl Calibration {
    /// The model as described.
    pub fn none() -> Self {
        Self::default()
    }

    /// Sets the correction of a joint.
    pub fn correct(&mut self, joint: JointIdx, correction: JointCorrection) {
        self.joints.insert(joint, correction);
    }

    /// The correction of a joint, if it has one.
    pub fn joint(&self, joint: JointIdx) -> Option<&JointCorrection> {
        self.joints.get(&joint)
    }

    /// Whether nothing is corrected.
    pub fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }
}
