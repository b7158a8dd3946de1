//! The document.

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use robotc_core::{Pose, Seed};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::situation::SituationDocument;
use crate::arm::ArmModel;
use crate::budget::Interrupt;
use crate::constraint::{Constraint, HeldMechanism, RegionError, RegionTolerance, TaskRegion, Upright};
use crate::jitter::JitterOptions;
use crate::mechanism::{Mechanism, MechanismMotion};
use crate::rrt::RrtOptions;
use crate::smooth::{DEFAULT_SMOOTHERS, Smoother};
use crate::space::{Axis, Space};

/// The version of the document that this library writes and reads.
pub const VERSION: u32 = 1;

/// Most searches that race for a problem.
pub const MOST_RACERS: u32 = 64;

/// A problem of free motion, as JSON. Unknown keys are ignored, and [known](super::unknown_keys) on request; keys with a default may be left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanningProblem {
    /// Version of the document: [`VERSION`].
    pub version: u32,
    /// Name of a planner in the registry.
    #[serde(default = "default_planner")]
    pub planner: String,
    /// One for each coordinate: limits and metric. Beside a task it may be left out, and is that of the arm.
    #[serde(default)]
    pub axes: Vec<AxisDocument>,
    /// The start configuration. Beside a task it may be left out, and is where the task starts.
    #[serde(default)]
    pub start: Vec<f64>,
    /// Goal configurations; more can be drawn during the search by a sampler, which is code.
    #[serde(default)]
    pub goals: Vec<Vec<f64>>,
    /// `world_from_tool`: goals of which inverse kinematics finds the configurations. Needs an arm.
    #[serde(default)]
    pub tool_goals: Vec<PoseDocument>,
    /// What differs from the start of the task. Needs a task.
    #[serde(default)]
    pub situation: SituationDocument,
    /// A condition on every state of the path.
    #[serde(default)]
    pub constraint: Option<ConstraintDocument>,
    /// Largest travel of any point between two checked states, metres.
    #[serde(default = "default_resolution")]
    pub resolution: f64,
    /// Distance kept from obstacles, metres; at least half the resolution makes whole edges free.
    #[serde(default = "default_margin")]
    pub margin: f64,
    /// Whether links of the robot are compared with each other.
    #[serde(default = "default_true")]
    pub self_collisions: bool,
    /// Seconds after which the search ends; the caller keeps the clock, see [`PlanningProblem::interrupt`].
    #[serde(default)]
    pub time_limit: Option<f64>,
    /// Names the random streams: the same seed gives the same path.
    #[serde(default)]
    pub seed: u64,
    /// Searches that [race](crate::motion::race()), each with a stream of its own: 1 is no race. The path depends on how many race, not on how
    /// many threads they have.
    #[serde(default = "default_race")]
    pub race: u32,
    /// If given, a start that is not free is moved out of the contact first.
    #[serde(default)]
    pub jitter: Option<JitterOptions>,
    /// Step lengths and limits of the search.
    #[serde(default)]
    pub search: RrtOptions,
    /// What is done to the path, in order.
    #[serde(default = "default_post")]
    pub post: Vec<Smoother>,
    /// Parameters of one planner alone, such as one that is not of this library.
    #[serde(default)]
    pub options: serde_json::Map<String, serde_json::Value>,
}

fn default_planner() -> String {
    "rrt_connect".into()
}

fn default_resolution() -> f64 {
    0.01
}

fn default_margin() -> f64 {
    0.005
}

fn default_race() -> u32 {
    1
}

fn default_true() -> bool {
    true
}

fn default_post() -> Vec<Smoother> {
    DEFAULT_SMOOTHERS.to_vec()
}

/// A coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AxisDocument {
    /// Smallest and largest value; left out, the coordinate wraps at a whole turn.
    #[serde(default)]
    pub bounds: Option<[f64; 2]>,
    /// Factor of the coordinate in the metric.
    #[serde(default = "default_weight")]
    pub weight: f64,
}

fn default_weight() -> f64 {
    1.0
}

/// A pose: a point and a quaternion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PoseDocument {
    /// x, y, z; metres.
    pub position: [f64; 3],
    /// x, y, z, w; normalised when read.
    #[serde(default = "no_turn")]
    pub orientation: [f64; 4],
}

fn no_turn() -> [f64; 4] {
    [0.0, 0.0, 0.0, 1.0]
}

