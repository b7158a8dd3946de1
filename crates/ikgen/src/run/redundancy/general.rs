//! Seven turning joints whose axes lie anyhow: between which values of a given one the number of solutions cannot change.
//!
//! With the given joint between others on the left side of Raghavan and Roth's equations ([`crate::kernel::six`]), these are linear in its
//! cosine and sine as in those of every joint, and their right side does not know it. So the determinant is a trigonometric polynomial of
//! both the sampled joint and the given one, known from its values on a grid, and where its roots in the first are single for all values
//! of the second no branch of solutions begins, ends or meets another. Limits are crossed elsewhere: each other joint is locked at
//! each of its limits, and the loop of the remaining six is solved.

use robotc_core::Pose;
use robotc_core::ik::VariableRange;

use super::determinant::Equations;
use super::two_angles::TwoAngles;
use crate::kernel::math::{angle_of, cos_sin};
use crate::kernel::six::{ORDERS, Order, six, waves_of};
use crate::kernel::vector::{Line, Motion, plus, times};
use crate::kernel::waves::MAX_DEGREE;
use crate::run::{Solver, TrueChain, frame};

/// Cells that a piece is cut into before cells are halved.
const FIRST: usize = 64;

/// Cells in doubt after which a piece is left to a nearer look at what is in doubt.
const MOST_OPEN: usize = 10_000;

/// Doubt narrower than this is left, radians: where determinants of all orders have double roots.
const ENOUGH: f64 = 5e-5;

/// How often doubt is looked at, the first time over the whole range.
const DEPTH: usize = 2;

/// Nearer looks at most, all together.
const MOST_VIEWS: usize = 60;

/// Waves below this part of the largest are rounding.
const ROUNDING: f64 = 1e-9;

/// Seven lines about which the joints turn at zero, and the motion that takes the tip from there to the pose.
#[derive(Debug, Clone)]
pub(super) struct Seven {
    lines: [Line; 7],
    goal: Motion,
}

impl Seven {
    /// Of a chain of seven joints that all turn, each by its own variable.
    pub(super) fn of(chain: &TrueChain, base_from_tip: &Pose) -> Option<Self> {
        let (lines, tip) = chain.lines()?;
        let lines: [Line; 7] = lines.try_into().ok()?;
        let at = |f: &crate::kernel::chain::Frame| Motion { rows: f.rotation, place: f.position };
        let (wanted, back) = (at(&frame(base_from_tip)), at(&tip).inverse());
        let columns =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| wanted.turned(back.turned(e)));
        let rows = [0, 1, 2].map(|i| columns.map(|column| column[i]));
        Some(Self { lines, goal: Motion { rows, place: plus(wanted.turned(back.place), wanted.place) } })
    }

    /// The loop of the other six with one joint turned.
    fn locked(&self, joint: usize, turn: [f64; 2]) -> ([Line; 6], Motion) {
        let own = self.lines[joint];
        let lines =
            std::array::from_fn(
                |i| {
                    if i < joint { self.lines[i] } else { own.moved(&self.lines[i + 1], turn) }
                },
            );
        (lines, undone(&self.goal, &own, turn))
    }

    /// The loop run from another joint on, in either direction, such that the given joint is at this place of seven.
    fn arranged(&self, given: usize, place: usize, reversed: bool) -> Self {
        let goal = if reversed { self.goal.inverse() } else { self.goal };
        let undo = goal.inverse();
        let lines = std::array::from_fn(|i| {
            let at = (if reversed { 6 - given } else { given }) + 7 + i - place;
            let mut line = self.lines[if reversed { 6 - at % 7 } else { at % 7 }];
            if reversed {
                line.direction = times(line.direction, -1.0);
            }
            // e1 X = G is X (G^-1 e1 G) = G.
            match at / 7 {
                0 => goal.moved(&line),
                1 => line,
                _ => undo.moved(&line),
            }
        });
        Self { lines, goal }
    }

    /// Stretches between `low` and `high` of a given joint in which the number of solutions may change, ascending: no wider than `width`
    /// where rounding allows.
    ///
    /// Where two solutions share the sampled joint its determinant has a double root that means nothing; so every order of elimination is
    /// asked before a cell is cut in two. Where it is all but zero it is looked at again nearby.
    pub(super) fn unsteady(&self, given: usize, [low, high]: [f64; 2], width: f64) -> Vec<[f64; 2]> {
        let orders: Vec<Equations> = [(3, true), (4, false), (4, true), (5, false), (5, true), (3, false)]
            .into_iter()
            .filter_map(|(place, reversed)| {
                let loop_of = self.arranged(given, place, reversed);
                Equations::new(&loop_of.lines, &loop_of.goal, place, reversed)
            })
            .collect();
        let mut open = vec![[low, high]];
        let mut views = 0;
        for _ in 0..DEPTH {
            let (narrow, wide): (Vec<_>, Vec<_>) =
                open.into_iter().partition(|[low, high]| high - low <= ENOUGH.max(4.0 * width));
            open = narrow;
            for piece in wide {
                views += 1;
                if views > MOST_VIEWS {
                    open.push(piece);
                } else {
                    open.extend(unsteady_in(&orders, piece, width));
                }
            }
            open = super::united(open);
        }
        open
    }

    /// Values of the given joint at which another one comes to a limit on a solution that keeps the rest.
    pub(super) fn crossings(
        &self,
        solver: &Solver,
        base_from_tip: &Pose,
        given: usize,
        ranges: &[VariableRange],
    ) -> Vec<f64> {
        let mut found = Vec::new();
        for joint in (0..7).filter(|joint| *joint != given) {
            let range = ranges[joint];
            for limit in [range.lower, range.upper].into_iter().filter(|x| x.is_finite()) {
                for values in self.solved(solver, base_from_tip, joint, limit) {
                    let keeps = |v: usize| v == joint || ranges[v].nearest(values[v], 0.0).is_some();
                    if (0..7).all(keeps) {
                        found.extend(ranges[given].aliases(values[given], 0.0));
                    }
                }
            }
        }
        found
    }

    /// All joint vectors with one joint at a value: by every order of elimination.
    fn solved(&self, solver: &Solver, base_from_tip: &Pose, joint: usize, value: f64) -> Vec<[f64; 7]> {
        let (lines, goal) = self.locked(joint, cos_sin(value));
        let goal_frame = frame(base_from_tip);
        let mut held = [false; 7];
        held[joint] = true;
        let arm = solver.chain.arm(&held);
        let mut found: Vec<[f64; 7]> = Vec::new();
        for code in 0..ORDERS {
            let waves = waves_of(&lines, &goal, code);
            let sizes: Vec<f64> = (0..=MAX_DEGREE).map(|k| waves.size(k)).collect();
            let largest = sizes.iter().fold(0.0, |a: f64, x| a.max(*x));
            let degree = (1..=MAX_DEGREE).rev().find(|k| sizes[*k] > ROUNDING * largest);
            let Some(degree) = degree.filter(|_| largest > 1e-25) else { continue };
            let candidates = six(&lines, &goal, &[Order { code, degree, squared: false }], 0.0);
            for i in 0..candidates.count() {
                let mut steps = candidates.get(i).to_vec();
                steps.insert(joint, cos_sin(value));
                let mut values: [f64; 7] = std::array::from_fn(|v| angle_of(steps[v][1], steps[v][0]));
                values[joint] = value;
                if arm.settle(&goal_frame, &steps, &mut values)
                    && !found.iter().any(|other| arm.same(&values, other))
                {
                    found.push(values);
                }
            }
        }
        found
    }
}

