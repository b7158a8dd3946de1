//! Joint vectors that come as near to a pose as the arm can: least squares, only when asked for, and marked as what they are.
//!
//! Descents from several places by damped Newton steps (Levenberg, "A method for the solution of certain non-linear problems in least
//! squares", 1944) with the second derivatives of the chain, since what is left is large. Joint limits are a box: variables that a limit
//! stops take no part in a step (Bertsekas, "Projected Newton methods for optimization problems with simple constraints", 1982).

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use robotc_core::ik::{IkSolutions, InverseKinematics as _, PreferenceError, Preferences};
use robotc_core::{Pose, Seed};

use super::{Solver, frame};
use crate::kernel::candidate::Arm;
use crate::kernel::chain::{Frame, Link, TOLERANCE};

/// How the nearest joint vectors are looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestOptions {
    /// Metres that count as much as one radian: what is made least is `|position|^2 + (radian * |rotation|)^2`, where `|rotation|` is the
    /// Frobenius norm of the rotation difference by the root of two, the angle itself where it is small.
    pub radian: f64,
    /// Descents from random joint vectors, besides the one from `near`.
    pub starts: u32,
    /// Steps of each descent at most.
    pub steps: u32,
    /// Seed of the random joint vectors.
    pub seed: Seed,
}

impl Default for ClosestOptions {
    fn default() -> Self {
        Self { radian: 0.2, starts: 24, steps: 200, seed: Seed::new(0) }
    }
}

/// A joint vector from which no small change comes nearer to the pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Closest {
    /// Radians or metres, base to tip, within the limits.
    pub joints: Vec<f64>,
    /// Distance of the tip from the position that was asked for, metres.
    pub position_error: f64,
    /// Angle to the rotation that was asked for, radians.
    pub rotation_error: f64,
    /// Whether it reaches the pose, to 1e-9: a solution as those of `solve`.
    pub exact: bool,
}

/// Two descents that end this near to each other in every variable ended in one place.
const SAME: f64 = 1e-4;

/// A descent ends where the slope along every variable that may move is less.
const LEVEL: f64 = 1e-11;

