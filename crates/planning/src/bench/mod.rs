//! Motion planning over a set of given problems: one start, one goal, a robot among boxes, cylinders and spheres.
//!
//! Problems come in the flat form of MotionBenchMaker (Chamzas et al., "MotionBenchMaker: a tool to generate and benchmark
//! motion planning datasets", 2022). A [`BenchRobot`] is what is computed once for a robot, [`run`] plans every problem
//! and times the whole calls, and a [`Report`] says what came of it.

mod checks;
mod problems;
mod report;
mod robot;
mod run;

pub use checks::{CheckRates, measure_checks};
pub use problems::{Problem, ProblemSet, ProblemSetError};
pub use report::{Report, Row, SceneSummary, Summary};
pub use robot::{BenchError, BenchRobot, Stage};
pub use run::{BenchOptions, run};
