//! Six joints whose last three axes meet in a point, the wrist centre.
//!
//! The first three bring the wrist centre to its place, the last three the rotation about. Turned round, the same
//! serves chains whose first three axes meet.

use crate::generate::builder::{Builder, Move};
use crate::generate::facts::{Axis, foot, meeting_point, parallel};
use crate::generate::problem::Problem;
use crate::generate::strategies::orient::orient;
use crate::generate::strategies::reach::{Line, Pair, classify, reach};
use robotc_core::model::ChainMotion;

pub(super) fn write(problem: &mut Problem, b: &Builder) -> Result<String, String> {
    if problem.axes.iter().any(|a| a.motion != ChainMotion::Revolute) {
        return Err("a joint slides".into());
    }
    let tolerance = problem.tolerance();
    let centre =
        meeting_point(&problem.axes[3..], tolerance).ok_or("axes 4, 5 and 6 do not meet in a point")?;
    if parallel(&problem.axes[3], &problem.axes[4], 0.02)
        || parallel(&problem.axes[4], &problem.axes[5], 0.02)
    {
        return Err("two axes of the wrist are parallel".into());
    }
    let given = problem.one_given()?;
    if given.is_some_and(|(before, _)| before > 3) {
        return Err("the given joint is inside of the wrist".into());
    }
    for axis in &mut problem.axes[3..] {
        axis.point = centre;
    }
    let inner = given.filter(|(before, _)| (1..3).contains(before));
    let [mut a1, mut a2, mut a3] = [problem.axes[0], problem.axes[1], problem.axes[2]];

    // The reach is solved from whichever end has the simpler pair; a given joint inside must be beyond that pair.
    let forward = inner.is_none_or(|(before, _)| before == 2);
    let backward = inner.is_none_or(|(before, _)| before == 1);
    let first = if forward { Some(classify(&mut a1.clone(), &mut a2.clone(), tolerance)) } else { None };
    let last = if backward { Some(classify(&mut a3.clone(), &mut a2.clone(), tolerance)) } else { None };
    let from_tip = match (first, last) {
        (_, Some(Pair::Parallel)) => true,
        (Some(Pair::Parallel | Pair::Meeting), _) => false,
        (_, Some(Pair::Meeting)) => true,
        (None, _) => true,
        _ => false,
    };
    let pair = if from_tip {
        let pair = classify(&mut a3, &mut a2, tolerance);
        if inner.is_none() {
            a1.point = foot(&a1, &a2.point);
        }
        pair
    } else {
        let pair = classify(&mut a1, &mut a2, tolerance);
        if inner.is_none() {
            a3.point = foot(&a3, &centre);
        }
        pair
    };
    check_reach(&a1, &a2, &a3, pair, from_tip, &centre, tolerance, inner.is_some())?;
    problem.axes[..3].copy_from_slice(&[a1, a2, a3]);

    let goal = problem.goal(b);
    let place = goal.apply(b, b.vector(&centre));
    let names: Vec<String> = (0..6).map(|i| problem.name(i)).collect();
    let lines = [a1, a2, a3].map(|a| Line::constant(b, &a));
    b.note("the place of the wrist centre");
    let mut start = b.vector(&centre);
    if let Some((3, axis)) = given {
        start = problem.move_of(b, &axis).apply(b, &axis, start);
    }
    let turns = if from_tip {
        let [mut l1, l2, l3] = lines;
        let mut place = place;
        if let Some((_, axis)) = inner {
            let undo = problem.move_of(b, &axis).back();
            l1 = l1.moved(b, &axis, undo);
            place = undo.apply(b, &axis, place);
        }
        let lines = [l3, l2, l1].map(Line::flipped);
        let [q3, q2, q1] =
            reach(b, [&names[2], &names[1], &names[0]], lines, &-a2.direction, pair, place, start);
        [q1, q2, q3]
    } else {
        let [l1, l2, mut l3] = lines;
        if let Some((_, axis)) = inner {
            let step = problem.move_of(b, &axis);
            l3 = l3.moved(b, &axis, step);
            start = step.apply(b, &axis, start);
        }
        reach(b, [&names[0], &names[1], &names[2]], [l1, l2, l3], &a2.direction, pair, start, place)
    };

    b.note("what is left of the rotation for the wrist");
    let unturned = |v| {
        let mut v = goal.rotate(b, v);
        for i in 0..3 {
            if let Some((_, axis)) = given.filter(|(before, _)| *before == i) {
                v = problem.move_of(b, &axis).back().rotate(b, &axis, v);
            }
            v = Move::Turn(turns[i]).back().rotate(b, &problem.axes[i], v);
        }
        if let Some((3, axis)) = given {
            v = problem.move_of(b, &axis).back().rotate(b, &axis, v);
        }
        v
    };
    let wrist = orient(
        b,
        [&names[3], &names[4], &names[5]],
        [3, 4, 5].map(|i| &problem.axes[i].direction),
        &unturned,
    );
    let moves: Vec<Move<'_>> = turns.into_iter().chain(wrist).map(Move::Turn).collect();
    problem.emit(b, &moves);
    let shoulder = match (pair, from_tip) {
        (Pair::Parallel, true) => "axes 2 and 3 parallel",
        (Pair::Parallel, false) => "axes 1 and 2 parallel",
        (Pair::Meeting, true) => "axes 2 and 3 meeting",
        (Pair::Meeting, false) => "axes 1 and 2 meeting",
        (Pair::Skew, _) => "general shoulder",
    };
    Ok(shoulder.into())
}

/// Refuses reaches that cannot move the wrist centre in all directions.
fn check_reach(
    a1: &Axis,
    a2: &Axis,
    a3: &Axis,
    pair: Pair,
    from_tip: bool,
    centre: &nalgebra::Vector3<f64>,
    tolerance: f64,
    given_inside: bool,
) -> Result<(), String> {
    if given_inside {
        return Ok(());
    }
    if (centre - a3.point).cross(&a3.direction).norm() < tolerance {
        return Err("the wrist centre lies on axis 3".into());
    }
    let shared = if from_tip { a3.point } else { a1.point };
    let third = if from_tip { a1 } else { a3 };
    if pair == Pair::Meeting && (shared - third.point).cross(&third.direction).norm() < tolerance {
        return Err("the first three axes meet too: nothing sets the distance of the wrist".into());
    }
    if pair == Pair::Parallel && parallel(a2, third, tolerance) {
        return Err("the first three axes are parallel".into());
    }
    Ok(())
}
