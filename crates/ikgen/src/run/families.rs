//! Continua of solutions, found at a solution: directions in which joints can move without moving the tip, followed on the true chain.
//!
//! Where axes have lined up the program takes a representative ("free roots" of the crate's documentation). At it the Jacobian has lost
//! rank; so it has where an arm is stretched, where nothing can move. What tells the two apart is to go there: a family is what stays on
//! the pose to the tolerance of solutions.

use std::f64::consts::PI;

use nalgebra::{DMatrix, Matrix6};
use robotc_core::Pose;
use robotc_core::ik::{
    FamilyPath, IkFamily, IkSolutions, InverseKinematics as _, Preferences, VariableRange,
};

use super::{Solver, TrueChain, frame};
use crate::GoalType;
use crate::kernel::chain::{Frame, TOLERANCE, polish};
use crate::kernel::math::cos_sin;

/// Singular values of the Jacobian below this may be those of a continuum.
const SINGULAR: f64 = 1e-6;

/// Above this determinant (radians and metres) no singular value of a real arm is that small.
const REGULAR: f64 = 1e-5;

/// How far the leading joint goes at a time along a curve.
const STEP: f64 = 0.05;

/// Steps along a curve are cut down to this.
const SMALLEST: f64 = 1e-3;

impl Solver {
    /// As [`solve`](robotc_core::ik::InverseKinematics::solve), with the [families](IkSolutions::families) of the solutions.
    ///
    /// Known for solvers of whole poses.
    pub fn solve_with_families(&self, base_from_tip: &Pose, free: &[f64], out: &mut IkSolutions) {
        self.solve(base_from_tip, free, out);
        let mut found = Vec::new();
        for (index, solution) in out.iter().enumerate() {
            found.extend(self.families_at(base_from_tip, index, solution));
        }
        found.into_iter().for_each(|family| out.push_family(family));
    }

    /// The member of a family at `t`, angles not brought back to (-pi, pi]; `None` outside of its interval.
    pub fn family_member(
        &self,
        base_from_tip: &Pose,
        solution: &[f64],
        family: &IkFamily,
        t: f64,
    ) -> Option<Vec<f64>> {
        // Rounding at an end is not outside.
        if !(family.interval[0] - TOLERANCE <= t && t <= family.interval[1] + TOLERANCE) {
            return None;
        }
        let t = t.clamp(family.interval[0], family.interval[1]);
        let line =
            |t: f64| -> Vec<f64> { solution.iter().zip(&family.direction).map(|(q, d)| q + t * d).collect() };
        if family.path == FamilyPath::Line {
            return Some(line(t));
        }
        let walk = Walk { solver: self, frame: frame(base_from_tip), leader: family.leader() };
        walk.to(solution, &family.direction, t)
    }

    /// The families through one solution.
    pub(super) fn families_at(&self, base_from_tip: &Pose, index: usize, solution: &[f64]) -> Vec<IkFamily> {
        if self.program().goal != GoalType::Transform6D {
            return Vec::new();
        }
        let frame = frame(base_from_tip);
        let mut found = Vec::new();
        for direction in still_directions(&self.chain, solution, &self.program().free) {
            let leader = direction.iter().position(|d| *d == 1.0).expect("each has a leading joint");
            let at =
                |t: f64| -> Vec<f64> { solution.iter().zip(&direction).map(|(q, d)| q + t * d).collect() };
            let walk = Walk { solver: self, frame, leader };
            let turns = direction.iter().zip(&self.chain.slides).all(|(d, slides)| *d == 0.0 || !slides);
            let reaches = |t: &f64| walk.reaches(&at(*t));
            if turns && [0.05, -0.4, 1.1, -2.0, 2.9].iter().all(reaches) {
                found.push(IkFamily {
                    solution: index,
                    direction,
                    path: FamilyPath::Line,
                    interval: [-PI, PI],
                });
            } else {
                let interval = [-walk.far(solution, &direction, -1.0), walk.far(solution, &direction, 1.0)];
                if interval[1] - interval[0] > STEP {
                    found.push(IkFamily { solution: index, direction, path: FamilyPath::Curve, interval });
                }
            }
        }
        found
    }

