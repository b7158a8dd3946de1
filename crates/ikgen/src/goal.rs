//! What a solver is asked for: the whole pose of the tip, or only some of it.
//!
//! A goal type is the freedom that it leaves, as joints that do not exist, added before the base or after the tip. With them the
//! loop closes with a full pose again, so that every strategy, the polish and all back ends serve every type; the solver returns the
//! values of the joints that do exist. (The parameterisations of Diankov's thesis, section 4.1, under the names of OpenRAVE.)

use nalgebra::{Translation3, Unit, UnitQuaternion, Vector3};
use robotc_core::ids::Idx;
use robotc_core::model::{ChainJoint, ChainMotion, ChainVariable, SerialChain};
use robotc_core::{DofIdx, Pose};

/// Which part of the pose of the tip a solver is asked for.
///
/// Every goal is given as a pose `base_from_tip`; what a type does not use of it may be anything. *Direction* is the z axis of the tip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum GoalType {
    /// The whole pose.
    #[default]
    Transform6D,
    /// The rotation.
    Rotation3D,
    /// The position.
    Translation3D,
    /// The direction.
    Direction3D,
    /// The line through the position along the direction, and the sense of the direction.
    Ray4D,
    /// The direction goes through the position, which is in front of the tip.
    Lookat3D,
    /// Position and direction.
    TranslationDirection5D,
    /// The x and y of the position.
    TranslationXY2D,
    /// The x and y of the position and the x axis of the tip: for arms that keep it at right angles to the base's z axis.
    TranslationXYOrientation3D,
    /// A point given in the frame of the tip comes to the position. The three last given values are the point.
    TranslationLocalGlobal6D,
    /// The position, and the angle of the direction to the x axis of the pose. The last given value is the angle, 0 to pi.
    TranslationXAxisAngle4D,
    /// The same with the y axis.
    TranslationYAxisAngle4D,
    /// The same with the z axis.
    TranslationZAxisAngle4D,
    /// Position and direction, for arms of four joints that keep the direction at right angles to the base's z axis.
    TranslationXAxisAngleZNorm4D,
    /// The same for those that keep it at right angles to the base's x axis.
    TranslationYAxisAngleXNorm4D,
    /// The same for those that keep it at right angles to the base's y axis.
    TranslationZAxisAngleYNorm4D,
}

use GoalType::*;

/// A joint that a goal type adds.
pub(crate) struct Added {
    name: &'static str,
    motion: ChainMotion,
    place: Place,
    axis: Vector3<f64>,
    multiplier: f64,
    offset: f64,
    /// Whether the caller gives its value.
    given: bool,
    /// Smallest value of a solution.
    lower: f64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Base,
    Tip,
}

fn added(name: &'static str, motion: ChainMotion, place: Place, axis: Vector3<f64>) -> Added {
    Added { name, motion, place, axis, multiplier: 1.0, offset: 0.0, given: false, lower: f64::NEG_INFINITY }
}

fn turn(name: &'static str, axis: Vector3<f64>) -> Added {
    added(name, ChainMotion::Revolute, Place::Tip, axis)
}

fn slide(name: &'static str, place: Place, axis: Vector3<f64>) -> Added {
    added(name, ChainMotion::Prismatic, place, axis)
}

impl GoalType {
    /// All types.
    pub const ALL: [GoalType; 16] = [
        Transform6D,
        Rotation3D,
        Translation3D,
        Direction3D,
        Ray4D,
        Lookat3D,
        TranslationDirection5D,
        TranslationXY2D,
        TranslationXYOrientation3D,
        TranslationLocalGlobal6D,
        TranslationXAxisAngle4D,
        TranslationYAxisAngle4D,
        TranslationZAxisAngle4D,
        TranslationXAxisAngleZNorm4D,
        TranslationYAxisAngleXNorm4D,
        TranslationZAxisAngleYNorm4D,
    ];

