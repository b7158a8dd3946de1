//! What every solver object does: solutions of a pose, and the pose of a solution.

use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use robotc_core::SerialChain;
use robotc_core::ik::{Aliases, IkSolutions, InverseKinematics as _, Limits, Preferences};
use robotc_ikgen::Solver;
use robotc_ikgen::run::{Completeness, RedundancyOptions};

use crate::arrays;

/// The argument `limits`.
#[derive(FromPyObject)]
pub(crate) enum WantedLimits {
    /// Those of the description, or none.
    Described(bool),
    /// Lower and upper value of each joint.
    Given(Vec<[f64; 2]>),
}

/// The arguments that choose among the solutions.
pub(crate) struct Wanted {
    pub(crate) limits: WantedLimits,
    pub(crate) near: Option<Vec<f64>>,
    pub(crate) weights: Vec<f64>,
    pub(crate) all_aliases: bool,
    pub(crate) max_solutions: Option<usize>,
}

impl Wanted {
    fn preferences(self) -> Preferences {
        Preferences {
            limits: match self.limits {
                WantedLimits::Described(true) => Limits::Described,
                WantedLimits::Described(false) => Limits::Ignored,
                WantedLimits::Given(limits) => Limits::Given(limits),
            },
            aliases: if self.all_aliases { Aliases::All } else { Aliases::Nearest },
            near: self.near,
            weights: self.weights,
            max_solutions: self.max_solutions.unwrap_or(usize::MAX),
        }
    }
}

/// A row for each solution.
pub(crate) fn solve<'py>(
    py: Python<'py>,
    solver: &Solver,
    free_joints: &[String],
    pose: &PyReadonlyArray2<'py, f64>,
    free: &[f64],
    wanted: Wanted,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    if free.len() != free_joints.len() {
        return Err(PyValueError::new_err(format!(
            "expected {} free values ({}), got {}",
            free_joints.len(),
            free_joints.join(", "),
            free.len()
        )));
    }
    let mut solutions = IkSolutions::new();
    solver
        .solve_preferred(&arrays::pose(pose)?, free, &wanted.preferences(), &mut solutions)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let rows: Vec<Vec<f64>> = solutions.iter().map(<[f64]>::to_vec).collect();
    Ok(arrays::rows(py, &rows, solver.variables()))
}

/// Intervals of the value of a free joint for which the pose has solutions, a row each, and how wide what was missed can be.
pub(crate) fn free_intervals<'py>(
    py: Python<'py>,
    solver: &Solver,
    free_joints: &[String],
    pose: &PyReadonlyArray2<'py, f64>,
    joint: Option<&str>,
    mut free: Vec<f64>,
    limits: WantedLimits,
) -> PyResult<(Bound<'py, PyArray2<f64>>, f64)> {
    if free.is_empty() && free_joints.len() == 1 {
        free.push(0.0);
    }
    if free_joints.is_empty() || free.len() != free_joints.len() {
        return Err(PyValueError::new_err(format!(
            "expected {} free values, got {}",
            free_joints.len(),
            free.len()
        )));
    }
    let k = match joint {
        None => 0,
        Some(name) => free_joints
            .iter()
            .position(|other| other == name)
            .ok_or_else(|| PyKeyError::new_err(format!("{name} is not a free joint")))?,
    };
    let wanted = Wanted { limits, near: None, weights: Vec::new(), all_aliases: false, max_solutions: None };
    let (pose, preferences) = (arrays::pose(pose)?, wanted.preferences());
    let options = RedundancyOptions::default();
    let found = py
        .detach(|| solver.free_intervals(&pose, &free, k, &preferences, &options))
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let width = match found.completeness {
        Completeness::Complete => 0.0,
        Completeness::ToWidth(width) | Completeness::Sampled(width) => width,
    };
    let rows: Vec<Vec<f64>> = found.intervals.iter().map(|ends| ends.to_vec()).collect();
    Ok((arrays::rows(py, &rows, 2), width))
}

/// `base_from_tip` at these joint values, as a 4 x 4 matrix.
pub(crate) fn forward<'py>(
    py: Python<'py>,
    chain: &SerialChain,
    joints: &[f64],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let expected = chain.variables.len();
    if joints.len() != expected {
        return Err(PyValueError::new_err(format!("expected {expected} joint values, got {}", joints.len())));
    }
    Ok(arrays::matrix(py, &chain.forward(joints)))
}
