//! Conditions that every state of a path satisfies.

/// A path constraint that planners can move states onto (thesis algorithms 3.2 and 3.3).
///
/// The edge checker refuses states that violate it; projection makes samples and extensions that do not.
pub trait Constraint {
    /// Moves `q` to a nearby state that satisfies the constraint; `false` when none was found, and `q` is then lost.
    fn project(&self, q: &mut [f64]) -> bool;
}
