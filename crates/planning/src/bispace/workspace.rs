//! The space of tool poses, and what searches for tool goals report.

use std::collections::BTreeMap;
use std::fmt;

use robotc_core::rng::Rng;

use crate::budget::Interrupt;
use crate::edge::Obstruction;
use crate::space::Space;

/// The tool of a robot that consists of a base and an arm: where it is, how far that is from a goal, and how to get there.
///
/// Configurations are those of an [`EdgeChecker`](crate::edge::EdgeChecker) that goes with it.
pub trait Workspace {
    /// A pose of the tool.
    type Point: Clone;

    /// Where the tool is at `q`.
    fn point(&self, q: &[f64]) -> Self::Point;

    /// Distance of two poses, metres; turns count as a length.
    fn distance(&self, a: &Self::Point, b: &Self::Point) -> f64;

    /// A random pose anywhere in the workspace.
    fn sample(&self, rng: &mut Rng) -> Self::Point;

    /// The pose on the way from one to another, no farther than `step` from the first.
    fn toward(&self, from: &Self::Point, to: &Self::Point, step: f64) -> Self::Point;

    /// Whether the tool alone may go straight from one pose to another.
    fn tool_motion(&mut self, from: &Self::Point, to: &Self::Point) -> bool;

    /// The small motion in the direction in which the distance of the tool to `to` falls fastest: transposed Jacobian times
    /// error, scaled to the length that brings it there if the tool moved as the Jacobian says.
    fn pull(&self, q: &[f64], to: &Self::Point) -> Vec<f64>;

    /// Configurations within the limits with the tool at `to` and the base as in `q`, nearest to `q` first; whether they are
    /// free is not checked.
    fn solutions(&mut self, q: &[f64], to: &Self::Point) -> Vec<Vec<f64>>;

    /// Coordinates of the base, ascending.
    fn base(&self) -> &[usize];

    /// Distance on the floor from the base at `q` to below the tool at `to`, metres.
    fn base_distance(&self, q: &[f64], to: &Self::Point) -> f64;

    /// A random configuration with the base within reach of the tool at `to`, or just about.
    fn sample_near(&self, space: &Space, to: &Self::Point, rng: &mut Rng) -> Vec<f64>;

    /// Length of the arm, metres: farther from the base than this the tool never is on the floor.
    fn reach(&self) -> f64;
}

/// What a search did. The searches share this form, so that they can be compared.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ToolStatistics {
    /// Iterations run.
    pub iterations: u32,
    /// Configurations in the tree, or in both trees.
    pub nodes: usize,
    /// Poses in the tree of the tool.
    pub goal_nodes: usize,
    /// How often a configuration tried to follow the tool or to go straight to the goal.
    pub follows: u32,
    /// How often inverse kinematics was tried.
    pub inverse_tests: u32,
    /// How many edges each obstruction stopped.
    pub blocked: BTreeMap<Obstruction, u32>,
}

/// A path to a goal of the tool.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolSolution {
    /// Configurations from the start; the straight motions between them are valid.
    pub path: Vec<Vec<f64>>,
    /// Number of the goal reached.
    pub goal: usize,
    /// What it took.
    pub statistics: ToolStatistics,
}

/// Why there is no path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ToolFailureReason {
    /// The start itself is invalid.
    Start(Obstruction),
    /// There are no goals, or no configuration at any of them was found.
    NoGoal,
    /// The limit on iterations was reached.
    Iterations,
    /// The budget ended.
    Interrupted(Interrupt),
}

/// Why there is no path, and what was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolFailure {
    /// What ended the search.
    pub reason: ToolFailureReason,
    /// How near the tool came to a goal, metres; infinite when that was not found out.
    pub nearest: f64,
    /// What was tried.
    pub statistics: ToolStatistics,
}

impl fmt::Display for ToolFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = &self.statistics;
        match self.reason {
            ToolFailureReason::Start(_) => write!(f, "the start is not free"),
            ToolFailureReason::NoGoal => write!(f, "no configuration at the goal was found"),
            ToolFailureReason::Iterations => {
                write!(f, "the goal was not reached in {} iterations", s.iterations)?;
                if self.nearest.is_finite() {
                    write!(f, "; the tool came within {:.3} m", self.nearest)?;
                }
                Ok(())
            }
            ToolFailureReason::Interrupted(interrupt) => {
                write!(f, "{interrupt} after {} iterations", s.iterations)
            }
        }
    }
}
