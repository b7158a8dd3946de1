//! What a pick-and-place planner returns: segments that an executor replays one after the other.

use std::fmt;

use robotc_core::{LinkIdx, Pose, Trajectory};

use super::Rejections;
use crate::budget::Interrupt;

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
    /// The arm moves an article in a loose grip.
    Open,
    /// The arm folds itself above the footprint of the base, to drive.
    Fold,
    /// The base drives, the arm is folded.
    Drive,
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
            Self::Open => "open",
            Self::Fold => "fold",
            Self::Drive => "drive",
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
    /// Links that touch it when it is picked up, ascending.
    pub touching: Vec<LinkIdx>,
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

/// What an article does during a segment.
#[derive(Debug, Clone, PartialEq)]
pub struct ArticleMotion {
    /// Position in `Task::articles`.
    pub article: usize,
    /// The value of its joint, at the times of the segment's trajectory.
    pub values: Trajectory,
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
    /// The article that moves with the gripper.
    pub article: Option<ArticleMotion>,
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
pub enum Choice {
    /// An object was put down.
    Place(PlaceChoice),
    /// An article was moved.
    Open(OpenChoice),
}

impl Choice {
    /// Position in `Task::goals`.
    pub fn goal(&self) -> usize {
        match self {
            Self::Place(choice) => choice.goal,
            Self::Open(choice) => choice.goal,
        }
    }
}

/// How an object is put down.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceChoice {
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

/// How an article is moved.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenChoice {
    /// Position in `Task::goals`.
    pub goal: usize,
    /// Position in `Task::articles`.
    pub article: usize,
    /// Where its joint ends up.
    pub value: f64,
    /// Positions in the article's set of loose grips, at the steps of its way.
    pub grips: Vec<usize>,
    /// What was looked at and not taken on the way.
    pub rejections: Rejections,
}

/// The stage at which the planner gave up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// The object is stuck in something where it stands.
    Start,
    /// No grasp passed all filters.
    Grasps,
    /// No path to any grasp.
    Reach,
    /// No path from any grasp to the destination.
    Carry,
    /// No way of the article in any of its grips.
    Open,
}

/// How many grasps a search got through.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tried {
    /// Grasps known.
    pub known: usize,
    /// Of these, looked at.
    pub looked_at: usize,
    /// Grasps with a solution of the arm for which every straight motion is free; one grasp may have several.
    pub usable: usize,
}

/// How near a search for a free motion came to a goal before it gave up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// From tool to tool, metres.
    pub distance: f64,
    /// Between the orientations of the tools, radians.
    pub angle: f64,
}

impl fmt::Display for Nearest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let degrees = self.angle.to_degrees();
        write!(
            f,
            "at the nearest, the tool was {:.3} m and {degrees:.0} degrees from the goal",
            self.distance
        )
    }
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
    /// Set when the search was told to stop: the counts are those so far.
    pub interrupt: Option<Interrupt>,
    /// How many grasps were looked at.
    pub tried: Tried,
    /// What each filter rejected, and what touched what.
    pub rejections: Rejections,
    /// How near the free motions came that did not arrive.
    pub nearest: Option<Nearest>,
}

impl GoalFailure {
    /// A failure with nothing counted yet.
    pub(super) fn new(object: &str, stage: Stage) -> Box<Self> {
        Box::new(Self {
            object: object.to_owned(),
            stage,
            message: String::new(),
            interrupt: None,
            tried: Tried::default(),
            rejections: Rejections::default(),
            nearest: None,
        })
    }
}

impl fmt::Display for GoalFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { object, message, .. } = self;
        match (self.interrupt, self.stage) {
            (None, Stage::Start) => write!(f, "{object} cannot be picked up: {message}")?,
            (None, Stage::Grasps) => write!(f, "no grasp of {object} can be used: {message}")?,
            (None, Stage::Reach) => write!(f, "no way to {object}: {message}")?,
            (None, Stage::Carry) => write!(f, "no way to carry {object} to its destination: {message}")?,
            (None, Stage::Open) => write!(f, "no way to move {object}: {message}")?,
            (Some(interrupt), stage) => {
                let doing = match stage {
                    Stage::Start | Stage::Grasps => "looking for a grasp of",
                    Stage::Reach => "looking for a way to",
                    Stage::Carry => "looking for a way to carry",
                    Stage::Open => "looking for a way to move",
                };
                write!(f, "{interrupt} while {doing} {object}: {message}")?;
            }
        }
        if let Some(nearest) = self.nearest {
            write!(f, "; {nearest}")?;
        }
        if !self.rejections.is_empty() {
            write!(f, " ({})", self.rejections)?;
        }
        Ok(())
    }
}
