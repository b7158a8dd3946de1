//! What every solver object does: solutions of a pose, and the pose of a solution.

use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use robotc_core::SerialChain;
use robotc_core::ik::{Aliases, IkSolutions, InverseKinematics as _, Limits, Preferences};
use robotc_ikgen::Solver;
use robotc_ikgen::run::{ClosestOptions, RedundancyOptions, Side, SwivelBranch};

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
    /// Within these limits, in any order.
    pub(crate) fn within(limits: WantedLimits) -> Self {
        Self { limits, near: None, weights: Vec::new(), all_aliases: false, max_solutions: None }
    }

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

/// One value for each free joint.
fn check_free(free_joints: &[String], free: &[f64]) -> PyResult<()> {
    if free.len() == free_joints.len() {
        return Ok(());
    }
    let (expected, names) = (free_joints.len(), free_joints.join(", "));
    Err(PyValueError::new_err(format!("expected {expected} free values ({names}), got {}", free.len())))
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
    check_free(free_joints, free)?;
    let mut solutions = IkSolutions::new();
    solver
        .solve_preferred(&arrays::pose(pose)?, free, &wanted.preferences(), &mut solutions)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let rows: Vec<Vec<f64>> = solutions.iter().map(<[f64]>::to_vec).collect();
    Ok(arrays::rows(py, &rows, solver.variables()))
}

/// Joint vectors as rows, their errors in metres and radians as rows, and which of them are solutions.
pub(crate) type ClosestRows<'py> =
    (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<bool>>);

/// The joint vectors that come nearest to a pose.
pub(crate) fn closest<'py>(
    py: Python<'py>,
    solver: &Solver,
    free_joints: &[String],
    pose: &PyReadonlyArray2<'py, f64>,
    free: &[f64],
    wanted: Wanted,
    radian: Option<f64>,
) -> PyResult<ClosestRows<'py>> {
    check_free(free_joints, free)?;
    let mut options = ClosestOptions::default();
    if let Some(radian) = radian {
        if !(radian.is_finite() && radian > 0.0) {
            return Err(PyValueError::new_err("radian: expected a positive length"));
        }
        options.radian = radian;
    }
    let (pose, preferences) = (arrays::pose(pose)?, wanted.preferences());
    let found = py
        .detach(|| solver.solve_closest(&pose, free, &preferences, &options))
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let joints: Vec<Vec<f64>> = found.iter().map(|c| c.joints.clone()).collect();
    let errors: Vec<Vec<f64>> = found.iter().map(|c| vec![c.position_error, c.rotation_error]).collect();
    let exact = PyArray1::from_iter(py, found.iter().map(|c| c.exact));
    Ok((arrays::rows(py, &joints, solver.variables()), arrays::rows(py, &errors, 2), exact))
}

/// Which values the free joints have, and which of them is asked about.
pub(crate) struct Choice<'a> {
    pub(crate) joint: Option<&'a str>,
    pub(crate) free: Vec<f64>,
}

impl Choice<'_> {
    /// The values of the free joints and the position of the one that is asked about.
    fn resolve(mut self, free_joints: &[String]) -> PyResult<(Vec<f64>, usize)> {
        if self.free.is_empty() && free_joints.len() == 1 {
            self.free.push(0.0);
        }
        if free_joints.is_empty() || self.free.len() != free_joints.len() {
            return Err(PyValueError::new_err(format!(
                "expected {} free values, got {}",
                free_joints.len(),
                self.free.len()
            )));
        }
        let k = match self.joint {
            None => 0,
            Some(name) => free_joints
                .iter()
                .position(|other| other == name)
                .ok_or_else(|| PyKeyError::new_err(format!("{name} is not a free joint")))?,
        };
        Ok((self.free, k))
    }
}

/// Intervals of the value of a free joint for which the pose has solutions, a row each, and how complete they are.
pub(crate) fn free_intervals<'py>(
    py: Python<'py>,
    solver: &Solver,
    free_joints: &[String],
    pose: &PyReadonlyArray2<'py, f64>,
    choice: Choice<'_>,
    wanted: Wanted,
) -> PyResult<(Bound<'py, PyArray2<f64>>, String)> {
    let (free, k) = choice.resolve(free_joints)?;
    let (pose, preferences) = (arrays::pose(pose)?, wanted.preferences());
    let options = RedundancyOptions::default();
    let found = py
        .detach(|| solver.free_intervals(&pose, &free, k, &preferences, &options))
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let rows: Vec<Vec<f64>> = found.intervals.iter().map(|ends| ends.to_vec()).collect();
    Ok((arrays::rows(py, &rows, 2), found.completeness.to_string()))
}

/// The solution nearest to the wanted joint vector over all values of a free joint.
pub(crate) fn nearest(
    py: Python<'_>,
    solver: &Solver,
    free_joints: &[String],
    pose: &PyReadonlyArray2<'_, f64>,
    choice: Choice<'_>,
    wanted: Wanted,
) -> PyResult<Option<Vec<f64>>> {
    let (free, k) = choice.resolve(free_joints)?;
    let (pose, preferences) = (arrays::pose(pose)?, wanted.preferences());
    let options = RedundancyOptions::default();
    py.detach(|| solver.solve_nearest(&pose, &free, k, &preferences, &options))
        .map_err(|error| PyValueError::new_err(error.to_string()))
}

/// A branch of an arm with spherical shoulder and wrist: elbow, sides of the second and of the sixth joint, intervals of the swivel angle.
type Branch = (f64, i32, i32, Vec<[f64; 2]>);

/// The swivel angles of a pose within limits; `None` for other arms.
pub(crate) fn swivel(
    solver: &Solver,
    pose: &PyReadonlyArray2<'_, f64>,
    wanted: Wanted,
) -> PyResult<Option<Vec<Branch>>> {
    let found = solver
        .swivel(&arrays::pose(pose)?, &wanted.preferences())
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let side = |side| match side {
        Side::Positive => 1,
        Side::Negative => -1,
        Side::Aligned => 0,
    };
    let branch = |b: SwivelBranch| (b.elbow, side(b.shoulder), side(b.wrist), b.intervals);
    Ok(found.map(|branches| branches.into_iter().map(branch).collect()))
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