/// The stretches of a piece in which no order is sure of the number of solutions.
fn unsteady_in(orders: &[Equations], [low, high]: [f64; 2], width: f64) -> Vec<[f64; 2]> {
    let half = 0.5 * (high - low);
    // A little off the middle, where axes may line up.
    let centre = 0.5 * (low + high) + 0.0137 * half;
    let whole = half > 1.5;
    let scale = if whole { 1.0 } else { libm::tan(0.5 * half) };
    let seen = |x: f64| {
        if whole { x - centre } else { 2.0 * libm::atan(libm::tan(0.5 * (x - centre)) / scale) }
    };
    let mut polynomials: Vec<(usize, TwoAngles)> =
        orders.iter().filter_map(|order| Some((0, order.seen(centre, scale)?))).collect();
    let step = (high - low) / FIRST as f64;
    let end = |k: usize| if k == FIRST { high } else { low + step * k as f64 };
    let mut open: Vec<[f64; 2]> = (0..FIRST).map(|k| [end(k), end(k + 1)]).collect();
    let mut level = 0;
    loop {
        open.retain(|[low, high]| {
            let steady = polynomials.iter_mut().find(|(_, p)| p.is_steady(seen(*low), seen(*high)));
            steady.map(|(settled, _)| *settled += 1).is_none()
        });
        // Those that settle most are asked first, those that settle nothing not for long: their determinant is a square.
        level += 1;
        polynomials.retain(|(settled, _)| *settled > 0 || level < 5);
        polynomials.sort_by_key(|(settled, _)| std::cmp::Reverse(*settled));
        let done = open.first().is_none_or(|[low, high]| high - low <= width);
        if done || polynomials.is_empty() || open.len() > MOST_OPEN {
            return super::united(open);
        }
        open = open
            .into_iter()
            .flat_map(|[low, high]| {
                let middle = 0.5 * (low + high);
                [[low, middle], [middle, high]]
            })
            .collect();
    }
}

/// A motion after a turn has been undone.
fn undone(motion: &Motion, line: &Line, turn: [f64; 2]) -> Motion {
    let back = [turn[0], -turn[1]];
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let columns = unit.map(|e| motion.turned(line.turned(e, back)));
    let rows = [0, 1, 2].map(|i| columns.map(|column| column[i]));
    Motion { rows, place: plus(motion.turned(line.carried([0.0; 3], back)), motion.place) }
}
