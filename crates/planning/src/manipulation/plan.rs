//! What a pick-and-place planner returns: segments that an executor replays one after the other.

use std::fmt;

use robotc_core::task::Task;
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
    /// Position in `Task::objects` of the object that was put down for a goal, if one was.
    pub fn object_of(&self, goal: usize) -> Option<usize> {
        self.choices.iter().find_map(|choice| match choice {
            Choice::Place(choice) if choice.goal == goal => Some(choice.object),
            _ => None,
        })
    }

    /// The name of what a goal is about: the object that was taken, or the article.
    pub fn name_of<'t>(&self, task: &'t Task, goal: usize) -> &'t str {
        match self.object_of(goal) {
            Some(object) => &task.objects[object].name,
            None => task.name_of(&task.goals[goal]),
        }
    }

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

    /// The objects that would have done as well; none for articles.
    pub fn passed_over(&self) -> &[PassedOver] {
        match self {
            Self::Place(choice) => &choice.passed_over,
            Self::Open(_) => &[],
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
    /// The other objects that would have done.
    pub passed_over: Vec<PassedOver>,
}

/// An object that a goal allows and a plan does not take.
#[derive(Debug, Clone, PartialEq)]
pub struct PassedOver {
    /// Position in `Task::objects`.
    pub object: usize,
    /// Its name.
    pub name: String,
    /// How many of its grasps were looked at before another object was taken.
    pub tried: Tried,
    /// Why these were rejected; nothing when the other object's grasps were more promising.
    pub rejections: Rejections,
}

impl fmt::Display for PassedOver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, tried: Tried { known, looked_at, usable }, rejections, .. } = self;
        if *looked_at == 0 && rejections.is_empty() {
            return write!(f, "{name}: none of its {known} grasps looked at");
        }
        write!(f, "{name}: {usable} usable of {looked_at} looked at of {known}")?;
        if rejections.is_empty() { Ok(()) } else { write!(f, " ({rejections})") }
    }
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

impl std::ops::Add for Tried {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            known: self.known + other.known,
            looked_at: self.looked_at + other.looked_at,
            usable: self.usable + other.usable,
        }
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
    /// Where any of several objects would have done, what came of each.
    pub passed_over: Vec<PassedOver>,
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
            passed_over: Vec::new(),
            nearest: None,
        })
    }

    /// The same, ended by an interrupt.
    pub(super) fn interrupted(&self, interrupt: Interrupt) -> Box<Self> {
        Box::new(Self { interrupt: Some(interrupt), ..self.clone() })
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
        if !self.passed_over.is_empty() {
            self.passed_over.iter().try_for_each(|object| write!(f, "; {object}"))?;
        } else if !self.rejections.is_empty() {
            write!(f, " ({})", self.rejections)?;
        }
        Ok(())
    }
}
