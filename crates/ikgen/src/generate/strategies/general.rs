//! Six revolute joints whose axes lie anyhow.
//!
//! The numeric kernel eliminates all but one unknown (see [`crate::kernel::six`]), in orders that [`crate::orders`] finds.

use robotc_core::model::ChainMotion;

use super::reach::Line as Symbolic;
use crate::generate::builder::{Builder, Move, Scalar, Vector};
use crate::generate::facts::Axis;
use crate::generate::problem::Problem;
use crate::kernel::six::{MOST_ORDERS, Order};
use crate::kernel::vector::Line;
use crate::orders::{Known, orders};

/// Poses on which orders are compared.
const POSES: usize = 24;

pub(super) fn write(problem: &mut Problem, b: &Builder) -> Result<String, String> {
    let given = problem.given.clone();
    if problem.axes.iter().any(|a| a.motion != ChainMotion::Revolute) {
        return Err("a joint slides".into());
    }
    let line = |axis: &Axis| Line { direction: axis.direction.into(), point: axis.point.into() };
    let axes: Vec<Line> = problem.axes.iter().map(line).collect();
    let axes = axes.try_into().map_err(|_| "there are not six unknowns".to_owned())?;
    let slides = |axis: &Axis| axis.motion == ChainMotion::Prismatic;
    let known: Vec<Known> =
        given.iter().map(|(before, a)| Known { before: *before, line: line(a), slides: slides(a) }).collect();
    let orders = orders(&axes, &known, POSES);
    let Some(best) = orders.first() else {
        return Err("the elimination breaks down in all orders".into());
    };
    b.note("the six axes as lines, the goal, and the orders of elimination with their degrees");
    let mut args: Vec<Scalar<'_>> = Vec::new();
    for (i, axis) in problem.axes.iter().enumerate() {
        let before = given.iter().rev().filter(|(before, _)| *before <= i);
        let line = before.fold(Symbolic::constant(b, axis), |line, (_, axis)| {
            line.moved(b, axis, problem.move_of(b, axis))
        });
        args.extend(line.direction.0);
        args.extend(line.point.0);
    }
    let goal = problem.goal(b);
    let undo: Vec<(Move<'_>, Axis)> =
        given.iter().map(|(_, axis)| (problem.move_of(b, axis).back(), *axis)).collect();
    let unit = |i: usize| {
        let mut e = nalgebra::Vector3::zeros();
        e[i] = 1.0;
        b.vector(&e)
    };
    let columns = [0, 1, 2].map(|i| {
        goal.rotate(b, undo.iter().fold(unit(i), |v: Vector<'_>, (step, axis)| step.rotate(b, axis, v)))
    });
    for row in 0..3 {
        args.extend(columns.map(|c| c.0[row]));
    }
    let origin = b.vector(&nalgebra::Vector3::zeros());
    let place = goal.apply(b, undo.iter().fold(origin, |p, (step, axis)| step.apply(b, axis, p)));
    args.extend(place.0);
    for k in 0..MOST_ORDERS {
        let order = orders.get(k).copied().unwrap_or(Order { code: 0, degree: 0, squared: false });
        let numbers = [order.code, order.degree, usize::from(order.squared)];
        args.extend(numbers.map(|x| b.constant(x as f64)));
    }
    let names: Vec<String> = (0..6).map(|i| problem.name(i)).collect();
    let turns = b.six(&names, &args);
    let moves: Vec<Move<'_>> = turns.into_iter().map(Move::Turn).collect();
    problem.emit(b, &moves);
    let degree = if best.squared { best.degree } else { 2 * best.degree };
    Ok(format!("eliminated to degree {degree}"))
}