impl PoseDocument {
    /// The pose; `None` when a number is not finite or the quaternion is zero.
    pub fn pose(&self) -> Option<Pose> {
        let [x, y, z, w] = self.orientation;
        let finite = self.position.iter().chain(&self.orientation).all(|v| v.is_finite());
        let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-9)?;
        finite.then(|| Pose::from_parts(Translation3::from(self.position), rotation))
    }

    /// The document of a pose.
    pub fn of(pose: &Pose) -> Self {
        let q = pose.rotation.coords;
        Self { position: pose.translation.vector.into(), orientation: [q.x, q.y, q.z, q.w] }
    }
}

/// A path constraint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ConstraintDocument {
    /// [`Upright`].
    Upright {
        /// The held object in the tool frame.
        tool_from_object: PoseDocument,
        /// Largest angle from the vertical, radians.
        tilt: f64,
    },
    /// [`TaskRegion`].
    Region {
        /// The frame that bounds are about.
        world_from_region: PoseDocument,
        /// The frame that they are of.
        tool_from_frame: PoseDocument,
        /// Lower bounds of x, y, z, roll, pitch, yaw; null for none.
        low: [Option<f64>; 6],
        /// Upper bounds; null for none.
        high: [Option<f64>; 6],
        /// What is allowed outside of them.
        #[serde(default)]
        tolerance: RegionTolerance,
    },
    /// [`HeldMechanism`].
    Mechanism {
        /// The door or drawer.
        mechanism: MechanismDocument,
        /// Its moving part in the tool frame.
        tool_from_part: PoseDocument,
        /// What the grasp gives way.
        #[serde(default)]
        tolerance: RegionTolerance,
    },
}

/// A door or a drawer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MechanismDocument {
    /// z is the axis.
    pub world_from_axis: PoseDocument,
    /// Turns about it, or slides along it.
    pub motion: MechanismMotion,
    /// Smallest and largest value, radians or metres.
    pub range: [f64; 2],
}

