//! What a pick-and-place planner is given.

use robotc_core::ids::Idx;
use robotc_core::robot::{Gripper, Robot};
use robotc_core::task::{Destination, Goal, Task};
use robotc_core::{BodyIdx, Configuration, DofIdx, Kinematics, LinkIdx, Pose, RobotModel};

use super::options::ManipulationOptions;
use crate::arm::ArmModel;
use crate::caging::Cage;
use crate::grasp::GraspSet;
use crate::reachability::Reachability;
use crate::scene::{Grip, Rules, Scene};
use crate::space::{Axis, Space};
use crate::timing::MotionLimits;

/// A task with all that is known about it.
#[derive(Clone, Copy)]
pub struct Manipulation<'a> {
    /// What shall happen.
    pub task: &'a Task,
    /// The robot's kinematics, calibration included.
    pub kinematics: &'a Kinematics,
    /// The arm that does it.
    pub arm: &'a ArmModel,
    /// Robot and bodies as they are now; as in `World::of_task`, body number i is object number i of the task, and the
    /// obstacles follow.
    pub scene: &'a Scene,
    /// The grasp set of each object of the task, in their order.
    pub grasps: &'a [&'a GraspSet],
    /// The loose grips of each article of the task, in their order.
    pub cages: &'a [&'a [Cage]],
    /// What is known about the arm's reach; grasps are tried in its order.
    pub reachability: Option<&'a dyn Reachability>,
    /// Where the robot is now.
    pub start: &'a Configuration,
}

impl Manipulation<'_> {
    /// The scene's body of an obstacle of the task.
    pub(super) fn obstacle(&self, obstacle: usize) -> BodyIdx {
        BodyIdx::new(self.task.objects.len() + obstacle)
    }

    /// The handle of an article, as a position in the scene; its first link when the handle has no shape.
    pub(super) fn handle_of(&self, article: usize) -> usize {
        let article = &self.task.articles[article];
        let handle = article.bodies.iter().find(|(link, _)| *link == article.handle);
        self.obstacle(handle.or(article.bodies.first()).map_or(0, |(_, obstacle)| *obstacle)).index()
    }

    /// Puts what an article moves where its joint at `value` takes it.
    pub(super) fn move_article(&self, scene: &mut Scene, article: usize, value: f64) {
        for (obstacle, world_from_body) in self.task.articles[article].moved_bodies(value) {
            scene.place(self.obstacle(obstacle), world_from_body);
        }
    }
}

/// One goal of the task, and what its planning needs at hand.
#[derive(Clone, Copy)]
pub(super) struct GoalContext<'a> {
    pub(super) problem: Manipulation<'a>,
    pub(super) options: &'a ManipulationOptions,
    /// Position of the goal in the task.
    pub(super) number: usize,
    /// Position of the object in the task, the scene and the grasp sets, the first one where several will do; of an article, its
    /// handle in the scene.
    pub(super) object: usize,
    /// Positions of objects that are to be left where they are: other goals put them there.
    pub(super) done: &'a [usize],
    /// Position of the gripper in the robot.
    pub(super) gripper: usize,
    /// Links of the gripper, ascending.
    pub(super) gripper_links: &'a [LinkIdx],
    /// The configuration space of the fingers.
    pub(super) finger_space: &'a Space,
}

