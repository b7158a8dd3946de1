//! Orders of elimination for arms that a calibration has measured: near the described one, but in general position.

use robotc_core::Seed;
use robotc_core::rng::Rng;

use crate::kernel::six::Order;
use crate::kernel::vector::{Line, cross, plus, times};
use crate::orders::{Known, orders};
use crate::run::{TrueChain, six_lines};

/// Poses on which orders are compared.
const POSES: usize = 24;

/// How far axes and origins of a measured arm may be from those of the described one, radians and metres.
const OFF: (f64, f64) = (7e-3, 1e-3);

/// The orders in which the general solver is asked on a measured arm; nothing unless six joints turn, each by its own variable, and one
/// more, at most, is given.
pub(crate) fn orders_of_measured(chain: &TrueChain, held: &[bool]) -> Vec<Order> {
    let Some((mut axes, mut given)) = six_lines(chain, held) else { return Vec::new() };
    let mut rng = Seed::new(0).split("ikgen measured").rng();
    for line in axes.iter_mut().chain(given.as_mut().map(|(_, line)| line)) {
        *line = near(line, &mut rng);
    }
    orders(&axes, given.map(Known::from).as_slice(), POSES)
}

fn near(line: &Line, rng: &mut Rng) -> Line {
    let turn = times(rng.direction().into_inner().into(), OFF.0);
    let shift = times(rng.direction().into_inner().into(), OFF.1);
    let direction = plus(line.direction, cross(turn, line.direction));
    let size = libm::sqrt(direction.iter().map(|x| x * x).sum());
    Line { direction: times(direction, 1.0 / size), point: plus(line.point, shift) }
}
