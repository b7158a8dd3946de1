//! Continua of solutions at singular poses: directions in which joints move and the tip does not.
//!
//! A stretched arm has lost rank too, and cannot move: a family is what stays on the pose when it is followed.

use super::candidate::Arm;
use super::chain::{Frame, MAX_JOINTS, TOLERANCE, linearise, polish};

/// Below this the Jacobian has lost rank.
const SINGULAR: f64 = 1e-6;

/// How far the leading joint goes at a time along a curve.
const STEP: f64 = 0.05;

/// Steps along a curve are cut down to this.
const SMALLEST: f64 = 1e-3;

/// Infinitely many solutions through one.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Which joints move together: 1 for the leading one, 0 for those that stay.
    pub direction: [f64; MAX_JOINTS],
    /// The leading joint.
    pub leader: usize,
    /// Whether `solution + t direction` reaches the pose for every `t`; otherwise a curve starts in that direction, and `t` is what the
    /// leading joint has moved.
    pub line: bool,
    /// Smallest and largest `t`, zero inside; from -pi to pi when the family closes.
    pub interval: [f64; 2],
}

/// The families through one solution.
#[derive(Clone, Copy, Debug)]
pub struct Families {
    items: [Family; MAX_JOINTS],
    len: usize,
}

impl Families {
    /// All of them.
    pub fn as_slice(&self) -> &[Family] {
        &self.items[..self.len]
    }
}

/// The families through a solution.
pub fn families_of(arm: &Arm<'_>, base_from_tip: &Frame, solution: &[f64]) -> Families {
    use core::f64::consts::PI;
    let none = Family { direction: [0.0; MAX_JOINTS], leader: 0, line: true, interval: [-PI, PI] };
    let mut found = Families { items: [none; MAX_JOINTS], len: 0 };
    let (still, count) = still_directions(arm, base_from_tip, solution);
    for (direction, leader) in &still[..count] {
        let mut family = Family { direction: *direction, leader: *leader, ..none };
        for i in 0..solution.len() {
            family.line = family.line && (direction[i] == 0.0 || !arm.slides[i]);
        }
        for t in [0.05, -0.4, 1.1, -2.0, 2.9] {
            let at = along(solution, direction, t);
            let distance = arm.forward_values(&at[..solution.len()]).distance(base_from_tip);
            family.line = family.line && distance < TOLERANCE;
        }
        if !family.line {
            for end in 0..2 {
                let mut at = along(solution, direction, 0.0);
                let t = family.interval[end];
                family.interval[end] =
                    follow(arm, base_from_tip, &family, &mut at[..solution.len()], t, SMALLEST);
            }
        }
        if family.line || family.interval[1] - family.interval[0] > STEP {
            found.items[found.len] = family;
            found.len += 1;
        }
    }
    found
}

/// Brings `values` from the solution to the member at `t`, angles not brought back to (-pi, pi]; says whether there is one.
pub fn member_of(arm: &Arm<'_>, base_from_tip: &Frame, family: &Family, values: &mut [f64], t: f64) -> bool {
    let [low, high] = family.interval;
    // Rounding at an end is not outside.
    if !(low - TOLERANCE <= t && t <= high + TOLERANCE) {
        return false;
    }
    let t = t.clamp(low, high);
    if family.line {
        let at = along(values, &family.direction, t);
        values.copy_from_slice(&at[..values.len()]);
        return true;
    }
    follow(arm, base_from_tip, family, values, t, 0.5 * SMALLEST) == t
}

/// Whether the Jacobian has lost rank at a solution.
pub fn is_singular(arm: &Arm<'_>, base_from_tip: &Frame, solution: &[f64]) -> bool {
    still_directions(arm, base_from_tip, solution).1 > 0
}

fn along(values: &[f64], direction: &[f64; MAX_JOINTS], t: f64) -> [f64; MAX_JOINTS] {
    let mut at = [0.0; MAX_JOINTS];
    for i in 0..values.len() {
        at[i] = values[i] + t * direction[i];
    }
    at
}