impl<'a> GoalContext<'a> {
    pub(super) fn robot(&self) -> &'a Robot {
        &self.problem.task.robot
    }

    pub(super) fn gripper(&self) -> &'a Gripper {
        &self.robot().grippers[self.gripper]
    }

    pub(super) fn goal(&self) -> &'a Goal {
        &self.problem.task.goals[self.number]
    }

    /// The object in the scene.
    pub(super) fn body(&self) -> BodyIdx {
        BodyIdx::new(self.object)
    }

    pub(super) fn object_name(&self) -> &'a str {
        match self.goal() {
            Goal::Place { .. } => &self.problem.task.objects[self.object].name,
            Goal::Open { .. } => self.problem.task.name_of(self.goal()),
        }
    }

    /// The goal for each of its objects that may still be taken; for an article, itself.
    pub(super) fn of_targets(&self) -> Vec<Self> {
        match self.goal().targets() {
            [] => vec![*self],
            [target] => vec![Self { object: target.object, ..*self }],
            several => {
                let left = several.iter().filter(|target| !self.done.contains(&target.object));
                left.map(|target| Self { object: target.object, ..*self }).collect()
            }
        }
    }

    /// Where the object may end up.
    pub(super) fn destination(&self) -> Option<&'a Destination> {
        let target = self.goal().targets().iter().find(|target| target.object == self.object);
        target.map(|target| &target.destination)
    }

    /// Rules of free motion.
    pub(super) fn free(&self, held: Option<Grip>) -> Rules {
        Rules { margin: self.options.margin, held, gripper: self.gripper_links.to_vec(), ..Rules::default() }
    }

    /// Rules near the object: the open gripper may touch it.
    pub(super) fn touching(&self) -> Rules {
        Rules {
            margin: self.options.fine_margin(),
            target: Some(self.body()),
            give: matches!(self.goal(), Goal::Open { .. }).then_some(0.5 * self.options.give),
            gripper: self.gripper_links.to_vec(),
            ..Rules::default()
        }
    }

    /// Rules of the straight motions with the object: it stands on something at one end.
    pub(super) fn standing(&self, held: Grip) -> Rules {
        Rules {
            margin: self.options.fine_margin(),
            held: Some(held),
            sink: Some(self.sink()),
            gripper: self.gripper_links.to_vec(),
            ..Rules::default()
        }
    }

    /// How deep the object may seem to be in what it stands on, metres, at the states that are looked at. Half of what
    /// is allowed: the rest is for the states in between.
    pub(super) fn sink(&self) -> f64 {
        0.5 * allowed_sink(&self.problem, self.options, self.object)
    }

    /// The object in the gripper, for a grasp with this `object_from_tool`.
    pub(super) fn grip(&self, object_from_tool: &Pose) -> Grip {
        let gripper = self.gripper();
        Grip {
            body: self.body(),
            link: gripper.palm,
            link_from_body: gripper.palm_from_tool * object_from_tool.inverse(),
        }
    }

    /// `q` with the fingers at `values`.
    pub(super) fn with_fingers(&self, q: &Configuration, values: &[f64]) -> Configuration {
        let mut q = q.clone();
        q.set(&self.gripper().dofs, values);
        q
    }

    /// The values of the arm in `q`.
    pub(super) fn arm_values(&self, q: &Configuration) -> Vec<f64> {
        q.select(self.problem.arm.dofs())
    }
}

/// How deep an object may seem to be in what it stands on, metres.
pub(super) fn allowed_sink(problem: &Manipulation<'_>, options: &ManipulationOptions, object: usize) -> f64 {
    options.sink * problem.scene.body_diagonal(BodyIdx::new(object))
}

/// The configuration space of a gripper's fingers.
pub(crate) fn finger_space(robot: &Robot, gripper: usize) -> Space {
    let axis = |&dof: &DofIdx| {
        let d = &robot.model.dofs()[dof];
        Axis { lower: d.lower, upper: d.upper, wraps: d.continuous, weight: 1.0 }
    };
    Space::new(robot.grippers[gripper].dofs.iter().map(axis).collect())
}

/// The space of an arm and then the fingers.
pub(crate) fn with_fingers_space(arm: &Space, fingers: &Space) -> Space {
    Space::new(arm.axes().iter().chain(fingers.axes()).copied().collect())
}

/// Speed limits of these degrees of freedom.
pub(super) fn motion_limits(model: &RobotModel, dofs: &[DofIdx]) -> MotionLimits {
    let dynamics = |dof: &DofIdx| model.dofs()[*dof].dynamics;
    MotionLimits {
        velocity: dofs.iter().map(|d| dynamics(d).velocity).collect(),
        acceleration: dofs.iter().map(|d| dynamics(d).acceleration).collect(),
        jerk: dofs.iter().map(|d| dynamics(d).jerk).collect(),
    }
}

/// Links of a gripper, ascending: the palm with everything rigidly joined below it or hanging on it.
pub fn gripper_links(robot: &Robot, gripper: usize) -> Vec<LinkIdx> {
    let mut links = robot.model.subtree(robot.grippers[gripper].palm);
    links.sort();
    links
}