impl Solver {
    /// The joint vectors within limits that come nearest to a pose: its solutions if it has any, otherwise local minima of the weighted
    /// error, the nearest to the pose first.
    ///
    /// Of a pose only what the goal type takes counts. All joints move, also those that are given to `solve`: for the second kind `free` is no
    /// more than where the first descent starts, except for values that belong to the goal (a point, an angle), which stay. At most
    /// `max_solutions` of the preferences are returned; a minimum that is a continuum is represented by the ends of the descents.
    ///
    /// Panics unless there is one value for each free variable.
    pub fn solve_closest(
        &self,
        base_from_tip: &Pose,
        free: &[f64],
        preferences: &Preferences,
        options: &ClosestOptions,
    ) -> Result<Vec<Closest>, PreferenceError> {
        let ranges = preferences.ranges(self.ranges())?;
        let mut exact = IkSolutions::new();
        self.solve_preferred(base_from_tip, free, preferences, &mut exact)?;
        if !exact.is_empty() {
            let solution = |joints: &[f64]| Closest {
                joints: joints.to_vec(),
                position_error: 0.0,
                rotation_error: 0.0,
                exact: true,
            };
            return Ok(exact.iter().map(solution).collect());
        }
        let target = frame(base_from_tip);
        if !target.position.iter().chain(target.rotation.as_flattened()).chain(free).all(|x| x.is_finite()) {
            return Ok(Vec::new());
        }
        let (n, all) = (ranges.len(), self.program().variables);
        let mut bounds = vec![[f64::NEG_INFINITY, f64::INFINITY]; all];
        for (bound, range) in bounds.iter_mut().zip(&ranges) {
            *bound = [range.lower, range.upper];
        }
        for (bound, least) in bounds[n..].iter_mut().zip(self.program().goal.least()) {
            bound[0] = least;
        }
        let mut first = vec![0.0; all];
        for (&variable, &value) in self.free_variables().iter().zip(free) {
            first[variable] = value;
            if variable >= n {
                bounds[variable] = [value; 2];
            }
        }
        if let Some(near) = &preferences.near {
            first[..n].copy_from_slice(near);
        }
        let arm = self.chain.arm(&self.held[..all]);
        let descent = Descent { arm, target, bounds, radian: options.radian, steps: options.steps };
        let mut rng = options.seed.split("ikgen closest").rng();
        let mut found: Vec<(f64, Closest)> = Vec::new();
        for start in 0..=options.starts {
            let mut values = first.clone();
            if start > 0 {
                for ((value, bound), slides) in values.iter_mut().zip(&descent.bounds).zip(arm.slides) {
                    let [low, high] = drawn_from(bound, if *slides { 1.0 } else { PI });
                    *value = rng.range(low, high);
                }
            }
            let cost = descent.run(&mut values);
            let same = |(_, other): &(f64, Closest)| {
                let pairs = ranges.iter().zip(values.iter().zip(&other.joints));
                pairs.into_iter().all(|(range, (a, b))| range.distance(*a, *b) < SAME)
            };
            if !found.iter().any(same) {
                found.push((cost, descent.told(&values, n)));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(found.into_iter().map(|(_, closest)| closest).take(preferences.max_solutions).collect())
    }
}

/// Where the first value of a variable is drawn from: its range, or as much of it as `wide` to either side where it lacks an end.
fn drawn_from(&[low, high]: &[f64; 2], wide: f64) -> [f64; 2] {
    match (low.is_finite(), high.is_finite()) {
        (true, true) => [low, high],
        (true, false) => [low, low + 2.0 * wide],
        (false, true) => [high - 2.0 * wide, high],
        (false, false) => [-wide, wide],
    }
}

/// Squares of metres and of the Frobenius norm of the rotation difference.
fn squares(a: &Frame, b: &Frame) -> [f64; 2] {
    let sum = |pairs: &mut dyn Iterator<Item = (&f64, &f64)>| pairs.map(|(a, b)| (a - b) * (a - b)).sum();
    [
        sum(&mut a.position.iter().zip(&b.position)),
        sum(&mut a.rotation.as_flattened().iter().zip(b.rotation.as_flattened())),
    ]
}

fn matrix(frame: &Frame) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| frame.rotation[i][j])
}

/// What a unit of a variable does to the tip through one joint: metres and radians, in the base frame.
struct Axis {
    variable: usize,
    moves: Vector3<f64>,
    turns: Vector3<f64>,
}

/// One pose, asked of one arm.
struct Descent<'a> {
    /// With the joints that the goal type adds.
    arm: Arm<'a>,
    target: Frame,
    /// Lower and upper value of every variable.
    bounds: Vec<[f64; 2]>,
    radian: f64,
    steps: u32,
}

