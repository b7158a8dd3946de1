//! What a planner or a map needs of an inverse-kinematics solver, whoever made it.

use crate::Pose;

/// Joint vectors that reach one pose, in the solver's branch order.
///
/// Cleared and refilled by each call, so that a loop allocates once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct IkSolutions {
    width: usize,
    values: Vec<f64>,
}

impl IkSolutions {
    /// An empty set.
    pub fn new() -> Self {
        Self::default()
    }

    /// Empties the set and fixes the number of joint values of each solution.
    pub fn reset(&mut self, width: usize) {
        self.width = width;
        self.values.clear();
    }

    /// Adds one solution; `joints` has the width given to [`reset`](Self::reset).
    pub fn push(&mut self, joints: &[f64]) {
        assert_eq!(joints.len(), self.width, "a solution has one value for each chain variable");
        self.values.extend_from_slice(joints);
    }

    /// Number of solutions.
    pub fn len(&self) -> usize {
        self.values.len().checked_div(self.width).unwrap_or(0)
    }

    /// Whether the pose has no solution.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The solutions, each a joint vector of the chain in radians or metres, base to tip.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.values.chunks_exact(self.width.max(1))
    }
}

/// A solver for one serial chain.
pub trait InverseKinematics: Send + Sync {
    /// Number of chain variables: the length of each solution.
    fn variables(&self) -> usize;

    /// Positions of the variables whose value the caller chooses, ascending; empty when the chain has as many
    /// variables as the pose has constraints.
    fn free_variables(&self) -> &[usize];

    /// All isolated joint vectors with forward kinematics `base_from_tip`, given the values of the free variables.
    ///
    /// Angles come in (-pi, pi]; joint limits are not applied. Every returned solution satisfies the pose to 1e-9
    /// (metres, and Frobenius norm of the rotation difference). At a singular pose with a continuum of solutions a
    /// representative is returned.
    fn solve(&self, base_from_tip: &Pose, free: &[f64], out: &mut IkSolutions);
}
