//! Loops of six unknowns of which one slides or moves several joints, however their axes lie.
//!
//! The numeric kernel sweeps that unknown (see [`crate::kernel::sweep`]), in orders that are found here by trial. Chains with fewer
//! unknowns are completed by turning joints at the tip that do not exist and must come out at zero.

use robotc_core::Seed;
use robotc_core::model::ChainMotion;
use robotc_core::rng::Rng;

use super::builder::{Builder, Move, Scalar, Turn, Vector};
use super::facts::{Axis, Facts};
use super::problem::{OFF_ZERO, goal_of};
use super::strategies::Line as Symbolic;
use crate::kernel::math::cos_sin;
use crate::kernel::six::ORDERS;
use crate::kernel::sweep::{
    MOST_LINES, MOST_ORDERS, MOST_PLACES, NUMBERS, ORDER_NUMBERS, clusters_of, fall_of, still_joint, sweep_of,
};
use crate::kernel::vector::{Line, Motion, times};

/// Poses on which all orders are tried, and those that miss fewest once more.
const POSES: [usize; 2] = [2, 8];

/// Poses at which there must be roots where there are some whatever the goal.
const WITNESSES: usize = 7;

/// Distances, in lengths or angles, from which it is seen how many they are.
const DISTANCE: f64 = 1e-2;

/// Places are written to this: rounding has moved them.
const ROUND: f64 = 1e-9;

/// More roots at one place are not told apart from others by their number: rounding scatters them.
const MOST_ROOTS: f64 = 6.0;

/// Unknown turns beside the swept variable.
const TURNS: usize = 5;

/// Lengths of trial poses.
const LENGTH: f64 = 0.5;

/// Writes the program; `free` are the variables that are given. Says which unknown is swept, or why none can be.
pub(super) fn write(facts: &Facts, free: &[usize], b: &Builder) -> Result<String, String> {
    let plan = Plan::of(facts, free)?;
    let orders = plan.orders();
    if orders.is_empty() {
        return Err("the elimination breaks down in all orders".into());
    }
    b.note(
        "the axes as lines, the goal, the orders of elimination, and where the swept variable is looked for",
    );
    let zero = b.constant(0.0);
    let mut args: Vec<Scalar<'_>> = Vec::new();
    let mut given: Vec<(Axis, Move<'_>)> = Vec::new();
    for (axis, kind) in &plan.axes {
        let Kind::Given(k) = kind else {
            let line = given
                .iter()
                .rev()
                .fold(Symbolic::constant(b, axis), |line, (axis, step)| line.moved(b, axis, *step));
            args.extend(line.direction.0);
            args.extend(line.point.0);
            args.extend([kind.number(axis), axis.ratio].map(|x| b.constant(x)));
            continue;
        };
        let value = b.free(*k as u8) * axis.ratio;
        let step = match axis.motion {
            ChainMotion::Revolute => Move::Turn(b.turn_of(value)),
            ChainMotion::Prismatic => Move::Slide(value),
        };
        given.push((*axis, step));
    }
    args.resize(8 * MOST_LINES, zero);
    let goal = goal_of(facts, b);
    let unit = |i: usize| Vector([0, 1, 2].map(|j| b.constant(f64::from(u8::from(i == j)))));
    let columns = [0, 1, 2].map(|i| {
        goal.rotate(b, given.iter().fold(unit(i), |v, (axis, step)| step.back().rotate(b, axis, v)))
    });
    for row in 0..3 {
        args.extend(columns.map(|c| c.0[row]));
    }
    let place = given.iter().fold(Vector([zero; 3]), |p, (axis, step)| step.back().apply(b, axis, p));
    args.extend(goal.apply(b, place).0);
    let mut last = plan.last_numbers(&orders);
    for (numbers, code) in last.chunks_mut(ORDER_NUMBERS).zip(&orders) {
        numbers[1..].copy_from_slice(&plan.places(*code));
    }
    args.extend(last.map(|x| b.constant(x)));

    let mut names: Vec<String> = plan.turns.iter().map(|v| (v + 1).to_string()).collect();
    names.push((plan.swept + 1).to_string());
    let found = b.sweep(&names, &args);
    let mut off_zero = zero;
    let mut moves: Vec<Option<Move<'_>>> = vec![None; plan.variables];
    for (v, turn) in plan.turns.iter().zip(&found) {
        match moves.get_mut(*v) {
            Some(slot) => *slot = Some(Move::Turn(*turn)),
            None => off_zero = off_zero + (b.constant(1.0) - turn.cos),
        }
    }
    moves[plan.swept] =
        Some(if plan.slides { Move::Slide(found[TURNS].cos) } else { Move::Turn(found[TURNS]) });
    for (k, v) in free.iter().enumerate() {
        let value = b.free(k as u8);
        let slides = facts.ideal.iter().any(|a| a.variable == *v && a.motion == ChainMotion::Prismatic);
        moves[*v] = Some(if slides { Move::Slide(value) } else { Move::Turn(b.turn_of(value)) });
    }
    let moves: Vec<Move<'_>> = moves
        .into_iter()
        .map(|m| m.unwrap_or(Move::Turn(Turn { cos: b.constant(1.0), sin: zero })))
        .collect();
    if plan.added > 0 {
        b.if_zero(off_zero, OFF_ZERO, || b.emit(&moves), || {});
    } else {
        b.emit(&moves);
    }
    let completed = if plan.added > 0 { ", completed to six unknowns" } else { "" };
    let what = match plan.moved {
        1 if plan.slides => "which slides, ".into(),
        1 => "which is geared, ".into(),
        moved => format!("which moves {moved} joints, "),
    };
    Ok(format!("joint {}, {what}swept{completed}", plan.swept + 1))
}

/// What an axis is to the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// An unknown that turns alone.
    Turn,
    /// Moved by the swept variable.
    Swept,
    /// Moved by a given one: which of them.
    Given(usize),
}

