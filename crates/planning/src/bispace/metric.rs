//! Distances for robots with a base, and when to follow the tool.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::space::Space;

/// How the nearest configuration of the tree is chosen, and how long a step is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TreeMetric {
    /// The metric of the space.
    Plain,
    /// `w * base distance + (1 - w) * arm distance`, with `w` falling as the base is farther from the goal (thesis equation
    /// 3.15): far away the base takes long steps, near the goal the arm explores.
    Mixed,
}

/// How likely a new configuration tries to follow the tool's tree.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FollowProbability {
    /// Always the same, but for dead ends: where following ended before, it is tried less often.
    Constant(f64),
    /// One near the goal, falling with the distance of the base from it; at least the given value.
    Near(f64),
}

/// `exp(-d^2 / (2 sigma^2))` for a base `distance` away from a goal and an arm of length `reach`.
pub(super) fn nearness(distance: f64, reach: f64) -> f64 {
    libm::exp(-0.5 * (distance / reach) * (distance / reach))
}

/// Base and arm are never ignored altogether.
const SHARE: (f64, f64) = (0.1, 0.9);

/// Distances in the space of a robot with a base.
pub(super) struct Mixed<'a> {
    space: &'a Space,
    /// Whether each coordinate is one of the base.
    of_base: Vec<bool>,
}

impl<'a> Mixed<'a> {
    pub(super) fn new(space: &'a Space, base: &[usize]) -> Self {
        let of_base = (0..space.dimension()).map(|i| base.contains(&i)).collect();
        Self { space, of_base }
    }

    /// Distance with the base's share as at a configuration with this nearness to the goal.
    pub(super) fn distance(&self, nearness: f64, from: &[f64], to: &[f64]) -> f64 {
        let share = nearness.clamp(SHARE.0, SHARE.1);
        let difference = self.space.difference(from, to);
        let (mut base, mut arm) = (0.0, 0.0);
        for ((axis, d), &of_base) in self.space.axes().iter().zip(difference).zip(&self.of_base) {
            let d = axis.weight * d;
            *(if of_base { &mut base } else { &mut arm }) += d * d;
        }
        share * base.sqrt() + (1.0 - share) * arm.sqrt()
    }

    /// The largest distance with equal shares.
    pub(super) fn diameter(&self) -> f64 {
        let (mut base, mut arm) = (0.0, 0.0);
        for (axis, &of_base) in self.space.axes().iter().zip(&self.of_base) {
            let extent = axis.weight * if axis.wraps { PI } else { axis.upper - axis.lower };
            *(if of_base { &mut base } else { &mut arm }) += extent * extent;
        }
        0.5 * base.sqrt() + 0.5 * arm.sqrt()
    }
}
