//! What is known beforehand about how well an arm reaches a pose: grasps are tried in its order.

use robotc_core::Pose;

/// A model of an arm's reach, such as a precomputed map. It ranks and never rejects, so it may be coarse.
pub trait Reachability {
    /// How well the tip of the arm reaches a pose in the frame of its base: 0 (not at all, as far as is known) to 1.
    fn density(&self, base_from_tip: &Pose) -> f64;
}
