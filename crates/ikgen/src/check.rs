//! The independent checker: solutions substituted in the loop equation by plain forward kinematics.
//!
//! Nothing here comes from the solver: poses are nalgebra's, kinematics those of the chain as described.

use robotc_core::Pose;
use robotc_core::model::SerialChain;

use crate::GoalType;

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

/// How far a joint vector is from what a goal type takes of a pose; `given` are the values that its goals have besides.
///
/// The larger of metres and differences of directions; of lines also the distance of one from a point of the other.
pub fn goal_distance(
    goal: GoalType,
    chain: &SerialChain,
    values: &[f64],
    given: &[f64],
    base_from_tip: &Pose,
) -> f64 {
    if values.len() != chain.variables.len() || values.iter().any(|v| !v.is_finite()) {
        return f64::INFINITY;
    }
    let reached = chain.forward(values);
    let axis =
        |pose: &Pose, axis: usize| pose.rotation.to_rotation_matrix().into_inner().column(axis).into_owned();
    let off = base_from_tip.translation.vector - reached.translation.vector;
    let turned = |k: usize| (axis(&reached, k) - axis(base_from_tip, k)).norm();
    let angle = |k: usize| {
        let cosine = axis(&reached, 2).dot(&axis(base_from_tip, k));
        (cosine - given.last().map_or(f64::NAN, |angle| libm::cos(*angle))).abs()
    };
    // In front of the tip, across its direction.
    let sight = off.dot(&axis(&reached, 2));
    let across = off.cross(&axis(&reached, 2)).norm();
    match goal {
        GoalType::Transform6D => distance(chain, values, base_from_tip),
        GoalType::Rotation3D => turned(0).max(turned(1)).max(turned(2)),
        GoalType::Translation3D => off.norm(),
        GoalType::Direction3D => turned(2),
        GoalType::Ray4D => across.max(turned(2)),
        GoalType::Lookat3D => across.max(-sight),
        GoalType::TranslationDirection5D
        | GoalType::TranslationXAxisAngleZNorm4D
        | GoalType::TranslationYAxisAngleXNorm4D
        | GoalType::TranslationZAxisAngleYNorm4D => off.norm().max(turned(2)),
        GoalType::TranslationXY2D => off.xy().norm(),
        GoalType::TranslationXYOrientation3D => off.xy().norm().max(turned(0)),
        GoalType::TranslationLocalGlobal6D => match given {
            [.., x, y, z] => {
                let p_in_base = reached.transform_point(&nalgebra::Point3::new(*x, *y, *z));
                (p_in_base.coords - base_from_tip.translation.vector).norm()
            }
            _ => f64::INFINITY,
        },
        GoalType::TranslationXAxisAngle4D => off.norm().max(angle(0)),
        GoalType::TranslationYAxisAngle4D => off.norm().max(angle(1)),
        GoalType::TranslationZAxisAngle4D => off.norm().max(angle(2)),
    }
}

/// Whether two joint vectors are the same within `tolerance`, angles modulo a full turn; `slides` marks lengths.
pub fn same(a: &[f64], b: &[f64], slides: &[bool], tolerance: f64) -> bool {
    use std::f64::consts::TAU;
    a.iter().zip(b).zip(slides).all(|((a, b), slides)| {
        let d = if *slides { a - b } else { (a - b) - ((a - b) / TAU).round() * TAU };
        d.abs() < tolerance
    })
}
