//! The type of goal that a chain's freedom suggests.

use robotc_core::model::SerialChain;

use super::lock::freedom;
use crate::GoalType;

/// In the order in which they are preferred where several suit.
const ORDER: [GoalType; 10] = [
    GoalType::Transform6D,
    GoalType::TranslationDirection5D,
    GoalType::TranslationZAxisAngle4D,
    GoalType::Ray4D,
    GoalType::Translation3D,
    GoalType::Rotation3D,
    GoalType::TranslationXYOrientation3D,
    GoalType::Direction3D,
    GoalType::Lookat3D,
    GoalType::TranslationXY2D,
];

/// The type that fixes as much as the chain moves: each of its goals near the chain has solutions, and finitely many.
///
/// [`Transform6D`](GoalType::Transform6D) for six joints and more, and where no other suits: then the poses that the chain reaches
/// are the goals.
pub fn natural(chain: &SerialChain) -> GoalType {
    let suits = |goal: &GoalType| {
        if goal.constraints() != chain.variables.len() {
            return false;
        }
        let longer = goal.extended(chain);
        let given = goal.given_variables(chain.variables.len());
        freedom(&longer, &given) == longer.variables.len() - given.len()
    };
    ORDER.into_iter().find(suits).unwrap_or_default()
}
