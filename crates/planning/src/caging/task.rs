//! What the planners know of an object that is moved in a loose grip.

use std::collections::BTreeMap;
use std::fmt;

use crate::budget::Interrupt;
use crate::edge::Obstruction;
use crate::space::Space;

/// The object at one of its steps, the gripper at one of its grasps, the arm where it reaches it.
#[derive(Debug, Clone, PartialEq)]
pub struct CagedState {
    /// Number of the object's configuration.
    pub step: usize,
    /// Number of the grasp.
    pub grasp: usize,
    /// The arm.
    pub q: Vec<f64>,
}

/// An object with few distinct configurations (steps 0 to n - 1: now, and the goal), the grasps that cage it, and the arm.
pub trait ArticulatedTask {
    /// The configuration space of the arm.
    fn arm_space(&self) -> &Space;

    /// Number of object configurations; at least one. The last one is the goal.
    fn steps(&self) -> usize;

    /// Number of grasps.
    fn grasps(&self) -> usize;

    /// Whether a grasp may be used at all.
    fn is_usable(&self, _: usize) -> bool {
        true
    }

    /// Whether a grasp holds the object in contact, so that it cannot leave the goal.
    fn is_contact(&self, grasp: usize) -> bool;

    /// Grasps that the gripper may change to without leaving the cage, `grasp` itself included.
    fn adjacent(&self, grasp: usize) -> &[usize];

    /// Free arm configurations for a grasp: those near to `near`, nearest first, or else all at some resolution.
    fn solutions(&mut self, step: usize, grasp: usize, near: Option<&[f64]>) -> Vec<Vec<f64>>;

    /// Like [`solutions`](Self::solutions), but some of them may turn out not to be [free](Self::free): searches look at those
    /// that lead somewhere.
    fn candidates(&mut self, step: usize, grasp: usize, near: Option<&[f64]>) -> Vec<Vec<f64>> {
        self.solutions(step, grasp, near)
    }

    /// Shows those of the [`candidates`](Self::candidates) near to `near`, nearest first, until `take` says that it takes one.
    /// Whether it did.
    fn take_candidate(
        &mut self,
        step: usize,
        grasp: usize,
        near: &[f64],
        take: &mut dyn FnMut(Vec<f64>) -> bool,
    ) -> bool {
        self.candidates(step, grasp, Some(near)).into_iter().any(take)
    }

    /// Whether a candidate is free.
    fn free(&mut self, _: &CagedState) -> Result<(), Obstruction> {
        Ok(())
    }

    /// Whether arm and object may go straight from one state to another of the same or a neighbouring step.
    ///
    /// The first state is taken to be free, the other is looked at.
    fn motion(&mut self, from: &CagedState, to: &CagedState) -> Result<(), Obstruction>;

    /// Largest motion of the arm between neighbouring states, in its metric: more is a change of branch.
    fn longest_motion(&self) -> f64;

    /// Object configurations next to `step`, itself included. A line, unless the object has several degrees of freedom.
    fn neighbours(&self, step: usize) -> Vec<usize> {
        (step.saturating_sub(1)..=(step + 1).min(self.steps() - 1)).collect()
    }

    /// A lower bound on the number of changes of step from `step` to the goal.
    fn remaining(&self, step: usize) -> usize {
        self.steps() - 1 - step
    }
}

/// What a search did.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CagingStatistics {
    /// How often solutions of inverse kinematics were asked for.
    pub inverse_calls: u32,
    /// Arm configurations looked at.
    pub states: u32,
    /// Motions checked.
    pub motions: u32,
    /// How many of them each obstruction stopped.
    pub blocked: BTreeMap<Obstruction, u32>,
}

/// The object at its goal.
#[derive(Debug, Clone, PartialEq)]
pub struct CagingSolution {
    /// States from start to goal, neighbours joined by checked straight motions. Its joints come to the start by a free
    /// motion, which is planned apart.
    pub states: Vec<CagedState>,
    /// What it took.
    pub statistics: CagingStatistics,
}

/// Why the object does not get to its goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CagingFailureReason {
    /// At this step of the object no grasp is within reach and free.
    OutOfReach {
        /// The step.
        step: usize,
    },
    /// At the goal no grasp in contact is within reach and free.
    NoContact,
    /// There are solutions at every step, but no continuous motion through them.
    NoPath,
    /// The limit on iterations was reached.
    Iterations,
    /// The budget ended.
    Interrupted(Interrupt),
}

/// Why the object does not get to its goal, and what was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct CagingFailure {
    /// What ended the search.
    pub reason: CagingFailureReason,
    /// The longest part of the way that was found: from the start for [`randomized_search`](super::randomized_search), to
    /// the goal for [`discrete_search`](super::discrete_search).
    pub partial: Vec<CagedState>,
    /// What was tried.
    pub statistics: CagingStatistics,
}

impl fmt::Display for CagingFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.reason {
            CagingFailureReason::OutOfReach { step } => {
                write!(f, "no grasp can be reached with the object at step {step}")
            }
            CagingFailureReason::NoContact => write!(f, "no grasp in contact can be reached at the goal"),
            CagingFailureReason::NoPath => {
                write!(f, "no continuous motion after {} motions tried", self.statistics.motions)
            }
            CagingFailureReason::Iterations => {
                write!(f, "no motion found after {} motions tried", self.statistics.motions)
            }
            CagingFailureReason::Interrupted(interrupt) => write!(f, "{interrupt}"),
        }
    }
}

impl CagingStatistics {
    /// Adds the counts of another search.
    pub(super) fn add(&mut self, other: &Self) {
        self.inverse_calls += other.inverse_calls;
        self.states += other.states;
        self.motions += other.motions;
        for (&by, count) in &other.blocked {
            *self.blocked.entry(by).or_insert(0) += count;
        }
    }

    /// Counts what stopped a state or a motion; whether nothing did.
    pub(super) fn passes(&mut self, outcome: Result<(), Obstruction>) -> bool {
        if let Err(by) = outcome {
            *self.blocked.entry(by).or_insert(0) += 1;
        }
        outcome.is_ok()
    }
}