impl Kind {
    /// As the kernel's number.
    fn number(self, axis: &Axis) -> f64 {
        match (self, axis.motion) {
            (Kind::Given(_), _) => 0.0,
            (Kind::Turn, _) => 1.0,
            (Kind::Swept, ChainMotion::Revolute) => 2.0,
            (Kind::Swept, ChainMotion::Prismatic) => 3.0,
        }
    }
}

/// What is swept, and what the loop is made of.
struct Plan {
    /// All axes, base to tip, with those that were added.
    axes: Vec<(Axis, Kind)>,
    /// Variables of the unknown turns; those that were added have numbers beyond the chain's.
    turns: Vec<usize>,
    swept: usize,
    /// Whether it is a length.
    slides: bool,
    /// Whether a full turn of it changes nothing.
    whole: bool,
    /// How many joints it moves.
    moved: usize,
    variables: usize,
    added: usize,
}

impl Plan {
    fn of(facts: &Facts, free: &[usize]) -> Result<Self, String> {
        let variables = facts.ideal.iter().map(|a| a.variable + 1).max().unwrap_or(0);
        let of = |v: usize| facts.ideal.iter().filter(move |a| a.variable == v);
        let plain = |v: usize| {
            of(v).count() == 1 && of(v).all(|a| a.motion == ChainMotion::Revolute && a.ratio == 1.0)
        };
        let unknown: Vec<usize> =
            (0..variables).filter(|v| !free.contains(v) && of(*v).next().is_some()).collect();
        let (mut turns, special): (Vec<usize>, Vec<usize>) = unknown.into_iter().partition(|v| plain(*v));
        let swept = match special[..] {
            [swept] => swept,
            [] => return Err("no unknown slides or moves several joints".into()),
            _ => {
                let names: Vec<String> = special.iter().map(|v| (v + 1).to_string()).collect();
                return Err(format!(
                    "joints {} each slide or move several joints, and no equation holds only one of them",
                    names.join(", ")
                ));
            }
        };
        if turns.len() > TURNS {
            return Err(format!("{} unknowns are more than six", turns.len() + 1));
        }
        let slides = of(swept).all(|a| a.motion == ChainMotion::Prismatic);
        if !slides && of(swept).any(|a| a.motion == ChainMotion::Prismatic) {
            return Err(format!("joint {} turns one joint and slides another", swept + 1));
        }
        let moved = of(swept).count();
        if moved + TURNS > MOST_LINES {
            return Err(format!("joint {} moves {moved} joints, {} at most", swept + 1, MOST_LINES - TURNS));
        }
        let kind = |a: &Axis| match free.iter().position(|v| *v == a.variable) {
            Some(k) => Kind::Given(k),
            None if a.variable == swept => Kind::Swept,
            None => Kind::Turn,
        };
        let mut axes: Vec<(Axis, Kind)> = facts.ideal.iter().map(|a| (*a, kind(a))).collect();
        let added = TURNS - turns.len();
        let mut rng = Seed::new(0).split("ikgen completed").rng();
        for i in 0..added {
            // In no special place or direction.
            let point = facts.tip.translation.vector + rng.direction().into_inner() * 0.3;
            let direction = rng.direction().into_inner();
            let variable = variables + i;
            axes.push((
                Axis { direction, point, motion: ChainMotion::Revolute, variable, ratio: 1.0 },
                Kind::Turn,
            ));
            turns.push(variable);
        }
        // The kernel has the turns in the order of the loop.
        turns = axes.iter().filter(|(_, kind)| *kind == Kind::Turn).map(|(a, _)| a.variable).collect();
        let whole = of(swept).all(|a| a.ratio == a.ratio.round());
        Ok(Self { axes, turns, swept, slides, whole, moved, variables, added })
    }

