//! The independent checker: solutions substituted in the loop equation by plain forward kinematics.
//!
//! Nothing here comes from the solver: poses are nalgebra's, kinematics those of the chain as described.

use robotc_core::Pose;
use robotc_core::model::SerialChain;

/// How far a joint vector is from a pose: the larger of metres and Frobenius norm of the rotation difference; infinite
/// when a value is not a number.
pub fn distance(chain: &SerialChain, values: &[f64], base_from_tip: &Pose) -> f64 {
    if values.len() != chain.variables.len() || values.iter().any(|v| !v.is_finite()) {
        return f64::INFINITY;
    }
    let reached = chain.forward(values);
    let position = (reached.translation.vector - base_from_tip.translation.vector).norm();
    let rotation = (reached.rotation.to_rotation_matrix().into_inner()
        - base_from_tip.rotation.to_rotation_matrix().into_inner())
    .norm();
    position.max(rotation)
}

/// Whether two joint vectors are the same within `tolerance`, angles modulo a full turn; `slides` marks lengths.
pub fn same(a: &[f64], b: &[f64], slides: &[bool], tolerance: f64) -> bool {
    use std::f64::consts::TAU;
    a.iter().zip(b).zip(slides).all(|((a, b), slides)| {
        let d = if *slides { a - b } else { (a - b) - ((a - b) / TAU).round() * TAU };
        d.abs() < tolerance
    })
}
