//! What a planner or a map needs of an inverse-kinematics solver, whoever made it.

mod families;
mod preferences;

pub use families::{FamilyPath, IkFamily};
pub use preferences::{Aliases, Limits, PreferenceError, Preferences, VariableRange};

use crate::Pose;

/// Joint vectors that reach one pose, in the solver's branch order.
///
/// Cleared and refilled by each call, so that a loop allocates once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct IkSolutions {
    width: usize,
    values: Vec<f64>,
    families: Vec<IkFamily>,
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
        self.families.clear();
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

    /// The continua among the solutions; empty unless the solver was asked for them.
    pub fn families(&self) -> &[IkFamily] {
        &self.families
    }

    /// Adds a continuum through one of the solutions.
    pub fn push_family(&mut self, family: IkFamily) {
        self.families.push(family);
    }

    /// Keeps the first `count` solutions.
    pub fn truncate(&mut self, count: usize) {
        self.values.truncate(count.saturating_mul(self.width));
    }

    /// Puts the solutions in ascending order of `cost`; those of equal cost stay in their order. There must be no families.
    pub fn sort_by_cost(&mut self, cost: impl Fn(&[f64]) -> f64) {
        let mut order: Vec<(f64, &[f64])> = self.iter().map(|q| (cost(q), q)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.values = order.into_iter().flat_map(|(_, q)| q).copied().collect();
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