    /// Its name, in lower case as OpenRAVE writes it on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Transform6D => "transform6d",
            Rotation3D => "rotation3d",
            Translation3D => "translation3d",
            Direction3D => "direction3d",
            Ray4D => "ray4d",
            Lookat3D => "lookat3d",
            TranslationDirection5D => "translationdirection5d",
            TranslationXY2D => "translationxy2d",
            TranslationXYOrientation3D => "translationxyorientation3d",
            TranslationLocalGlobal6D => "translationlocalglobal6d",
            TranslationXAxisAngle4D => "translationxaxisangle4d",
            TranslationYAxisAngle4D => "translationyaxisangle4d",
            TranslationZAxisAngle4D => "translationzaxisangle4d",
            TranslationXAxisAngleZNorm4D => "translationxaxisangleznorm4d",
            TranslationYAxisAngleXNorm4D => "translationyaxisanglexnorm4d",
            TranslationZAxisAngleYNorm4D => "translationzaxisangleynorm4d",
        }
    }

    /// The type of this name, whatever its capitals.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|t| t.name().eq_ignore_ascii_case(name))
    }

    /// What it takes of a pose, in words.
    pub fn meaning(self) -> &'static str {
        match self {
            Transform6D => "the whole pose",
            Rotation3D => "the rotation",
            Translation3D => "the position",
            Direction3D => "the z axis of the tip",
            Ray4D => "the line through the position along the z axis of the tip, and its sense",
            Lookat3D => "the tip's z axis goes through the position, which is in front of it",
            TranslationDirection5D => "the position and the z axis of the tip",
            TranslationXY2D => "the x and y of the position",
            TranslationXYOrientation3D => "the x and y of the position and the x axis of the tip",
            TranslationLocalGlobal6D => {
                "the position, where a point given in the tip's frame comes (the three last given values)"
            }
            TranslationXAxisAngle4D => {
                "the position, and the angle between the tip's z axis and the pose's x axis (the last given value)"
            }
            TranslationYAxisAngle4D => {
                "the position, and the angle between the tip's z axis and the pose's y axis (the last given value)"
            }
            TranslationZAxisAngle4D => {
                "the position, and the angle between the tip's z axis and the pose's z axis (the last given value)"
            }
            TranslationXAxisAngleZNorm4D | TranslationYAxisAngleXNorm4D | TranslationZAxisAngleYNorm4D => {
                "the position and the z axis of the tip"
            }
        }
    }

    /// The joints that stand for what it leaves open.
    pub(crate) fn added(self) -> Vec<Added> {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let spin = || vec![turn("spin", z)];
        let any_turn = || vec![turn("yaw", z), turn("pitch", y), turn("roll", x)];
        let gantry = |axes: &[Vector3<f64>]| -> Vec<Added> {
            axes.iter()
                .zip(["along x", "along y", "along z"])
                .map(|(a, n)| slide(n, Place::Base, *a))
                .collect()
        };
        let lift = || vec![slide("lift", Place::Base, z)];
        let joined = |mut first: Vec<Added>, second: Vec<Added>| {
            first.extend(second);
            first
        };
        // The angle between direction and axis is one of three turns that lead from the tip's frame to the pose's.
        let cone = |side: Vector3<f64>, multiplier: f64, offset: f64, axis: Vector3<f64>| {
            let angle = Added { multiplier, offset, given: true, ..turn("angle", side) };
            vec![turn("spin", z), angle, turn("swing", axis)]
        };
        let quarter = std::f64::consts::FRAC_PI_2;
        match self {
            Transform6D => Vec::new(),
            Rotation3D => gantry(&[x, y, z]),
            Translation3D => any_turn(),
            Direction3D => joined(gantry(&[x, y, z]), spin()),
            Ray4D => vec![slide("along", Place::Tip, z), turn("spin", z)],
            Lookat3D => {
                let sight = Added { lower: 0.0, ..slide("distance", Place::Tip, z) };
                joined(vec![sight], any_turn())
            }
            TranslationDirection5D
            | TranslationXAxisAngleZNorm4D
            | TranslationYAxisAngleXNorm4D
            | TranslationZAxisAngleYNorm4D => spin(),
            TranslationXY2D => joined(lift(), any_turn()),
            TranslationXYOrientation3D => joined(lift(), vec![turn("spin", x)]),
            TranslationLocalGlobal6D => {
                let point = [("local x", x), ("local y", y), ("local z", z)];
                let point = point.map(|(name, axis)| Added { given: true, ..slide(name, Place::Tip, axis) });
                joined(point.into(), any_turn())
            }
            TranslationXAxisAngle4D => cone(y, 1.0, -quarter, x),
            TranslationYAxisAngle4D => cone(x, -1.0, quarter, y),
            TranslationZAxisAngle4D => cone(x, 1.0, 0.0, z),
        }
    }

    /// Number of joints that it adds to a chain.
    pub fn added_joints(self) -> usize {
        self.added().len()
    }

    /// Number of values that are given besides those of free joints.
    pub fn given(self) -> usize {
        self.added().iter().filter(|a| a.given).count()
    }

    /// Number of joints that a chain needs at least to reach all goals of this type.
    pub fn constraints(self) -> usize {
        // What the arms that these are for cannot leave anyway.
        let kept = match self {
            TranslationXYOrientation3D
            | TranslationXAxisAngleZNorm4D
            | TranslationYAxisAngleXNorm4D
            | TranslationZAxisAngleYNorm4D => 1,
            _ => 0,
        };
        6 - (self.added_joints() - self.given()) - kept
    }

    /// The chain with the added joints, whose variables come after its own.
    pub fn extended(self, chain: &SerialChain) -> SerialChain {
        let mut longer = chain.clone();
        let (mut before, mut after) = (Vec::new(), Vec::new());
        for (k, added) in self.added().into_iter().enumerate() {
            let variable = chain.variables.len() + k;
            // Of the joints after the tip the first one carries it.
            let first_of_tip = added.place == Place::Tip && after.is_empty();
            let joint = ChainJoint {
                name: added.name.into(),
                motion: added.motion,
                previous_from_joint: if first_of_tip { chain.last_from_tip } else { Pose::identity() },
                axis: Unit::new_unchecked(added.axis),
                variable,
                multiplier: added.multiplier,
                offset: added.offset,
            };
            longer.variables.push(ChainVariable {
                name: added.name.into(),
                dof: DofIdx::new(variable),
                lower: added.lower,
                upper: f64::INFINITY,
            });
            if added.place == Place::Base { before.push(joint) } else { after.push(joint) }
        }
        if !after.is_empty() {
            longer.last_from_tip = Pose::identity();
        }
        longer.joints.splice(0..0, before);
        longer.joints.extend(after);
        longer
    }

    /// Variables of the extended chain that the caller gives, besides free joints; `joints` is the number of the chain's own.
    #[cfg(feature = "generate")]
    pub(crate) fn given_variables(self, joints: usize) -> Vec<usize> {
        let given = self.added().into_iter().enumerate().filter(|(_, a)| a.given);
        given.map(|(k, _)| joints + k).collect()
    }

    /// Smallest values that the added joints may have in a solution.
    pub(crate) fn least(self) -> Vec<f64> {
        self.added().iter().map(|a| a.lower).collect()
    }

    /// Values of the added joints at which they turn nothing.
    pub fn at_rest(self) -> Vec<f64> {
        self.added().iter().map(|a| -a.offset / a.multiplier).collect()
    }
}

/// A pose at `position` whose z axis is along `direction`; nothing else is said of its rotation. What most types are asked with.
pub fn pose_along(position: &Vector3<f64>, direction: &Vector3<f64>) -> Pose {
    let rotation = UnitQuaternion::rotation_between(&Vector3::z(), direction)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    Pose::from_parts(Translation3::from(*position), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for goal in GoalType::ALL {
            assert_eq!(GoalType::from_name(goal.name()), Some(goal));
            assert_eq!(GoalType::from_name(&format!("{goal:?}")), Some(goal));
            assert!(!goal.meaning().is_empty());
        }
        assert_eq!(GoalType::from_name("transform"), None);
    }

    #[test]
    fn each_type_fixes_as_much_as_its_name_says() {
        let fixes = |goal: GoalType| goal.constraints();
        assert_eq!(GoalType::ALL.map(fixes), [6, 3, 3, 2, 4, 2, 5, 2, 3, 3, 4, 4, 4, 4, 4, 4]);
    }
}
