//! From how many sides a set of grasps approaches.

use nalgebra::{Unit, Vector3};
use robotc_planning::grasp::Grasp;

/// Number of ranges of directions: three dominant axes and the signs of all coordinates.
pub(super) const DIRECTIONS: usize = 24;

/// The range that a direction is in.
pub(super) fn direction_range(direction: &Unit<Vector3<f64>>) -> usize {
    let sign = |axis: usize| usize::from(direction[axis] < 0.0) << axis;
    direction.iamax() * 8 + sign(0) + sign(1) + sign(2)
}

/// The number of ranges with at least one direction of approach.
pub(super) fn coverage(grasps: &[Grasp]) -> usize {
    let mut seen = [false; DIRECTIONS];
    grasps.iter().for_each(|grasp| seen[direction_range(&grasp.approach_in_object)] = true);
    seen.into_iter().filter(|seen| *seen).count()
}