impl Descent<'_> {
    fn cost(&self, values: &[f64]) -> f64 {
        let [position, rotation] = squares(&self.arm.forward_values(values), &self.target);
        position + 0.5 * self.radian * self.radian * rotation
    }

    /// Goes downhill from `values` until the ground is level; the cost there.
    fn run(&self, values: &mut [f64]) -> f64 {
        for (value, [low, high]) in values.iter_mut().zip(&self.bounds) {
            *value = value.max(*low).min(*high);
        }
        let mut cost = self.cost(values);
        let mut damping = 1e-2;
        for _ in 0..self.steps {
            let Some((slope, curvature, moving)) = self.shape(values) else { return cost };
            let step = loop {
                let mut damped = curvature.clone();
                for i in 0..moving.len() {
                    damped[(i, i)] += damping * (1e-3 + curvature[(i, i)].abs());
                }
                let mut next = values.to_vec();
                if let Some(factors) = damped.cholesky() {
                    for (&v, step) in moving.iter().zip(factors.solve(&slope).iter()) {
                        let [low, high] = self.bounds[v];
                        next[v] = (values[v] + step).max(low).min(high);
                    }
                    let less = self.cost(&next);
                    if less < cost {
                        break Some((less, next));
                    }
                }
                damping *= 8.0;
                if damping > 1e12 {
                    break None;
                }
            };
            let Some((less, next)) = step else { return cost };
            cost = less;
            values.copy_from_slice(&next);
            damping = (0.1 * damping).max(1e-12);
        }
        cost
    }

    /// Slope downhill and curvature of half of the cost along the variables that may move, and which these are; `None` where it is level.
    fn shape(&self, values: &[f64]) -> Option<(DVector<f64>, DMatrix<f64>, Vec<usize>)> {
        let n = values.len();
        let (axes, reached) = self.axes(values);
        let (rotation, aim) = (matrix(&reached), matrix(&self.target));
        let off = rotation * aim.transpose();
        let missing = Vector3::from(self.target.position) - Vector3::from(reached.position);
        // The rotation that is missing: its axis times the sine of its angle.
        let turn = 0.5
            * Vector3::new(off[(1, 2)] - off[(2, 1)], off[(2, 0)] - off[(0, 2)], off[(0, 1)] - off[(1, 0)]);
        let weight = self.radian * self.radian;
        let (mut slope, mut curvature) = (DVector::zeros(n), DMatrix::zeros(n, n));
        for (i, a) in axes.iter().enumerate() {
            slope[a.variable] += a.moves.dot(&missing) + weight * a.turns.dot(&turn);
            for (j, b) in axes.iter().enumerate().skip(i) {
                let entry = a.moves.dot(&b.moves) - missing.dot(&a.turns.cross(&b.moves))
                    + 0.5 * weight * (a.turns.dot(&b.turns) * off.trace() - a.turns.dot(&(off * b.turns)));
                curvature[(a.variable, b.variable)] += entry;
                if i != j {
                    curvature[(b.variable, a.variable)] += entry;
                }
            }
        }
        let may_move = |&v: &usize| {
            let [low, high] = self.bounds[v];
            low < high && !(values[v] <= low && slope[v] < 0.0) && !(values[v] >= high && slope[v] > 0.0)
        };
        let moving: Vec<usize> = (0..n).filter(may_move).collect();
        let slope = DVector::from_iterator(moving.len(), moving.iter().map(|&v| slope[v]));
        if slope.amax() < LEVEL {
            return None;
        }
        let entry = |i: usize, j: usize| curvature[(moving[i], moving[j])];
        Some((slope, DMatrix::from_fn(moving.len(), moving.len(), entry), moving))
    }

    /// How each joint moves the tip, base to tip, and the pose of the tip.
    fn axes(&self, values: &[f64]) -> (Vec<Axis>, Frame) {
        let turned = |value: f64| {
            let (sin, cos) = libm::sincos(value);
            Frame { rotation: [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]], position: [0.0; 3] }
        };
        let mut at = turned(0.0);
        let places: Vec<(Vector3<f64>, Vector3<f64>)> = self
            .arm
            .links
            .iter()
            .map(|link| {
                at = at.times(&link.previous_from_joint);
                let place = (Vector3::from(at.rotation.map(|row| row[2])), Vector3::from(at.position));
                let value = link.ratio * values[link.variable];
                let slid = || Frame { position: [0.0, 0.0, value], ..turned(0.0) };
                at = at.times(&if link.slides { slid() } else { turned(value) });
                place
            })
            .collect();
        let tip = at.times(self.arm.last_from_tip);
        let axis = |(link, (z, point)): (&Link, &(Vector3<f64>, Vector3<f64>))| {
            let (moves, turns) = match link.slides {
                true => (*z, Vector3::zeros()),
                false => (z.cross(&(Vector3::from(tip.position) - point)), *z),
            };
            Axis { variable: link.variable, moves: link.ratio * moves, turns: link.ratio * turns }
        };
        (self.arm.links.iter().zip(&places).map(axis).collect(), tip)
    }

    /// What is told of the place where a descent ended; the first `n` variables are those of the chain.
    fn told(&self, values: &[f64], n: usize) -> Closest {
        let reached = self.arm.forward_values(values);
        let [position, rotation] = squares(&reached, &self.target).map(f64::sqrt);
        Closest {
            joints: values[..n].to_vec(),
            position_error: position,
            // The norm is 2 sqrt(2) times the sine of half of the angle.
            rotation_error: 2.0 * libm::asin((rotation / 8.0_f64.sqrt()).min(1.0)),
            exact: reached.distance(&self.target) < TOLERANCE,
        }
    }
}