    /// Orders and kind of the swept variable, as the kernel takes them, without any places.
    fn last_numbers(&self, orders: &[usize]) -> LastNumbers {
        let mut numbers = [0.0; LAST];
        for (numbers, code) in numbers.chunks_mut(ORDER_NUMBERS).zip(orders) {
            numbers[0] = (code + 1) as f64;
        }
        numbers[LAST - 1] = if self.slides {
            0.0
        } else if self.whole {
            1.0
        } else {
            2.0
        };
        numbers
    }

    /// Values of the swept variable where the determinant of an order has roots whatever the goal, because the five others lose a freedom
    /// there: each with how many, zero for none.
    fn places(&self, code: usize) -> [f64; 2 * MOST_PLACES] {
        let mut rng = Seed::new(0).split("ikgen sweep places").rng();
        let last = self.last_numbers(&[code]);
        let trials: Vec<[f64; NUMBERS]> =
            (0..WITNESSES).map(|_| self.trial(&mut rng).numbers_with(last)).collect();
        let mut found: Vec<[f64; 2]> = Vec::new();
        let mut candidates: Vec<f64> = Vec::new();
        clusters_of(&trials[0], |place| candidates.push(place));
        for place in candidates {
            let mut roots: Vec<f64> = trials[1..].iter().map(|t| fall_of(t, place, DISTANCE)).collect();
            roots.sort_by(f64::total_cmp);
            let usual = roots[roots.len() / 2];
            let new = found.iter().all(|[other, _]| (other - place).abs() > DISTANCE);
            if new && roots[1] >= 1.0 && (1.0..=MOST_ROOTS).contains(&usual) {
                found.push([(place / ROUND).round() * ROUND, usual]);
            }
        }
        found.sort_by(|a, b| b[1].total_cmp(&a[1]));
        found.resize(MOST_PLACES, [0.0; 2]);
        std::array::from_fn(|i| found[i / 2][i % 2])
    }

