//! The arms of the comparison, from published dimensions.
//!
//! Each is given by axis and point of every joint at zero, in the base frame: this is what `ik-geo` takes too, so that both solve
//! the same poses.

use nalgebra::{Translation3, Unit, UnitQuaternion, Vector3};
use robotc_core::ids::Idx;
use robotc_core::model::{ChainJoint, ChainMotion, ChainVariable, SerialChain};
use robotc_core::{DofIdx, Pose};

/// Axis and point of each joint at zero, then the point of the tip, whose frame is parallel to the base there.
pub struct Arm {
    /// Name, also of the generated files.
    pub name: &'static str,
    /// Direction and point of each axis, base to tip.
    pub axes: &'static [([f64; 3], [f64; 3])],
    /// The tip.
    pub tip: [f64; 3],
}

const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];
const MINUS_X: [f64; 3] = [-1.0, 0.0, 0.0];
const MINUS_Y: [f64; 3] = [0.0, -1.0, 0.0];
const MINUS_Z: [f64; 3] = [0.0, 0.0, -1.0];

/// KUKA KR 6 R900: spherical wrist, axes 2 and 3 parallel.
pub const KR6: Arm = Arm {
    name: "kr6",
    axes: &[
        (MINUS_Z, [0.0, 0.0, 0.4]),
        (Y, [0.025, 0.0, 0.4]),
        (Y, [0.48, 0.0, 0.4]),
        (MINUS_X, [0.9, 0.0, 0.425]),
        (Y, [0.9, 0.0, 0.425]),
        (MINUS_X, [0.9, 0.0, 0.425]),
    ],
    tip: [0.99, 0.0, 0.425],
};

/// Universal Robots UR5e: axes 2, 3 and 4 parallel.
pub const UR5E: Arm = Arm {
    name: "ur5e",
    axes: &[
        (Z, [0.0, 0.0, 0.1625]),
        (Y, [0.0, 0.0, 0.1625]),
        (Y, [0.425, 0.0, 0.1625]),
        (Y, [0.8172, 0.0, 0.1625]),
        (MINUS_Z, [0.8172, 0.1333, 0.1625]),
        (Y, [0.8172, 0.1333, 0.0628]),
    ],
    tip: [0.8172, 0.2329, 0.0628],
};

/// Franka Panda: spherical shoulder, offset elbow and wrist.
pub const PANDA: Arm = Arm {
    name: "panda",
    axes: &[
        (Z, [0.0, 0.0, 0.333]),
        (Y, [0.0, 0.0, 0.333]),
        (Z, [0.0, 0.0, 0.649]),
        (MINUS_Y, [0.0825, 0.0, 0.649]),
        (Z, [0.0, 0.0, 1.033]),
        (MINUS_Y, [0.0, 0.0, 1.033]),
        (MINUS_Z, [0.088, 0.0, 1.033]),
    ],
    tip: [0.088, 0.0, 0.926],
};

/// KUKA LBR iiwa 7 R800: spherical shoulder and wrist.
pub const IIWA: Arm = Arm {
    name: "iiwa",
    axes: &[
        (Z, [0.0, 0.0, 0.34]),
        (Y, [0.0, 0.0, 0.34]),
        (Z, [0.0, 0.0, 0.55]),
        (MINUS_Y, [0.0, 0.0, 0.74]),
        (Z, [0.0, 0.0, 0.95]),
        (Y, [0.0, 0.0, 1.14]),
        (Z, [0.0, 0.0, 1.14]),
    ],
    tip: [0.0, 0.0, 1.266],
};

/// FANUC CRX-10iA: no three axes that meet or are parallel.
pub const CRX: Arm = Arm {
    name: "crx10ia",
    axes: &[
        (Z, [0.0, 0.0, 0.0]),
        (Y, [0.0, 0.0, 0.0]),
        (MINUS_Y, [0.0, 0.0, 0.54]),
        (MINUS_X, [0.0, 0.0, 0.54]),
        (MINUS_Y, [0.54, -0.15, 0.54]),
        (MINUS_X, [0.54, -0.15, 0.54]),
    ],
    tip: [0.7, -0.15, 0.54],
};

/// UFACTORY xArm 6: no triple at all.
pub const XARM6: Arm = Arm {
    name: "xarm6",
    axes: &[
        (Z, [0.0, 0.0, 0.267]),
        (Y, [0.0, 0.0, 0.267]),
        (Y, [0.053, 0.0, 0.5515]),
        (MINUS_Z, [0.1305, 0.0, 0.209]),
        (Y, [0.1305, 0.0, 0.209]),
        (MINUS_Z, [0.2065, 0.0, 0.112]),
    ],
    tip: [0.2065, 0.0, 0.112],
};

/// Arms whose sources are generated.
pub const ARMS: [&Arm; 6] = [&KR6, &UR5E, &PANDA, &IIWA, &CRX, &XARM6];

impl Arm {
    /// The arm as the inverse-kinematics compiler takes it.
    pub fn chain(&self) -> SerialChain {
        let mut at = Vector3::zeros();
        let mut step = |point: &[f64; 3]| {
            let point = Vector3::from(*point);
            let step = point - at;
            at = point;
            Translation3::from(step)
        };
        let joints = self.axes.iter().enumerate().map(|(i, (axis, point))| ChainJoint {
            name: format!("joint_{}", i + 1),
            motion: ChainMotion::Revolute,
            previous_from_joint: Pose::from_parts(step(point), UnitQuaternion::identity()),
            axis: Unit::new_normalize(Vector3::from(*axis)),
            variable: i,
            multiplier: 1.0,
            offset: 0.0,
        });
        let joints: Vec<ChainJoint> = joints.collect();
        let variables = joints.iter().enumerate().map(|(i, joint)| ChainVariable {
            name: joint.name.clone(),
            dof: DofIdx::new(i),
            lower: -3.1,
            upper: 3.1,
        });
        let variables = variables.collect();
        let last_from_tip = Pose::from_parts(step(&self.tip), UnitQuaternion::identity());
        SerialChain { name: self.name.into(), joints, variables, last_from_tip }
    }
}
