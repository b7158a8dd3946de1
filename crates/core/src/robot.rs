//! A robot as the compiler sees it: the model plus what each part is for.

use std::sync::Arc;

use nalgebra::{Unit, Vector3};

use crate::Pose;
use crate::ids::{DofIdx, LinkIdx};
use crate::model::RobotModel;

/// A checked robot specification: model and annotations agree.
#[derive(Debug, Clone)]
pub struct Robot {
    /// Links, joints, limits.
    pub model: Arc<RobotModel>,
    /// Serial manipulators, in specification order; at least one.
    pub arms: Vec<Arm>,
    /// Grippers, in specification order.
    pub grippers: Vec<Gripper>,
    /// Cameras on the robot, in specification order.
    pub cameras: Vec<Camera>,
    /// How the robot stands or moves.
    pub base: Base,
    /// Link pairs that are never tested against each other; lower index first, sorted.
    pub ignored_pairs: Vec<(LinkIdx, LinkIdx)>,
    /// Weights of the configuration metric given by hand; they override the computed ones.
    pub weights: Vec<(DofIdx, f64)>,
}

impl Robot {
    /// The gripper whose palm a camera is fixed to, if it is to one.
    pub fn gripper_of_camera(&self, camera: &Camera) -> Option<&Gripper> {
        let rigid = self.model.rigid_group(camera.link);
        self.grippers.iter().find(|gripper| rigid.contains(&gripper.palm))
    }
}

/// A serial manipulator.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// Unique among arms.
    pub name: String,
    /// Where its chain starts.
    pub base: LinkIdx,
    /// Where its chain ends; tool frames are given relative to this link.
    pub tip: LinkIdx,
    /// The degrees of freedom of the chain, base to tip.
    pub dofs: Vec<DofIdx>,
    /// Position in [`Robot::grippers`] of the gripper it carries.
    pub gripper: Option<usize>,
    /// Degrees of freedom left to choice when the chain is redundant; `None`: the compiler chooses.
    pub free: Option<Vec<DofIdx>>,
    /// A resting position of the chain, in the order of `dofs`.
    pub home: Option<Vec<f64>>,
}

/// How a gripper holds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Hold {
    /// Its fingers close until they touch.
    #[default]
    Close,
    /// Its fingers are magnets or suction cups: they touch, and pull as hard as they push. It has no joints.
    Attract,
}

/// A gripper: parallel jaws, fingers, magnets or suction cups.
#[derive(Debug, Clone, PartialEq)]
pub struct Gripper {
    /// Unique among grippers.
    pub name: String,
    /// The link that fingers hang on.
    pub palm: LinkIdx,
    /// `palm_from_tool`: the frame that grasps are given in. Its origin lies between the closed fingers.
    pub palm_from_tool: Pose,
    /// Direction of approach in the tool frame.
    pub approach_in_tool: Unit<Vector3<f64>>,
    /// How it holds.
    pub hold: Hold,
    /// Degrees of freedom of the fingers.
    pub dofs: Vec<DofIdx>,
    /// For each of `dofs`: 1 or -1 when it closes by growing or shrinking, 0 when it only shapes the hand (spread).
    pub closing: Vec<f64>,
    /// Links that may touch the object: finger pads or finger links.
    pub fingers: Vec<LinkIdx>,
    /// Positions to approach with; at least one.
    pub preshapes: Vec<Preshape>,
}

impl Gripper {
    /// The fingers that nothing moves, where a single joint closes the others on them: the hand then moves aside until they touch.
    pub fn fixed_jaw(&self, model: &RobotModel) -> Vec<LinkIdx> {
        if self.closing.iter().filter(|sign| **sign != 0.0).count() != 1 {
            return Vec::new();
        }
        let moved = |link: LinkIdx| model.dofs_moving(link).iter().any(|dof| self.dofs.contains(dof));
        self.fingers.iter().copied().filter(|&link| !moved(link)).collect()
    }
}

/// A position of the fingers before a grasp.
#[derive(Debug, Clone, PartialEq)]
pub struct Preshape {
    /// Unique in its gripper.
    pub name: String,
    /// Values in the order of [`Gripper::dofs`].
    pub values: Vec<f64>,
}

/// How a robot stands.
#[derive(Debug, Clone, PartialEq)]
pub enum Base {
    /// Bolted down.
    Fixed,
    /// Drives on a plane.
    Planar {
        /// Corners of the outline in the root frame, counter-clockwise; metres.
        footprint: Vec<[f64; 2]>,
        /// Whether it can move sideways.
        holonomic: bool,
        /// The joints that stand for its driving, if the description has them: along x and along y of the root, then about z.
        joints: Option<[DofIdx; 3]>,
    },
}

/// A camera fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Unique among cameras.
    pub name: String,
    /// The link it is fixed to.
    pub link: LinkIdx,
    /// `link_from_camera`: z looks out, x to the right of the image.
    pub link_from_camera: Pose,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Focal lengths and principal point fx, fy, cx, cy, pixels.
    pub intrinsics: [f64; 4],
}
