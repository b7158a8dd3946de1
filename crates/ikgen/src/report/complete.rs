//! Whether all solutions of a pose are found.
//!
//! No solver is asked what it leaves out. At a pose a little away from a special one nothing is special: what is found there,
//! brought back by Newton steps, are solutions of the pose itself. All that are not singular can be found so.

use nalgebra::DMatrix;
use robotc_core::ik::{IkSolutions, InverseKinematics as _};
use robotc_core::model::SerialChain;
use robotc_core::rng::Rng;
use robotc_core::{Pose, Seed};

use crate::Solver;
use crate::check::same;
use crate::jacobian::jacobian;
use crate::kernel::chain::TOLERANCE;
use crate::report::poses::slides;
use crate::run::{TrueChain, frame};

/// How far poses are away at which more solutions are looked for: metres, and radians. Two poses of each.
const BESIDE: [f64; 4] = [1e-4, 1e-3, 1e-2, 3e-2];

/// Two solutions are the same one if they are this close, radians modulo a turn or metres.
const SAME: f64 = 1e-5;

/// What was found of all solutions of some poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Completeness {
    /// Solutions that are not singular.
    pub solutions: usize,
    /// Those of them that the solver did not return.
    pub lost: usize,
    /// Poses at which that happened.
    pub poses: usize,
}

/// Compares what a solver returns at the poses of joint vectors with all that is known of these poses. Solutions whose Jacobian has a
/// singular value of `regular` or less do not count: there some belong to continua, of which one representative is returned.
///
/// For solvers of whole poses.
pub fn completeness(
    chain: &SerialChain,
    solver: &Solver,
    vectors: &[Vec<f64>],
    regular: f64,
) -> Completeness {
    let mut rng = Seed::new(0).split("ikgen completeness").rng();
    let mut counts = Completeness::default();
    let slides = slides(chain);
    for vector in vectors {
        let returned = returned(chain, solver, vector);
        let (mut all, mut lost) = (0, 0);
        for solution in known(chain, solver, vector, &returned, &mut rng) {
            if least_singular_value(chain, solver, &solution) > regular {
                all += 1;
                lost += usize::from(!returned.iter().any(|r| same(r, &solution, &slides, SAME)));
            }
        }
        counts.solutions += all;
        counts.lost += lost;
        counts.poses += usize::from(lost > 0);
    }
    counts
}

fn given(solver: &Solver, vector: &[f64]) -> Vec<f64> {
    solver.free_variables().iter().map(|v| vector[*v]).collect()
}

fn returned(chain: &SerialChain, solver: &Solver, vector: &[f64]) -> Vec<Vec<f64>> {
    let mut out = IkSolutions::new();
    solver.solve(&chain.forward(vector), &given(solver, vector), &mut out);
    out.iter().map(<[f64]>::to_vec).collect()
}

/// All solutions of the pose of a joint vector that are found there or nearby; the joint vector itself is one.
fn known(
    chain: &SerialChain,
    solver: &Solver,
    vector: &[f64],
    returned: &[Vec<f64>],
    rng: &mut Rng,
) -> Vec<Vec<f64>> {
    let Some(true_chain) = TrueChain::new(chain) else { return Vec::new() };
    let held: Vec<bool> = (0..vector.len()).map(|v| solver.free_variables().contains(&v)).collect();
    let arm = true_chain.arm(&held);
    let (pose, slides, free) = (chain.forward(vector), slides(chain), given(solver, vector));
    let mut known = returned.to_vec();
    known.push(vector.to_vec());
    known.dedup_by(|a, b| same(a, b, &slides, SAME));
    let mut out = IkSolutions::new();
    for size in BESIDE.into_iter().chain(BESIDE) {
        let off = rng.direction().into_inner() * size;
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(rng.direction().into_inner() * size);
        let beside = pose * Pose::from_parts(off.into(), turn);
        solver.solve(&beside, &free, &mut out);
        for candidate in out.iter() {
            let mut values = candidate.to_vec();
            let left = crate::kernel::chain::polish(
                arm.links,
                arm.last_from_tip,
                &frame(&pose),
                &mut values,
                arm.held,
            );
            if left < TOLERANCE && !known.iter().any(|k| same(k, &values, &slides, SAME)) {
                known.push(values);
            }
        }
    }
    known
}

fn least_singular_value(chain: &SerialChain, solver: &Solver, values: &[f64]) -> f64 {
    let columns = jacobian(chain, values);
    let moved: Vec<usize> = (0..columns.len()).filter(|v| !solver.free_variables().contains(v)).collect();
    let matrix = DMatrix::from_fn(6, moved.len(), |i, j| columns[moved[j]][i]);
    matrix.singular_values().iter().fold(f64::INFINITY, |least, s| least.min(*s))
}