    /// The orders that find random joint vectors again, best first: those that miss fewest, then those where the joint that does not turn
    /// is where the swept one is, which leaves half of the equations constant.
    fn orders(&self) -> Vec<usize> {
        let mut codes: Vec<usize> = (0..ORDERS).collect();
        let mut rng = Seed::new(0).split("ikgen sweep orders").rng();
        let first = self.axes.iter().filter(|(_, k)| !matches!(k, Kind::Given(_)));
        let before = first.take_while(|(_, k)| *k == Kind::Turn).count();
        let mut ranked: Vec<(usize, bool, usize)> = Vec::new();
        for poses in POSES {
            let trials: Vec<Trial> = (0..poses).map(|_| self.trial(&mut rng)).collect();
            let rank = |code: &usize| {
                let missed = trials.iter().filter(|t| !t.is_found(self.last_numbers(&[*code]))).count();
                (missed, still_joint(*code) != before, *code)
            };
            ranked = codes.iter().map(rank).filter(|(missed, ..)| 2 * missed < poses).collect();
            ranked.sort_unstable();
            codes = ranked.iter().map(|(.., code)| *code).take(2 * MOST_ORDERS).collect();
        }
        let least = ranked.first().map_or(0, |(missed, ..)| *missed);
        ranked
            .iter()
            .filter(|(missed, ..)| *missed <= least + 1)
            .map(|(.., code)| *code)
            .take(MOST_ORDERS)
            .collect()
    }

    /// A random joint vector, and the loop that it closes.
    fn trial(&self, rng: &mut Rng) -> Trial {
        let mut numbers = [0.0; NUMBERS];
        let still = Motion { rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], place: [0.0; 3] };
        let (mut given, mut goal) = (still, still);
        let count = self.variables + self.added;
        let values: Vec<f64> =
            (0..count).map(|_| rng.range(-std::f64::consts::PI, std::f64::consts::PI)).collect();
        let mut lines = 0;
        for (axis, kind) in &self.axes {
            let line = Line { direction: axis.direction.into(), point: axis.point.into() };
            let value = axis.ratio * values[axis.variable];
            let step = match axis.motion {
                ChainMotion::Revolute => line.motion(cos_sin(value)),
                ChainMotion::Prismatic => Motion { place: times(line.direction, LENGTH * value), ..still },
            };
            goal = goal.after(&step);
            if let Kind::Given(_) = kind {
                given = given.after(&step);
                continue;
            }
            let line = given.moved(&line);
            let row = &mut numbers[8 * lines..];
            row[..3].copy_from_slice(&line.direction);
            row[3..6].copy_from_slice(&line.point);
            (row[6], row[7]) = (kind.number(axis), axis.ratio);
            lines += 1;
        }
        let goal = goal.after(&given.inverse());
        let rest = &mut numbers[8 * MOST_LINES..];
        for i in 0..3 {
            rest[3 * i..3 * i + 3].copy_from_slice(&goal.rows[i]);
        }
        rest[9..12].copy_from_slice(&goal.place);
        let mut wanted: Vec<[f64; 2]> = self.turns.iter().map(|v| cos_sin(values[*v])).collect();
        wanted.push(if self.slides {
            [LENGTH * values[self.swept], 0.0]
        } else {
            cos_sin(values[self.swept])
        });
        Trial { numbers, wanted }
    }
}

/// How many numbers come after the goal.
const LAST: usize = MOST_ORDERS * ORDER_NUMBERS + 1;

type LastNumbers = [f64; LAST];

struct Trial {
    numbers: [f64; NUMBERS],
    wanted: Vec<[f64; 2]>,
}

impl Trial {
    /// The loop with what the kernel takes last.
    fn numbers_with(&self, last: LastNumbers) -> [f64; NUMBERS] {
        let mut numbers = self.numbers;
        numbers[NUMBERS - LAST..].copy_from_slice(&last);
        numbers
    }

    /// Whether the joint vector is among the candidates.
    fn is_found(&self, last: LastNumbers) -> bool {
        const NEAR: f64 = 1e-6;
        let found = sweep_of(&self.numbers_with(last), 0.0);
        let gap = |i: usize| {
            let pairs = found.get(i).into_iter().zip(&self.wanted);
            pairs.map(|(a, b)| (a[0] - b[0]).abs().max((a[1] - b[1]).abs())).fold(0.0, f64::max)
        };
        (0..found.count()).any(|i| gap(i) < NEAR)
    }
}