    /// The member of a solution's families that keeps the limits: the one nearest to what is preferred, or without that the one farthest
    /// from all limits.
    pub(super) fn member_within(
        &self,
        base_from_tip: &Pose,
        solution: &[f64],
        ranges: &[VariableRange],
        preferences: &Preferences,
    ) -> Option<Vec<f64>> {
        const PLACES: usize = 128;
        let mut best: Option<(f64, Vec<f64>)> = None;
        for family in self.families_at(base_from_tip, 0, solution) {
            let near = preferences.near.as_deref();
            let mut take = |t: f64| {
                let member = self.family_member(base_from_tip, solution, &family, t)?;
                let nearest = |(v, q): (usize, &f64)| ranges[v].nearest(*q, near.map_or(0.0, |near| near[v]));
                let member: Vec<f64> = member.iter().enumerate().map(nearest).collect::<Option<_>>()?;
                let cost = match near {
                    Some(near) => preferences.squared_distance(ranges, &member, near),
                    None => -margin(ranges, &family, &member),
                };
                let better = best.as_ref().is_none_or(|(least, _)| cost < *least);
                if better {
                    best = Some((cost, member));
                }
                better.then_some(t)
            };
            let [low, high] = family.interval;
            let mut places: Vec<f64> =
                (0..=PLACES).map(|k| low + (high - low) * k as f64 / PLACES as f64).collect();
            if family.path == FamilyPath::Line {
                places.extend(crossings(ranges, &family, solution, near));
            }
            // Then ever finer around the best.
            let mut around = places.into_iter().filter_map(&mut take).last();
            let mut step = (high - low) / PLACES as f64;
            while let Some(centre) = around.filter(|_| step > 1e-6) {
                step *= 0.5;
                for t in [centre - step, centre + step] {
                    around = take(t).or(around);
                }
            }
        }
        best.map(|(_, member)| member)
    }

    /// Whether the Jacobian has lost rank at a solution.
    pub(super) fn is_singular(&self, solution: &[f64]) -> bool {
        self.program().goal == GoalType::Transform6D
            && !still_directions(&self.chain, solution, &self.program().free).is_empty()
    }
}

/// How far the joints that move in a family are from their limits, at most 1.
fn margin(ranges: &[VariableRange], family: &IkFamily, member: &[f64]) -> f64 {
    let moving = family.direction.iter().enumerate().filter(|(_, d)| **d != 0.0);
    moving.map(|(v, _)| (member[v] - ranges[v].lower).min(ranges[v].upper - member[v])).fold(1.0, f64::min)
}

/// Where joints of a line come to their limits, halfway between these places, and where they come to the preferred values.
fn crossings(
    ranges: &[VariableRange],
    family: &IkFamily,
    solution: &[f64],
    near: Option<&[f64]>,
) -> Vec<f64> {
    let moving = || family.direction.iter().enumerate().filter(|(_, d)| **d != 0.0);
    let at = |v: usize, d: f64, target: f64| {
        let t = (target - solution[v]) / d;
        [-2.0, -1.0, 0.0, 1.0, 2.0].map(|turns| t + turns * 2.0 * PI / d.abs())
    };
    let limits = moving().flat_map(|(v, d)| [at(v, *d, ranges[v].lower), at(v, *d, ranges[v].upper)]);
    let mut places: Vec<f64> = limits.flatten().filter(|t| t.is_finite()).collect();
    places.sort_by(f64::total_cmp);
    let halfway: Vec<f64> = places.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    places.extend(halfway);
    places.extend(near.into_iter().flat_map(|near| moving().flat_map(|(v, d)| at(v, *d, near[v]))));
    places
}

/// Following a family.
struct Walk<'a> {
    solver: &'a Solver,
    frame: Frame,
    leader: usize,
}

impl Walk<'_> {
    fn reaches(&self, values: &[f64]) -> bool {
        let arm = self.solver.chain.arm(&self.solver.held[..values.len()]);
        arm.forward_values(values).distance(&self.frame) < TOLERANCE
    }

    /// The solution near `guess` with the leading joint where it is there.
    fn settled(&self, mut guess: Vec<f64>) -> Option<Vec<f64>> {
        let mut held = self.solver.held;
        held[self.leader] = true;
        let chain = &self.solver.chain;
        let wanted = guess.clone();
        let left = polish(&chain.links, &chain.last_from_tip, &self.frame, &mut guess, &held[..wanted.len()]);
        let near = guess.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 4.0 * STEP);
        (left < TOLERANCE && near).then_some(guess)
    }

    /// One step of the leading joint from a member; `last` is the change of the step before, of length one in the leading joint.
    fn step(&self, from: &[f64], last: &[f64], by: f64) -> Option<Vec<f64>> {
        self.settled(from.iter().zip(last).map(|(q, d)| q + by * d).collect())
    }

    /// How far the leading joint can go in the sense of `sign`, at most pi.
    fn far(&self, solution: &[f64], direction: &[f64], sign: f64) -> f64 {
        let (mut at, mut last, mut gone, mut step) = (solution.to_vec(), direction.to_vec(), 0.0, STEP);
        while gone < PI && step >= SMALLEST {
            let by = sign * step.min(PI - gone);
            match self.step(&at, &last, by) {
                Some(next) => {
                    last = next.iter().zip(&at).map(|(a, b)| (a - b) / by).collect();
                    at = next;
                    gone += by.abs();
                }
                None => step *= 0.5,
            }
        }
        gone
    }

    /// The member at `t`.
    fn to(&self, solution: &[f64], direction: &[f64], t: f64) -> Option<Vec<f64>> {
        let (mut at, mut last, mut gone, mut step) = (solution.to_vec(), direction.to_vec(), 0.0, STEP);
        while gone < t.abs() {
            let by = t.signum() * step.min(t.abs() - gone);
            match self.step(&at, &last, by) {
                Some(next) => {
                    last = next.iter().zip(&at).map(|(a, b)| (a - b) / by).collect();
                    at = next;
                    gone += by.abs();
                }
                None if step < 0.5 * SMALLEST => return None,
                None => step *= 0.5,
            }
        }
        Some(at)
    }
}

