//! The type of goal that a chain's freedom suggests.

use nalgebra::Vector3;
use robotc_core::Seed;
use robotc_core::model::SerialChain;

use super::lock::freedom;
use crate::GoalType;
use crate::jacobian::jacobian;

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
        if *goal == GoalType::TranslationZAxisAngle4D && !tilts(chain) {
            return false;
        }
        let longer = goal.extended(chain);
        let given = goal.given_variables(chain.variables.len());
        freedom(&longer, &given) == longer.variables.len() - given.len()
    };
    ORDER.into_iter().find(suits).unwrap_or_default()
}

/// Whether a chain of four joints changes the place of its tip and the angle of its direction to the vertical independently.
fn tilts(chain: &SerialChain) -> bool {
    let mut rng = Seed::new(0).split("ikgen natural").rng();
    let values = crate::report::poses::random(chain, &mut rng);
    let direction = chain.forward(&values).rotation * Vector3::z();
    let columns = jacobian(chain, &values);
    let change = |column: &[f64; 6]| Vector3::new(column[3], column[4], column[5]).cross(&direction).z;
    let rate = |i: usize, j: usize| if i < 3 { columns[j][i] } else { change(&columns[j]) };
    nalgebra::DMatrix::from_fn(4, columns.len(), rate).rank(1e-3) == 4
}
