//! Measurements of planners: motion over a set of given problems, grasps with destinations, doors opened from everywhere, arms on wheels, weights of the metric.
//!
//! Motion planning is one start, one goal, a robot among boxes, cylinders and spheres.
//!
//! Problems come in the flat form of MotionBenchMaker (Chamzas et al., "MotionBenchMaker: a tool to generate and benchmark
//! motion planning datasets", 2022). A [`BenchRobot`] is what is computed once for a robot, [`run`] plans every problem
//! and times the whole calls, and a [`Report`] says what came of it.

mod caging;
mod checks;
mod clouds;
mod grasps;
mod mobile;
mod placement;
mod problems;
mod report;
mod robot;
mod run;
mod weights;

pub use caging::{Attempt, CagingBenchOptions, CagingPlace, CagingReport, measure_caging};
pub use checks::{CheckRates, measure_checks};
pub use clouds::RADIUS_FOR_SPACING;
pub use grasps::{GraspBenchOptions, GraspReport, measure_grasps};
pub use mobile::{MobileBenchOptions, MobileFigures, MobileReport, measure_mobile};
pub use placement::{PlacementFigures, PlacementReport, measure_placement};
pub use problems::{Obstacle, Problem, ProblemSet, ProblemSetError};
pub use report::{Report, Row, SceneSummary, Summary};
pub use robot::{BenchError, BenchRobot, Stage};
pub use run::{BenchOptions, run};
pub use weights::{WeightsReport, measure_weights};