/// A basis of the directions in which the joints move and the tip does not, to first order: each has a leading joint with entry 1 that
/// is 0 in the others, as far from the base as can be; `given` joints stay.
fn still_directions(chain: &TrueChain, values: &[f64], given: &[usize]) -> Vec<Vec<f64>> {
    let columns = jacobian(chain, values);
    let moving: Vec<usize> = (0..values.len()).filter(|v| !given.contains(v)).collect();
    if let Ok(six) = <[usize; 6]>::try_from(&moving[..])
        && Matrix6::from_fn(|i, j| columns[six[j]][i]).determinant().abs() > REGULAR
    {
        return Vec::new();
    }
    let rows = moving.len().max(6);
    let matrix = DMatrix::from_fn(rows, moving.len(), |i, j| if i < 6 { columns[moving[j]][i] } else { 0.0 });
    let decomposed = matrix.svd(false, true);
    let Some(v_t) = decomposed.v_t else { return Vec::new() };
    let still = (0..moving.len()).filter(|i| decomposed.singular_values[*i] < SINGULAR);
    let mut basis: Vec<Vec<f64>> = still.map(|i| v_t.row(i).iter().copied().collect()).collect();
    for k in 0..basis.len() {
        // The largest entry leads: dividing by it loses nothing.
        let size = |j: usize| (basis[k][j].abs() * 1e6).round();
        let Some(leader) = (0..moving.len()).max_by(|a, b| size(*a).total_cmp(&size(*b))) else { continue };
        let pivot = basis[k][leader];
        basis[k].iter_mut().for_each(|x| *x /= pivot);
        let row = basis[k].clone();
        for other in (0..basis.len()).filter(|i| *i != k) {
            let factor = basis[other][leader];
            basis[other].iter_mut().zip(&row).for_each(|(x, y)| *x -= factor * y);
        }
    }
    let whole = |direction: Vec<f64>| {
        let mut all = vec![0.0; values.len()];
        for (v, x) in moving.iter().zip(direction) {
            // Rounding of the decomposition; what is meant is checked on the chain.
            let nearest = x.round();
            all[*v] = if (x - nearest).abs() < 1e-7 { nearest + 0.0 } else { x };
        }
        all
    };
    basis.into_iter().map(whole).filter(|d| d.contains(&1.0)).collect()
}

/// Columns of the Jacobian at the tip: linear velocity, then angular, in the base frame.
fn jacobian(chain: &TrueChain, values: &[f64]) -> Vec<[f64; 6]> {
    let mut at = Frame { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], position: [0.0; 3] };
    let mut axes = Vec::new();
    for link in &chain.links {
        at = at.times(&link.previous_from_joint);
        axes.push((at.rotation.map(|row| row[2]), at.position));
        let value = link.ratio * values[link.variable];
        let [c, s] = if link.slides { [1.0, 0.0] } else { cos_sin(value) };
        let moved = Frame {
            rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
            position: [0.0, 0.0, if link.slides { value } else { 0.0 }],
        };
        at = at.times(&moved);
    }
    let tip = at.times(&chain.last_from_tip).position;
    let mut columns = vec![[0.0; 6]; values.len()];
    for (link, (z, p)) in chain.links.iter().zip(&axes) {
        let arm = [tip[0] - p[0], tip[1] - p[1], tip[2] - p[2]];
        let swept =
            [z[1] * arm[2] - z[2] * arm[1], z[2] * arm[0] - z[0] * arm[2], z[0] * arm[1] - z[1] * arm[0]];
        let column = &mut columns[link.variable];
        for i in 0..3 {
            column[i] += link.ratio * if link.slides { z[i] } else { swept[i] };
            column[3 + i] += if link.slides { 0.0 } else { link.ratio * z[i] };
        }
    }
    columns
}
