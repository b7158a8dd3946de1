//! Six turning joints in general, on the chain that is given at load ([`crate::kernel::as_given`]).

use super::TrueChain;
use crate::kernel::as_given::{as_given, with_given};
use crate::kernel::candidate::Arm;
use crate::kernel::chain::Frame;
use crate::kernel::six::Order;
use crate::kernel::vector::Line;
use crate::orders::{Known, orders};

/// Poses on which orders of elimination are compared, at each load.
const POSES: usize = 8;

/// A chain of which six joints turn by variables of their own, and one more, if any, is given.
#[derive(Debug, Clone)]
pub(super) struct General {
    orders: Vec<Order>,
}

impl General {
    /// For a chain with these variables given; nothing for other kinds of chains.
    pub(super) fn new(chain: &TrueChain, held: &[bool]) -> Option<Self> {
        let (axes, given) = six_lines(chain, held)?;
        let orders = orders(&axes, given.map(Known::from).as_slice(), POSES);
        (!orders.is_empty()).then_some(Self { orders })
    }

    /// Offers the candidates for a pose, as `[cos, sin]` of each variable, while `offer` wants more; `values` are those of the given
    /// variables.
    pub(super) fn candidates(
        &self,
        arm: &Arm<'_>,
        base_from_tip: &Frame,
        values: &[f64],
        mut offer: impl FnMut(&[[f64; 2]]) -> bool,
    ) {
        let found = as_given(arm, base_from_tip, values, &self.orders);
        for i in 0..found.count() {
            let steps = with_given(arm, found.get(i), values);
            if !offer(&steps[..values.len()]) {
                return;
            }
        }
    }
}

/// Lines at zero of the six joints that are not held, and after how many of them the held one comes, if there is one, and its line.
pub(crate) type SixLines = ([Line; 6], Option<(usize, Line)>);

/// The axes of a chain of which six joints turn by variables of their own and one more, at most, is held.
pub(crate) fn six_lines(chain: &TrueChain, held: &[bool]) -> Option<SixLines> {
    let (mut axes, mut given) = (Vec::new(), None);
    for (line, held) in chain.lines()?.0.into_iter().zip(held) {
        if *held {
            if given.replace((axes.len(), line)).is_some() {
                return None;
            }
        } else {
            axes.push(line);
        }
    }
    Some((axes.try_into().ok()?, given))
}
