//! Fills a reachability map: exact inverse kinematics at the centre of each cell, limits, self-collision.

use nalgebra::Vector3;
use robotc_core::Pose;
use robotc_core::ik::{IkSolutions, InverseKinematics};
use robotc_core::model::SerialChain;
use serde::{Deserialize, Serialize};

use super::map::{Grid, ReachabilityMap, reach};

/// How finely to look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SearchOptions {
    /// Values tried for each free joint, evenly over its range.
    pub(super) free_samples: usize,
}

/// Everything that looking at a cell needs.
///
/// The first joint's own limits are left to queries, since a turn about the first axis turns the pose with it; for
/// self-collision it stands as near as its limits allow.
pub(super) struct Search<'a, C> {
    chain: &'a SerialChain,
    solver: &'a dyn InverseKinematics,
    collides: C,
    grid: Grid,
    free: Vec<Vec<f64>>,
    radius: f64,
}

/// The cells at one distance from the axis.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Row {
    counts: Vec<u8>,
    witnesses: Vec<f32>,
}

impl<'a, C: Fn(&[f64]) -> bool> Search<'a, C> {
    /// A search over `grid`; `collides` says whether the arm at these joint values touches itself.
    pub(super) fn new(
        chain: &'a SerialChain,
        solver: &'a dyn InverseKinematics,
        grid: Grid,
        options: &SearchOptions,
        collides: C,
    ) -> Self {
        let mut free = free_values(chain, solver.free_variables(), options.free_samples);
        free.truncate(usize::from(u8::MAX));
        Self { chain, solver, collides, grid, free, radius: reach(chain) }
    }

    /// Looks at all cells of a row: `r` below `grid.radial`.
    pub(super) fn row(&self, r: usize) -> Row {
        let cells = self.grid.vertical * self.grid.rotations().len();
        let mut row = Row::default();
        let mut solutions = IkSolutions::new();
        for cell in r * cells..(r + 1) * cells {
            let centre = self.grid.centre(cell);
            let (count, witness) = self.look(&centre, &mut solutions).unwrap_or_default();
            row.counts.push(count);
            row.witnesses.extend(witness);
        }
        row
    }

    /// The map of all rows, in order.
    pub(super) fn assemble(self, rows: Vec<Row>) -> ReachabilityMap {
        let mut counts = Vec::with_capacity(self.grid.len());
        let mut witnesses = Vec::new();
        for row in rows {
            counts.extend(row.counts);
            witnesses.extend(row.witnesses);
        }
        let first = &self.chain.variables[self.chain.joints[0].variable];
        let variables = self.chain.variables.len();
        let limits = (first.lower, first.upper);
        ReachabilityMap::new(self.grid, self.free.len() as u8, counts, witnesses, variables, limits)
            .expect("each cell with a count has a witness")
    }

    /// How many tries reach the pose, and the joint vector nearest to the middle of all limits.
    fn look(&self, base_from_tip: &Pose, solutions: &mut IkSolutions) -> Option<(u8, Vec<f32>)> {
        if out_of_reach(self.chain, base_from_tip, self.radius) {
            return None;
        }
        let mut count = 0;
        let mut best: Option<(f64, Vec<f64>)> = None;
        for values in &self.free {
            self.solver.solve(base_from_tip, values, solutions);
            let mut reached = false;
            for solution in solutions.iter() {
                let Some((mut joints, off_middle)) = within_limits(self.chain, solution) else { continue };
                let first = joints[0];
                let limits = &self.chain.variables[0];
                joints[0] = first.clamp(limits.lower, limits.upper);
                // Only a try that is not reached yet, or a better witness, is worth a collision test.
                let better = best.as_ref().is_none_or(|(cost, _)| off_middle < *cost);
                if (reached && !better) || (self.collides)(&joints) {
                    continue;
                }
                reached = true;
                if better {
                    joints[0] = first;
                    best = Some((off_middle, joints));
                }
            }
            count += u8::from(reached);
        }
        best.map(|(_, joints)| (count, joints.iter().map(|&x| x as f32).collect()))
    }
}

fn out_of_reach(chain: &SerialChain, base_from_tip: &Pose, radius: f64) -> bool {
    let shoulder = chain.joints[0].previous_from_joint.translation.vector;
    (base_from_tip.translation.vector - shoulder).norm() > radius
}

/// The joint vector with every joint but the first brought within its limits by full turns, and how far it is from the
/// middle of them; `None` when a joint cannot be.
fn within_limits(chain: &SerialChain, solution: &[f64]) -> Option<(Vec<f64>, f64)> {
    let mut joints = solution.to_vec();
    let mut off_middle: f64 = 0.0;
    for (i, variable) in chain.variables.iter().enumerate().skip(1) {
        if !variable.lower.is_finite() || !variable.upper.is_finite() {
            continue;
        }
        let turn = std::f64::consts::TAU;
        let revolves = chain
            .joints
            .iter()
            .any(|j| j.variable == i && j.motion == robotc_core::model::ChainMotion::Revolute);
        let aliases = if revolves { [0.0, -turn, turn] } else { [0.0; 3] };
        let value = aliases
            .into_iter()
            .map(|shift| joints[i] + shift)
            .find(|v| (variable.lower..=variable.upper).contains(v))?;
        joints[i] = value;
        let half = 0.5 * (variable.upper - variable.lower);
        off_middle += ((value - variable.lower - half) / half.max(1e-9)).powi(2);
    }
    Some((joints, off_middle))
}

/// All combinations of evenly spaced values of the free variables; one empty combination without any.
fn free_values(chain: &SerialChain, free: &[usize], samples: usize) -> Vec<Vec<f64>> {
    let mut combinations = vec![Vec::new()];
    for &variable in free {
        let v = &chain.variables[variable];
        let (low, high) = if v.lower.is_finite() && v.upper.is_finite() {
            (v.lower, v.upper)
        } else {
            (-std::f64::consts::PI, std::f64::consts::PI)
        };
        let mut longer = Vec::with_capacity(combinations.len() * samples);
        for combination in &combinations {
            for k in 0..samples {
                let mut next: Vec<f64> = combination.clone();
                next.push(low + (high - low) * (k as f64 + 0.5) / samples as f64);
                longer.push(next);
            }
        }
        combinations = longer;
    }
    combinations
}

/// Checks by forward kinematics alone that a witness reaches the centre of its cell. Position in metres and rotation as
/// Frobenius norm, both to the accuracy of the stored single-precision values.
pub(super) fn witness_is_true(chain: &SerialChain, map: &ReachabilityMap, cell: usize) -> bool {
    let Some(joints) = map.cell_witness(cell) else { return false };
    let (reached, centre) = (chain.forward(&joints), map.grid.centre(cell));
    let off = (reached.translation.vector - centre.translation.vector).norm();
    let turned: Vector3<f64> = (reached.rotation.inverse() * centre.rotation).scaled_axis();
    let limits = chain
        .variables
        .iter()
        .zip(&joints)
        .skip(1)
        .all(|(v, x)| *x >= v.lower - 1e-5 && *x <= v.upper + 1e-5);
    off < 1e-4 && turned.norm() < 1e-4 && limits
}
