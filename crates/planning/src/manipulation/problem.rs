//! What a pick-and-place planner is given.

use robotc_core::ids::Idx;
use robotc_core::robot::{Gripper, Robot};
use robotc_core::task::{Goal, Task};
use robotc_core::{BodyIdx, Configuration, DofIdx, Kinematics, LinkIdx, Pose};

use crate::arm::ArmModel;
use crate::cartesian::LineOptions;
use crate::grasp::GraspSet;
use crate::rrt::RrtOptions;
use crate::scene::{Grip, Rules, Scene};
use crate::smooth::{DEFAULT_SMOOTHERS, Smoother};
use crate::space::{Axis, Space};
use crate::timing::{MotionLimits, TimingOptions};

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
    /// Where the robot is now.
    pub start: &'a Configuration,
}

/// Parameters of a pick-and-place planner. Lengths are metres.
#[derive(Debug, Clone, PartialEq)]
pub struct ManipulationOptions {
    /// The searches for free motions.
    pub rrt: RrtOptions,
    /// What is done to their paths, in order.
    pub smoothers: Vec<Smoother>,
    /// Straight motions of the tool.
    pub line: LineOptions,
    /// Times along paths.
    pub timing: TimingOptions,
    /// Distance that free motions keep from everything, object included.
    pub margin: f64,
    /// Largest travel of any point between two checked states of a free motion. No more than twice the margin, so that
    /// the states in between are free too.
    pub resolution: f64,
    /// The same for straight motions, which go near and touch.
    pub fine_resolution: f64,
    /// Length of the straight approach and of the retreat.
    pub approach: f64,
    /// Last part of the approach, in which the open gripper may touch the object.
    pub contact: f64,
    /// Longest straight lift and lowering; shorter ones, halved twice, are tried where it does not fit.
    pub lift: f64,
    /// How deep a held object may seem to be in what it stands on.
    pub sink: f64,
    /// Destinations tried for each goal.
    pub destinations: usize,
    /// Candidate placings looked at for each grasp before it counts as hopeless.
    pub placings: u32,
    /// For a redundant arm, values of the free joints tried for each grasp and each placing.
    pub free_samples: u32,
    /// Branches of inverse kinematics tried for each grasp and free value, nearest first.
    pub branches: usize,
    /// Grasps for which a free motion to the destination is searched before the goal counts as unreachable.
    pub attempts: u32,
}

impl Default for ManipulationOptions {
    fn default() -> Self {
        Self {
            rrt: RrtOptions { max_iterations: 4000, ..RrtOptions::default() },
            smoothers: DEFAULT_SMOOTHERS.to_vec(),
            line: LineOptions::default(),
            timing: TimingOptions::default(),
            margin: 0.005,
            resolution: 0.01,
            fine_resolution: 0.005,
            approach: 0.08,
            contact: 0.01,
            lift: 0.08,
            sink: 0.003,
            destinations: 64,
            placings: 40,
            free_samples: 8,
            branches: 4,
            attempts: 8,
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
    /// Position of the object in the task, the scene and the grasp sets.
    pub(super) object: usize,
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
        &self.problem.task.objects[self.object].name
    }

    /// Rules of free motion.
    pub(super) fn free(&self, held: Option<Grip>) -> Rules {
        Rules { margin: self.options.margin, held, gripper: self.gripper_links.to_vec(), ..Rules::default() }
    }

    /// Rules near the object: the open gripper may touch it.
    pub(super) fn touching(&self) -> Rules {
        Rules { target: Some(self.body()), gripper: self.gripper_links.to_vec(), ..Rules::default() }
    }

    /// Rules of the straight motions with the object: it stands on something at one end.
    pub(super) fn standing(&self, held: Grip) -> Rules {
        Rules {
            held: Some(held),
            sink: Some(self.options.sink),
            gripper: self.gripper_links.to_vec(),
            ..Rules::default()
        }
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

/// The configuration space of a gripper's fingers.
pub(super) fn finger_space(robot: &Robot, gripper: usize) -> Space {
    let axis = |&dof: &DofIdx| {
        let d = &robot.model.dofs()[dof];
        Axis { lower: d.lower, upper: d.upper, wraps: d.continuous, weight: 1.0 }
    };
    Space::new(robot.grippers[gripper].dofs.iter().map(axis).collect())
}

/// Speed limits of these degrees of freedom.
pub(super) fn motion_limits(robot: &Robot, dofs: &[DofIdx]) -> MotionLimits {
    let dynamics = |dof: &DofIdx| robot.model.dofs()[*dof].dynamics;
    MotionLimits {
        velocity: dofs.iter().map(|d| dynamics(d).velocity).collect(),
        acceleration: dofs.iter().map(|d| dynamics(d).acceleration).collect(),
    }
}

/// Links of a gripper, ascending: the palm with everything rigidly joined below it or hanging on it.
pub(super) fn gripper_links(robot: &Robot, gripper: usize) -> Vec<LinkIdx> {
    let mut links = robot.model.subtree(robot.grippers[gripper].palm);
    links.sort();
    links
}
