//! In which orders the unknowns of six turning joints are eliminated.
//!
//! The axes of real arms are parallel, meet and stand at right angles so often that in most orders the elimination breaks down (see
//! [`crate::kernel::six`]). Each is tried on random poses.

use robotc_core::Seed;
use robotc_core::rng::Rng;

use crate::kernel::math::cos_sin;
use crate::kernel::six::{MOST_ORDERS, ORDERS, Order, six, waves_of};
use crate::kernel::vector::{Line, Motion, plus, times};
use crate::kernel::waves::{MAX_DEGREE, Waves};

/// Waves below this part of the largest are rounding.
const ROUNDING: f64 = 1e-11;

/// The orders that find random joint vectors again, best first: those that miss fewest, then those of the lowest degree, then
/// the most exact. Orders after the first are only asked where it fails, so they differ in the angle that is found first.
///
/// `axes` are those of the six joints with all turns zero; `given` ones move the later ones. Orders are compared on so many `poses`.
pub(crate) fn orders(axes: &[Line; 6], given: &[Known], poses: usize) -> Vec<Order> {
    let mut rng = Seed::new(0).split("ikgen orders").rng();
    let trials: Vec<Trial> = (0..poses).map(|_| trial(axes, given, &mut rng)).collect();
    let mut ranked: Vec<(usize, usize, f64, Order)> = Vec::new();
    for code in 0..ORDERS {
        let degree = trials.iter().map(|t| degree(&waves_of(&t.lines, &t.goal, code))).max();
        let degree = degree.unwrap_or(MAX_DEGREE);
        if degree == 0 {
            continue;
        }
        for squared in [true, false] {
            let order = Order { code, degree, squared };
            if squared && degree % 2 != 0 {
                continue;
            }
            let errors: Vec<f64> = trials.iter().map(|t| error(t, order)).collect();
            let missed = errors.iter().filter(|e| **e >= 1e-6 || e.is_nan()).count();
            // In whole decades, so that rounding does not choose.
            let decades: f64 = errors.iter().map(|e| libm::log10(e.clamp(1e-15, 1.0))).sum();
            let exactness = libm::round(decades / poses as f64);
            if missed * 2 < poses {
                let degree = if squared { degree / 2 } else { degree };
                ranked.push((missed, degree, exactness, order));
            }
        }
    }
    ranked
        .sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)).then(a.3.code.cmp(&b.3.code)));
    let mut chosen: Vec<Order> = Vec::new();
    for (.., order) in ranked {
        if chosen.len() < MOST_ORDERS && chosen.iter().all(|o| o.code / 2 != order.code / 2) {
            chosen.push(order);
        }
    }
    chosen
}

/// A given joint between those that are found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known {
    /// How many of the six come before it.
    pub(crate) before: usize,
    /// Its axis.
    pub(crate) line: Line,
    /// Whether it slides along that.
    pub(crate) slides: bool,
}

impl From<(usize, Line)> for Known {
    /// A turn after so many of the six.
    fn from((before, line): (usize, Line)) -> Self {
        Self { before, line, slides: false }
    }
}

/// A random joint vector, and the loop that it closes.
struct Trial {
    lines: [Line; 6],
    goal: Motion,
    turns: [[f64; 2]; 6],
}

fn trial(axes: &[Line; 6], given: &[Known], rng: &mut Rng) -> Trial {
    let mut turn = || cos_sin(rng.range(-std::f64::consts::PI, std::f64::consts::PI));
    let mut lines = *axes;
    for known in given.iter().rev() {
        let turn = turn();
        for later in &mut lines[known.before..] {
            if known.slides {
                later.point = plus(later.point, times(known.line.direction, turn[1]));
            } else {
                *later = known.line.moved(later, turn);
            }
        }
    }
    let turns: [[f64; 2]; 6] = std::array::from_fn(|_| turn());
    let along = |v: [f64; 3], point: bool| {
        lines
            .iter()
            .zip(turns)
            .rev()
            .fold(v, |v, (line, turn)| if point { line.carried(v, turn) } else { line.turned(v, turn) })
    };
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| along(e, false));
    let rows = [0, 1, 2].map(|i| [x[i], y[i], z[i]]);
    Trial { goal: Motion { rows, place: along([0.0; 3], true) }, lines, turns }
}

/// How far the nearest candidate is from the joint vector that the trial was made from.
fn error(trial: &Trial, order: Order) -> f64 {
    let found = six(&trial.lines, &trial.goal, &[order], 0.0);
    let gap = |turns: [[f64; 2]; 6]| {
        turns
            .iter()
            .zip(&trial.turns)
            .map(|(a, b)| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()))
            .fold(0.0, f64::max)
    };
    (0..found.count()).map(|i| gap(found.get(i))).fold(f64::INFINITY, f64::min)
}

/// Highest wave that is more than rounding; zero where all of them are.
fn degree(waves: &Waves) -> usize {
    let sizes: Vec<f64> = (0..=MAX_DEGREE).map(|k| waves.size(k)).collect();
    let largest = sizes.iter().fold(0.0, |a: f64, b| a.max(*b));
    if largest.is_nan() || largest < 1e-25 {
        return 0;
    }
    (0..=MAX_DEGREE).rev().find(|k| sizes[*k] > ROUNDING * largest).unwrap_or(0)
}