/// What is wrong with a document.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ProblemError {
    /// It is not JSON of this form.
    #[error("the problem cannot be read: {0}")]
    Syntax(String),
    /// It is of another version.
    #[error("the problem has version {0}; this library reads version {VERSION}")]
    Version(u32),
    /// A configuration has the wrong number of coordinates.
    #[error("{what} has {found} coordinates, there are {expected} axes")]
    Dimension {
        /// Which configuration.
        what: String,
        /// Its number of coordinates.
        found: usize,
        /// The number of axes.
        expected: usize,
    },
    /// A value makes no sense.
    #[error("{what} is {found}, expected {expected}")]
    Value {
        /// Which value.
        what: String,
        /// What it is.
        found: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// A pose is not one.
    #[error("{0} is not a pose")]
    Pose(&'static str),
    /// The bounds of the constraint make no region.
    #[error(transparent)]
    Region(#[from] RegionError),
}

impl PlanningProblem {
    /// A problem with defaults for all that has one.
    pub fn new(space: &Space, start: &[f64], goals: Vec<Vec<f64>>) -> Self {
        let axis = |axis: &Axis| AxisDocument {
            bounds: (!axis.wraps).then_some([axis.lower, axis.upper]),
            weight: axis.weight,
        };
        Self {
            version: VERSION,
            planner: default_planner(),
            axes: space.axes().iter().map(axis).collect(),
            start: start.to_vec(),
            goals,
            tool_goals: Vec::new(),
            situation: SituationDocument::default(),
            constraint: None,
            resolution: default_resolution(),
            margin: default_margin(),
            self_collisions: true,
            time_limit: None,
            seed: 0,
            race: default_race(),
            jitter: None,
            search: RrtOptions::default(),
            post: default_post(),
            options: serde_json::Map::new(),
        }
    }

    /// Reads and checks a document.
    pub fn read(text: &str) -> Result<Self, ProblemError> {
        let problem = Self::read_partial(text)?;
        problem.check()?;
        Ok(problem)
    }

    /// Reads a document that may lack axes and start; what is filled in is checked by [`check`](Self::check).
    pub fn read_partial(text: &str) -> Result<Self, ProblemError> {
        serde_json::from_str(text).map_err(|e| ProblemError::Syntax(e.to_string()))
    }

    /// The document as text, all keys written out.
    pub fn write(&self) -> String {
        serde_json::to_string_pretty(self).expect("numbers, texts and lists can be written")
    }

    /// Whether all values make sense.
    pub fn check(&self) -> Result<(), ProblemError> {
        if self.version != VERSION {
            return Err(ProblemError::Version(self.version));
        }
        let value = |what: String, found: f64, expected: &'static str, good: bool| {
            if good { Ok(()) } else { Err(ProblemError::Value { what, found, expected }) }
        };
        value("the number of axes".into(), self.axes.len() as f64, "at least 1", !self.axes.is_empty())?;
        for (i, axis) in self.axes.iter().enumerate() {
            let [low, high] = axis.bounds.unwrap_or([0.0, 0.0]);
            let finite = low.is_finite() && high.is_finite();
            value(format!("axes[{i}].bounds[1]"), high, "at least bounds[0], finite", finite && low <= high)?;
            let good = axis.weight > 0.0 && axis.weight.is_finite();
            value(format!("axes[{i}].weight"), axis.weight, "more than 0", good)?;
        }
        let goals = self.goals.iter().enumerate().map(|(i, q)| (format!("goals[{i}]"), q));
        for (what, q) in std::iter::once(("start".to_owned(), &self.start)).chain(goals) {
            if q.len() != self.axes.len() {
                let (found, expected) = (q.len(), self.axes.len());
                return Err(ProblemError::Dimension { what, found, expected });
            }
            if let Some(&bad) = q.iter().find(|x| !x.is_finite()) {
                value(what, bad, "finite", false)?;
            }
        }
        let positive = |what: &str, x: f64| value(what.into(), x, "more than 0", x > 0.0 && x.is_finite());
        positive("resolution", self.resolution)?;
        positive("search.step", self.search.step)?;
        value("margin".into(), self.margin, "at least 0", self.margin >= 0.0 && self.margin.is_finite())?;
        let local = self.search.local;
        value("search.local".into(), local, "from 0 to 1", (0.0..=1.0).contains(&local))?;
        value("race".into(), f64::from(self.race), "from 1 to 64", (1..=MOST_RACERS).contains(&self.race))?;
        if let Some(limit) = self.time_limit {
            value("time_limit".into(), limit, "at least 0", limit >= 0.0)?;
        }
        if let Some(jitter) = &self.jitter {
            positive("jitter.smallest", jitter.smallest)?;
            positive("jitter.limit", jitter.limit)?;
            value("jitter.growth".into(), jitter.growth, "more than 1", jitter.growth > 1.0)?;
        }
        Ok(())
    }

    /// The configuration space.
    pub fn space(&self) -> Space {
        let axis = |axis: &AxisDocument| match axis.bounds {
            Some([lower, upper]) => Axis { weight: axis.weight, ..Axis::bounded(lower, upper) },
            None => Axis { weight: axis.weight, ..Axis::wrapping() },
        };
        Space::new(self.axes.iter().map(axis).collect())
    }

    /// The root of the random streams.
    pub fn random_seed(&self) -> Seed {
        Seed::new(self.seed)
    }

    /// The root of the random streams of one of the searches that race; 0 is the first.
    pub fn racer_seed(&self, racer: u32) -> Seed {
        match racer {
            0 => self.random_seed(),
            _ => self.random_seed().split("racer").at(u64::from(racer)),
        }
    }

    /// What a budget asks: whether the time limit is over, `elapsed` seconds after the start.
    pub fn interrupt(&self, elapsed: f64) -> Option<Interrupt> {
        self.time_limit.filter(|limit| elapsed >= *limit).map(|_| Interrupt::TimeUp)
    }
}

impl ConstraintDocument {
    /// The constraint for an arm.
    pub fn build<'a>(&self, arm: &'a ArmModel) -> Result<Box<dyn Constraint + 'a>, ProblemError> {
        let pose = |document: &PoseDocument, what| document.pose().ok_or(ProblemError::Pose(what));
        Ok(match self {
            Self::Upright { tool_from_object, tilt } => {
                let tool_from_object = pose(tool_from_object, "constraint.tool_from_object")?;
                Box::new(Upright { arm, tool_from_object, tilt: *tilt })
            }
            Self::Region { world_from_region, tool_from_frame, low, high, tolerance } => {
                Box::new(TaskRegion::new(
                    arm,
                    &pose(world_from_region, "constraint.world_from_region")?,
                    &pose(tool_from_frame, "constraint.tool_from_frame")?,
                    low.map(|x| x.unwrap_or(f64::NEG_INFINITY)),
                    high.map(|x| x.unwrap_or(f64::INFINITY)),
                    *tolerance,
                )?)
            }
            Self::Mechanism { mechanism, tool_from_part, tolerance } => {
                let [from, to] = mechanism.range;
                let mechanism = Mechanism {
                    world_from_axis: pose(
                        &mechanism.world_from_axis,
                        "constraint.mechanism.world_from_axis",
                    )?,
                    motion: mechanism.motion,
                    range: (from, to),
                };
                let tool_from_part = pose(tool_from_part, "constraint.tool_from_part")?;
                Box::new(HeldMechanism::new(arm, &mechanism, &tool_from_part, *tolerance)?)
            }
        })
    }
}
