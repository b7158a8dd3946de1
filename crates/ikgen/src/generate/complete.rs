//! Chains with fewer than six joints, completed to six by joints that do not exist.
//!
//! Such a chain reaches few poses, and a pose is given in full. With joints added at the tip so that the whole is a
//! six-joint chain of a solved class, the solutions are those where the added joints are at zero.

use nalgebra::Vector3;
use robotc_core::model::ChainMotion;

use super::facts::{Axis, foot};
use super::problem::Problem;

/// Problems with six unknowns that hold the solutions of this one, which has four or five.
pub(super) fn completions(problem: &Problem) -> Vec<Problem> {
    let [.., before, last] = problem.axes[..] else { return Vec::new() };
    if !(4..6).contains(&problem.axes.len()) || problem.axes.iter().any(|a| a.motion != ChainMotion::Revolute)
    {
        return Vec::new();
    }
    // Directions at right angles to the last axis and to each other: never aligned while all added joints are at zero.
    let other = last.direction.cross(&before.direction);
    let side = if other.norm() > 0.1 { other } else { last.direction.cross(&perpendicular(&last.direction)) };
    let side = side.normalize();
    let third = last.direction.cross(&side).normalize();
    let on_axis = foot(&last, &before.point);
    // Lengths that no arm has: with one of its own the added centre could fold onto an axis, and its turn would be lost.
    let off_axis = on_axis + (side * 0.31271 + third * 0.17393 + last.direction * 0.23659);
    let mut found = Vec::new();
    for point in [on_axis, on_axis + last.direction * 0.29137, off_axis] {
        for (first, second) in [(side, third), (third, side)] {
            let add = |direction: Vector3<f64>| Axis {
                direction,
                point,
                motion: ChainMotion::Revolute,
                variable: 0,
                ratio: 1.0,
            };
            let added =
                if problem.axes.len() == 5 { vec![add(first)] } else { vec![add(first), add(second)] };
            found.push(problem.with_added(&added));
        }
    }
    found
}

fn perpendicular(h: &Vector3<f64>) -> Vector3<f64> {
    if h.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() }
}
