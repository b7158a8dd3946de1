//! Six turning joints in general, on a chain that is given at load.
//!
//! The branches of a calibrated arm are not all near those of the arm that its equations were written for: where two of the nominal arm
//! have fallen together, or have just been lost, there may be two. The general solver needs no nominal arm.

use super::candidate::Arm;
use super::chain::{Frame, MAX_JOINTS};
use super::math::cos_sin;
use super::six::{Candidates, Order, six};
use super::vector::{Line, Motion};

/// Candidates for a pose: turns of the joints that are not held, of which there are six, each by its own variable in order; `values` are
/// those of the held ones.
pub fn as_given(arm: &Arm<'_>, base_from_tip: &Frame, values: &[f64], orders: &[Order]) -> Candidates {
    let mut at = Frame { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], position: [0.0; 3] };
    let mut lines = [Line { direction: [0.0; 3], point: [0.0; 3] }; 6];
    let mut count = 0;
    for (i, link) in arm.links.iter().enumerate() {
        at = at.times(&link.previous_from_joint);
        if arm.held[i] {
            let [c, s] = cos_sin(values[i]);
            let rotation = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
            at = at.times(&Frame { rotation, position: [0.0; 3] });
        } else if count < 6 {
            lines[count] = Line { direction: at.rotation.map(|row| row[2]), point: at.position };
            count += 1;
        }
    }
    let tip = at.times(arm.last_from_tip);
    let back = Motion { rows: tip.rotation, place: tip.position }.inverse();
    let goal = base_from_tip.times(&Frame { rotation: back.rows, position: back.place });
    six(&lines, &Motion { rows: goal.rotation, place: goal.position }, orders, 0.0)
}

/// A candidate as `[cos, sin]` of each variable.
pub fn with_given(arm: &Arm<'_>, turns: [[f64; 2]; 6], values: &[f64]) -> [[f64; 2]; MAX_JOINTS] {
    let mut steps = [[1.0, 0.0]; MAX_JOINTS];
    let mut taken = 0;
    for i in 0..values.len() {
        if arm.held[i] {
            steps[i] = cos_sin(values[i]);
        } else if taken < 6 {
            steps[i] = turns[taken];
            taken += 1;
        }
    }
    steps
}
