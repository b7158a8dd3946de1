//! What a robot is made of: links, joints, shapes, mass properties and limits.

use std::sync::Arc;

use nalgebra::{Translation3, Unit, UnitQuaternion, Vector3};

use super::TriMesh;
use crate::Pose;
use crate::geom::{HeightField, PointCloud};
use crate::ids::{DofIdx, JointIdx, LinkIdx};

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
    /// Balls about measured points; for obstacles only.
    Cloud {
        /// The points, shared by all that refer to the same file.
        cloud: Arc<PointCloud>,
        /// The reference as written, or empty.
        uri: String,
    },
    /// Measured heights on a grid, solid down to a floor; for obstacles only. Its origin is the first sample.
    HeightField {
        /// The heights, shared by all that refer to the same file.
        field: Arc<HeightField>,
        /// The reference as written, or empty.
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
    pub(super) parent_from_joint: Pose,
    pub(super) unit_axis: Unit<Vector3<f64>>,
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
