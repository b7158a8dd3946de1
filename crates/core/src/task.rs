//! A task as the compiler sees it: what stands where, and what shall happen.

use std::sync::Arc;

use crate::Pose;
use crate::ids::{DofIdx, LinkIdx};
use crate::model::{Configuration, Geometry, Kinematics, LinkPoses, RobotModel};
use crate::robot::Robot;

/// A checked task specification.
#[derive(Debug, Clone)]
pub struct Task {
    /// Name of the task.
    pub name: String,
    /// The robot that does it.
    pub robot: Arc<Robot>,
    /// Position in [`Robot::arms`] of the arm that does it.
    pub arm: usize,
    /// `world_from_root`: where the robot stands.
    pub world_from_robot: Pose,
    /// Where the robot starts.
    pub start: Configuration,
    /// Things that can be moved, in specification order.
    pub objects: Vec<Object>,
    /// Things that cannot: those of the specification in order, then the links of articles.
    pub obstacles: Vec<Obstacle>,
    /// Things with a joint of their own, in specification order.
    pub articles: Vec<Article>,
    /// What shall happen, in order.
    pub goals: Vec<Goal>,
    /// Root of all randomness of the task.
    pub seed: u64,
}

/// A thing that can be grasped and moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Unique among objects and obstacles.
    pub name: String,
    /// Its shape, shared by objects made from the same file.
    pub geometry: Arc<Vec<Geometry>>,
    /// Kilograms.
    pub mass: f64,
    /// Coulomb friction between object and fingers.
    pub friction: f64,
    /// `world_from_object` at the start.
    pub world_from_object: Pose,
}

/// A thing that stays where it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// Unique among objects and obstacles.
    pub name: String,
    /// Its shape.
    pub geometry: Arc<Vec<Geometry>>,
    /// `world_from_obstacle`.
    pub world_from_obstacle: Pose,
    /// Points of its clouds that are within this distance of the robot where it starts are the robot's own, and left out when a
    /// session is opened; metres. `None`: all count.
    pub without_robot: Option<f64>,
}

/// A thing with a joint of its own: a door, a drawer, a lever. Its links are obstacles of the task as well, where they stand at
/// the start.
#[derive(Debug, Clone)]
pub struct Article {
    /// Unique among objects, obstacles and articles.
    pub name: String,
    /// Its links and joints.
    pub model: Arc<RobotModel>,
    /// The joint that opens it.
    pub dof: DofIdx,
    /// The link that a gripper takes it by.
    pub handle: LinkIdx,
    /// Coulomb friction between handle and fingers.
    pub friction: f64,
    /// Where its root stands.
    pub world_from_root: Pose,
    /// The values of its joints at the start.
    pub configuration: Configuration,
    /// Its links with shapes, each with its position in [`Task::obstacles`].
    pub bodies: Vec<(LinkIdx, usize)>,
}

impl Article {
    /// The links with shapes that its joint moves, each with its position in [`Task::obstacles`].
    pub fn moving_bodies(&self) -> impl Iterator<Item = (LinkIdx, usize)> {
        self.bodies.iter().copied().filter(|(link, _)| self.model.dofs_moving(*link).contains(&self.dof))
    }

    /// Where its moving links are with its joint at `value`, its other joints as at the start: positions in
    /// [`Task::obstacles`], and `world_from_obstacle` of each.
    pub fn moved_bodies(&self, value: f64) -> Vec<(usize, Pose)> {
        let mut configuration = self.configuration.clone();
        configuration[self.dof] = value;
        let mut poses = LinkPoses::default();
        Kinematics::new(self.model.clone()).link_poses(&configuration, &mut poses);
        self.moving_bodies()
            .map(|(link, body)| (body, self.world_from_root * poses.root_from(link)))
            .collect()
    }

    /// The value of its joint at the start.
    pub fn value(&self) -> f64 {
        self.configuration[self.dof]
    }
}

/// Something that shall happen.
#[derive(Debug, Clone, PartialEq)]
pub enum Goal {
    /// Pick one object up and put it down.
    Place {
        /// The objects of which any one does, at least one, none twice.
        targets: Vec<Target>,
        /// Largest tilt of the object's z axis against the world's while carried, radians, if limited.
        keep_upright: Option<f64>,
    },
    /// Open or close a door, a drawer, a lever.
    Open {
        /// Position in [`Task::articles`].
        article: usize,
        /// Where its joint shall end up, radians or metres.
        to: f64,
    },
}

/// An object of a goal, and where it may end up.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Position in [`Task::objects`].
    pub object: usize,
    /// Where it may end up.
    pub destination: Destination,
}

impl Goal {
    /// The objects of which any one is to be placed; none for articles.
    pub fn targets(&self) -> &[Target] {
        match self {
            Self::Place { targets, .. } => targets,
            Self::Open { .. } => &[],
        }
    }
}

impl Task {
    /// The name of what a goal is about: its article, or its object, the first one where several will do.
    pub fn name_of(&self, goal: &Goal) -> &str {
        match goal {
            Goal::Place { targets, .. } => &self.objects[targets[0].object].name,
            Goal::Open { article, .. } => &self.articles[*article].name,
        }
    }
}

/// Farthest that an object may be from where it has to be, metres, and largest angle, radians.
const ADMITTED: f64 = 1e-6;

impl Destination {
    /// Whether an object that stands there is where it shall be.
    pub fn admits(&self, there: &Pose) -> bool {
        match self {
            Self::Pose { world_from_object, any_yaw } => {
                let offset = world_from_object.translation.vector - there.translation.vector;
                let turned = if *any_yaw {
                    // What any turn about the vertical leaves: where the vertical is in the object.
                    let up = |pose: &Pose| pose.rotation.inverse() * nalgebra::Vector3::z();
                    (up(world_from_object) - up(there)).norm()
                } else {
                    world_from_object.rotation.angle_to(&there.rotation)
                };
                offset.norm() <= ADMITTED && turned <= ADMITTED
            }
            Self::Region { world_from_region, size, origin_height } => {
                let region_from_object = world_from_region.inv_mul(there);
                let at = region_from_object.translation.vector;
                let up = region_from_object.rotation * nalgebra::Vector3::z();
                at.x.abs() <= 0.5 * size[0] + ADMITTED
                    && at.y.abs() <= 0.5 * size[1] + ADMITTED
                    && (at.z - origin_height).abs() <= ADMITTED
                    && up.x.hypot(up.y) <= ADMITTED
                    && up.z > 0.0
            }
        }
    }
}

/// Where an object may be put.
#[derive(Debug, Clone, PartialEq)]
pub enum Destination {
    /// One pose, or the same one turned about the world's z axis.
    Pose {
        /// `world_from_object`.
        world_from_object: Pose,
        /// Whether any turn about the vertical through the object's origin is as good.
        any_yaw: bool,
    },
    /// Anywhere upright in a rectangle on a surface.
    Region {
        /// Centre of the rectangle; its z is the height of the surface.
        world_from_region: Pose,
        /// Full edge lengths along the region's x and y, metres. The object's origin is put inside.
        size: [f64; 2],
        /// Height of the object's origin above the surface when it stands on it.
        origin_height: f64,
    },
}
