//! Goals that are found while the search runs.

use crate::budget::{Budget, Interrupt};

/// What came of asking for a goal.
#[derive(Debug, Clone, PartialEq)]
pub enum GoalDraw {
    /// A goal configuration, known to be valid.
    Goal(Vec<f64>),
    /// Some candidates were looked at and none was good; more are left.
    Pending,
    /// There are no more goals, ever.
    Exhausted,
}

/// A source of goal configurations, resumed where it stopped (thesis algorithm 3.5).
///
/// Goals are numbered by the order in which they are drawn; a search reports the number of the one it reached, and the
/// sampler remembers what is behind it: a grasp, a branch of inverse kinematics.
pub trait GoalSampler {
    /// Looks at the next few candidates.
    fn draw(&mut self, budget: &Budget<'_>) -> Result<GoalDraw, Interrupt>;
}

/// Goals known beforehand, in order.
#[derive(Debug, Clone, Default)]
pub struct FixedGoals {
    goals: std::vec::IntoIter<Vec<f64>>,
}

impl FixedGoals {
    /// These goals; they must be valid.
    pub fn new(goals: Vec<Vec<f64>>) -> Self {
        Self { goals: goals.into_iter() }
    }
}

impl GoalSampler for FixedGoals {
    fn draw(&mut self, _: &Budget<'_>) -> Result<GoalDraw, Interrupt> {
        Ok(self.goals.next().map_or(GoalDraw::Exhausted, GoalDraw::Goal))
    }
}