/// Follows a curve until the leading joint has moved by `t`; returns how far it came in steps of `least` or more.
fn follow(
    arm: &Arm<'_>,
    base_from_tip: &Frame,
    family: &Family,
    values: &mut [f64],
    t: f64,
    least: f64,
) -> f64 {
    let n = values.len();
    let mut held = [false; MAX_JOINTS];
    held[..n].copy_from_slice(arm.held);
    held[family.leader] = true;
    let (mut last, mut gone, mut step) = (family.direction, 0.0, STEP);
    let sign = if t < 0.0 { -1.0 } else { 1.0 };
    while gone < t.abs() && step >= least {
        let rest = t.abs() - gone;
        let by = sign * step.min(rest);
        let wanted = along(values, &last, by);
        let mut next = wanted;
        let left = polish(arm.links, arm.last_from_tip, base_from_tip, &mut next[..n], &held[..n]);
        let mut near = left < TOLERANCE;
        for i in 0..n {
            near = near && (next[i] - wanted[i]).abs() < 4.0 * STEP;
        }
        if near {
            for i in 0..n {
                last[i] = (next[i] - values[i]) / by;
            }
            values.copy_from_slice(&next[..n]);
            gone = if step < rest { gone + step } else { t.abs() };
        } else {
            step *= 0.5;
        }
    }
    sign * gone
}

/// A basis of the directions in which joints move and the tip does not, each with its leading joint (1 there, 0 in the others), and
/// their number.
fn still_directions(
    arm: &Arm<'_>,
    base_from_tip: &Frame,
    values: &[f64],
) -> ([([f64; MAX_JOINTS], usize); MAX_JOINTS], usize) {
    let (_, _, mut columns) = linearise(arm.links, arm.last_from_tip, base_from_tip, values);
    let mut joints = [0; MAX_JOINTS];
    let mut n = 0;
    for i in 0..values.len() {
        if !arm.held[i] {
            (joints[n], columns[n]) = (i, columns[i]);
            n += 1;
        }
    }
    // Elimination with the largest entry of what is left as pivot.
    let mut rank = 0;
    while rank < n && rank < 6 {
        let (mut column, mut row) = (rank, rank);
        for c in rank..n {
            for r in rank..6 {
                if columns[c][r].abs() > columns[column][row].abs() {
                    (column, row) = (c, r);
                }
            }
        }
        if columns[column][row].abs() < SINGULAR {
            break;
        }
        columns.swap(rank, column);
        joints.swap(rank, column);
        for c in &mut columns[..n] {
            c.swap(rank, row);
        }
        for r in rank + 1..6 {
            let factor = columns[rank][r] / columns[rank][rank];
            for c in &mut columns[rank..n] {
                c[r] -= factor * c[rank];
            }
        }
        rank += 1;
    }
    let mut found = [([0.0; MAX_JOINTS], 0); MAX_JOINTS];
    let count = n - rank;
    for (k, (direction, _)) in found[..count].iter_mut().enumerate() {
        let mut x = [0.0; MAX_JOINTS];
        x[rank + k] = 1.0;
        for r in (0..rank).rev() {
            let mut sum = 0.0;
            for c in r + 1..n {
                sum += columns[c][r] * x[c];
            }
            x[r] = -sum / columns[r][r];
        }
        for c in 0..n {
            direction[joints[c]] = x[c];
        }
    }
    for k in 0..count {
        // The largest entry leads, of equal ones the last: dividing by it loses nothing.
        let (mut row, mut leader) = (found[k].0, 0);
        for i in 0..values.len() {
            if row[i].abs() >= row[leader].abs() * (1.0 - 1e-6) {
                leader = i;
            }
        }
        row = row.map(|x| x / row[leader]);
        for other in 0..count {
            let factor = found[other].0[leader];
            for i in 0..values.len() {
                found[other].0[i] -= factor * row[i];
            }
        }
        found[k] = (row, leader);
    }
    for (direction, _) in &mut found[..count] {
        for x in direction {
            let whole = if x.abs() < 0.5 { 0.0 } else { x.signum() };
            if (*x - whole).abs() < 1e-7 {
                *x = whole;
            }
        }
    }
    (found, count)
}
