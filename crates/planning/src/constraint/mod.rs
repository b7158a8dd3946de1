//! Conditions that every state of a path satisfies.

mod mechanism;
mod region;
mod upright;

pub use mechanism::HeldMechanism;
pub use region::{RegionError, RegionTolerance, TaskRegion};
pub use upright::Upright;

/// A path constraint that planners can move states onto (thesis algorithms 3.2 and 3.3).
///
/// The edge checker refuses states that violate it; projection makes samples and extensions that do not. Searches that race share it.
pub trait Constraint: Sync {
    /// Whether `q` satisfies the constraint.
    fn holds(&self, q: &[f64]) -> bool;

    /// Size of the straight motion by `difference`, such that if its ends satisfy the constraint and the size is no more
    /// than one, the states in between are as good. A norm.
    fn size(&self, difference: &[f64]) -> f64;

    /// Moves `q` to a nearby state that satisfies the constraint; `false` when none was found, and `q` is then lost.
    fn project(&self, q: &mut [f64]) -> bool;
}
