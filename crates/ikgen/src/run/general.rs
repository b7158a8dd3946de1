//! Six turning joints in general, on the chain that is given at load.
//!
//! The branches of a calibrated arm are not all near those of the arm that its program was written for: where two of the nominal arm
//! have fallen together, or have just been lost, there may be two. The general solver needs no nominal arm, and finds them on the
//! calibrated one.

use super::TrueChain;
use crate::kernel::chain::{Frame, MAX_JOINTS};
use crate::kernel::math::cos_sin;
use crate::kernel::six::{Order, six};
use crate::kernel::vector::{Line, Motion};
use crate::orders::orders;

/// Poses on which orders of elimination are compared, at each load.
const POSES: usize = 8;

/// A chain of which six joints turn by variables of their own, and the others, if any, are given.
#[derive(Debug, Clone)]
pub(super) struct General {
    orders: Vec<Order>,
}

impl General {
    /// For a chain with these variables given; nothing for other kinds of chains.
    pub(super) fn new(chain: &TrueChain, held: &[bool]) -> Option<Self> {
        let turns =
            chain.links.iter().enumerate().all(|(i, l)| !l.slides && l.ratio == 1.0 && l.variable == i);
        let unknown = held[..chain.variables].iter().filter(|held| !**held).count();
        if !turns || unknown != 6 || chain.variables > 7 {
            return None;
        }
        let mut given = None;
        let mut axes = Vec::new();
        let at_zero = [0.0; MAX_JOINTS];
        for (i, line) in lines(chain, &at_zero, &[true; MAX_JOINTS]).0.into_iter().enumerate() {
            if held[i] {
                given = Some((axes.len(), line));
            } else {
                axes.push(line);
            }
        }
        let orders = orders(&axes.try_into().ok()?, given, POSES);
        (!orders.is_empty()).then_some(Self { orders })
    }

    /// Offers the candidates for a pose, as `[cos, sin]` of each variable, while `offer` wants more; `values` are those of the given
    /// variables.
    pub(super) fn candidates(
        &self,
        chain: &TrueChain,
        held: &[bool],
        base_from_tip: &Frame,
        values: &[f64; MAX_JOINTS],
        mut offer: impl FnMut(&[[f64; 2]]) -> bool,
    ) {
        let (all, tip) = lines(chain, values, held);
        let unknown: Vec<Line> =
            all.iter().zip(held).filter(|(_, held)| !**held).map(|(line, _)| *line).collect();
        let Ok(axes) = unknown.try_into() else { return };
        let goal = base_from_tip.times(&inverse(&tip));
        let goal = Motion { rows: goal.rotation, place: goal.position };
        let found = six(&axes, &goal, &self.orders, 0.0);
        for i in 0..found.count() {
            let mut turns = found.get(i).into_iter();
            let mut steps = [[1.0, 0.0]; MAX_JOINTS];
            for (step, (held, value)) in steps.iter_mut().zip(held.iter().zip(values)).take(chain.variables) {
                *step = if *held { cos_sin(*value) } else { turns.next().expect("six are unknown") };
            }
            if !offer(&steps[..chain.variables]) {
                return;
            }
        }
    }
}

/// The axis of each joint, and the tip, where the marked variables have these values and the others are zero.
fn lines(chain: &TrueChain, values: &[f64; MAX_JOINTS], marked: &[bool]) -> (Vec<Line>, Frame) {
    let mut at = Frame { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], position: [0.0; 3] };
    let mut found = Vec::new();
    for link in &chain.links {
        at = at.times(&link.previous_from_joint);
        found.push(Line { direction: at.rotation.map(|row| row[2]), point: at.position });
        if marked[link.variable] {
            let [c, s] = cos_sin(values[link.variable]);
            let turn = Frame { rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], position: [0.0; 3] };
            at = at.times(&turn);
        }
    }
    (found, at.times(&chain.last_from_tip))
}

fn inverse(frame: &Frame) -> Frame {
    let back = Motion { rows: frame.rotation, place: frame.position }.inverse();
    Frame { rotation: back.rows, position: back.place }
}
