//! What a pick-and-place planner returns: segments that an executor replays one after the other.

use std::fmt;

use robotc_core::{LinkIdx, Pose, Trajectory};

use super::Rejections;

/// What a segment is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SegmentKind {
    /// Opens the fingers to the preshape of the grasp, before anything moves.
    Preshape,
    /// The empty arm moves freely to where the approach starts.
    Reach,
    /// Straight motion of the open gripper to the grasp.
    Approach,
    /// The fingers close on the object.
    Grasp,
    /// Straight up with the object.
    Lift,
    /// The arm moves the object freely.
    Carry,
    /// Straight down to the destination.
    Lower,
    /// The fingers open.
    Release,
    /// Straight motion of the open gripper away from the object.
    Retreat,
}

impl fmt::Display for SegmentKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Preshape => "preshape",
            Self::Reach => "reach",
            Self::Approach => "approach",
            Self::Grasp => "grasp",
            Self::Lift => "lift",
            Self::Carry => "carry",
            Self::Lower => "lower",
            Self::Release => "release",
            Self::Retreat => "retreat",
        })
    }
}

/// An object in the gripper.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// Position in `Task::objects`.
    pub object: usize,
    /// The link it moves with.
    pub link: LinkIdx,
    /// The object in the frame of that link.
    pub link_from_object: Pose,
}

/// What changes in the world at the end of a segment.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// From here on the object moves with the gripper.
    Attach(Held),
    /// From here on the object stays where it is.
    Detach {
        /// Position in `Task::objects`.
        object: usize,
        /// Where it stays.
        world_from_object: Pose,
    },
}

/// One motion of a plan. Degrees of freedom that its trajectory does not name stay where they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// What it is for.
    pub kind: SegmentKind,
    /// Position in `Task::goals` of the goal it serves.
    pub goal: usize,
    /// Motion of the arm or of the fingers; starts where the segment before ended.
    pub trajectory: Trajectory,
    /// What the gripper holds during the motion.
    pub held: Option<Held>,
    /// What happens at the end.
    pub event: Option<Event>,
}

/// A goal that the plan leaves out.
#[derive(Debug, Clone, PartialEq)]
pub struct SkippedGoal {
    /// Position in `Task::goals`.
    pub goal: usize,
    /// Why, from the last attempt.
    pub reason: GoalFailure,
}

/// A plan for one or several goals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plan {
    /// The motions, in order.
    pub segments: Vec<Segment>,
    /// What was chosen for each goal reached, in the order of execution.
    pub choices: Vec<Choice>,
    /// Goals that could not be reached; empty when the plan is complete.
    pub skipped: Vec<SkippedGoal>,
}

impl Plan {
    /// Whether every goal of the task is reached.
    pub fn is_complete(&self) -> bool {
        self.skipped.is_empty()
    }

    /// Seconds of motion.
    pub fn duration(&self) -> f64 {
        self.segments.iter().map(|s| s.trajectory.duration()).sum()
    }
}

/// How one goal is reached.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Position in `Task::goals`.
    pub goal: usize,
    /// Position in `Task::objects`.
    pub object: usize,
    /// Position in the object's grasp set.
    pub grasp: usize,
    /// Where the object is put.
    pub world_from_object: Pose,
    /// What was looked at and not taken on the way.
    pub rejections: Rejections,
}

/// The stage at which the planner gave up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// No grasp passed all filters.
    Grasps,
    /// No path to any grasp.
    Reach,
    /// No path from any grasp to the destination.
    Carry,
}

/// Why a goal is not reached.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalFailure {
    /// Name of the object.
    pub object: String,
    /// Where planning ended.
    pub stage: Stage,
    /// What ended it, in words.
    pub message: String,
    /// What each filter rejected, and what touched what.
    pub rejections: Rejections,
}

impl fmt::Display for GoalFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { object, message, .. } = self;
        match self.stage {
            Stage::Grasps => write!(f, "no grasp of {object} can be used: {message}")?,
            Stage::Reach => write!(f, "no way to {object}: {message}")?,
            Stage::Carry => write!(f, "no way to carry {object} to its destination: {message}")?,
        }
        if !self.rejections.is_empty() {
            write!(f, " ({})", self.rejections)?;
        }
        Ok(())
    }
}
