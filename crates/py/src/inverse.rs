//! Inverse kinematics of an arm.

use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use robotc_core::ik::InverseKinematics as _;
use robotc_core::{Kinematics, SerialChain};
use robotc_ikgen::Solver;
use robotc_kb::Knowledge;
use robotc_kb::kinds::IkSolver;
use robotc_kb::project::OfArm;

use crate::errors::CompileError;
use crate::solving::{self, Choice, Wanted, WantedLimits};

/// All joint vectors of an arm that reach a pose.
#[pyclass(frozen, subclass, module = "robotc")]
pub(crate) struct InverseKinematics {
    pub(crate) chain: SerialChain,
    pub(crate) solver: Solver,
    /// Joints whose values are given, in the order in which they are.
    pub(crate) free_joints: Vec<String>,
}

impl InverseKinematics {
    pub(crate) fn load(knowledge: &Knowledge, arm: Option<&str>) -> PyResult<Self> {
        let project = knowledge.graph().project();
        let robot = project.robot();
        let index = match arm {
            None => project.task().map_or(0, |task| task.arm),
            Some(name) => robot
                .arms
                .iter()
                .position(|a| a.name == name)
                .ok_or_else(|| PyKeyError::new_err(format!("the robot has no arm {name}")))?,
        };
        let failed = |e: &dyn std::fmt::Display| CompileError::new_err(e.to_string());
        let arm = &robot.arms[index];
        let kinematics = Kinematics::new(robot.model.clone());
        let chain = SerialChain::between(&kinematics, arm.base, arm.tip).map_err(|e| failed(&e))?;
        let program = knowledge.load::<IkSolver>(&OfArm(index)).map_err(|e| failed(&e))?;
        let solver = Solver::new((*program).clone(), &chain).map_err(|e| failed(&e))?;
        let free = solver.free_variables().iter();
        let free_joints = free.map(|&i| chain.variables[i].name.clone()).collect();
        Ok(Self { chain, solver, free_joints })
    }
}

#[pymethods]
impl InverseKinematics {
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.chain.variables.iter().map(|v| v.name.clone()).collect()
    }

    #[getter]
    fn free_joints(&self) -> &[String] {
        &self.free_joints
    }

    /// A row for each solution. `pose` is `base_from_tip`, a 4 x 4 matrix; `free` the values of the free joints; the rest chooses
    /// among the solutions.
    #[pyo3(signature = (
        pose, free = Vec::new(), *, limits = WantedLimits::Described(false), near = None, weights = Vec::new(),
        all_aliases = false, max_solutions = None
    ), text_signature = "(self, pose, free=(), *, limits=False, near=None, weights=(), all_aliases=False, max_solutions=None)")]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn solve<'py>(
        &self,
        py: Python<'py>,
        pose: PyReadonlyArray2<'py, f64>,
        free: Vec<f64>,
        limits: WantedLimits,
        near: Option<Vec<f64>>,
        weights: Vec<f64>,
        all_aliases: bool,
        max_solutions: Option<usize>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let wanted = Wanted { limits, near, weights, all_aliases, max_solutions };
        solving::solve(py, &self.solver, &self.free_joints, &pose, &free, wanted)
    }

    /// Values of a free joint for which the pose has solutions within limits.
    #[pyo3(
        signature = (pose, joint = None, free = Vec::new(), limits = WantedLimits::Described(true)),
        text_signature = "(self, pose, joint=None, free=(), limits=True)"
    )]
    fn free_intervals<'py>(
        &self,
        py: Python<'py>,
        pose: PyReadonlyArray2<'py, f64>,
        joint: Option<&str>,
        free: Vec<f64>,
        limits: WantedLimits,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, String)> {
        let (choice, wanted) = (Choice { joint, free }, Wanted::within(limits));
        solving::free_intervals(py, &self.solver, &self.free_joints, &pose, choice, wanted)
    }

    /// The solution within limits that is nearest to a joint vector, over all values of a free joint.
    #[pyo3(
        signature = (pose, near, joint = None, free = Vec::new(), limits = WantedLimits::Described(true), weights = Vec::new()),
        text_signature = "(self, pose, near, joint=None, free=(), limits=True, weights=())"
    )]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn nearest<'py>(
        &self,
        py: Python<'py>,
        pose: PyReadonlyArray2<'py, f64>,
        near: Vec<f64>,
        joint: Option<&str>,
        free: Vec<f64>,
        limits: WantedLimits,
        weights: Vec<f64>,
    ) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let (choice, wanted) =
            (Choice { joint, free }, Wanted { near: Some(near), weights, ..Wanted::within(limits) });
        let found = solving::nearest(py, &self.solver, &self.free_joints, &pose, choice, wanted)?;
        Ok(found.map(|joints| PyArray1::from_vec(py, joints)))
    }

    /// The joint vectors that come nearest to the pose: rows, errors in metres and radians, and whether each is a solution.
    #[pyo3(
        signature = (pose, free = Vec::new(), *, limits = WantedLimits::Described(true), near = None, max_solutions = None, radian = None),
        text_signature = "(self, pose, free=(), *, limits=True, near=None, max_solutions=None, radian=0.2)"
    )]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn closest<'py>(
        &self,
        py: Python<'py>,
        pose: PyReadonlyArray2<'py, f64>,
        free: Vec<f64>,
        limits: WantedLimits,
        near: Option<Vec<f64>>,
        max_solutions: Option<usize>,
        radian: Option<f64>,
    ) -> PyResult<solving::ClosestRows<'py>> {
        let wanted = Wanted { near, max_solutions, ..Wanted::within(limits) };
        solving::closest(py, &self.solver, &self.free_joints, &pose, &free, wanted, radian)
    }

    /// Branches of an arm with spherical shoulder and wrist and the swivel angles at which they keep the limits.
    #[pyo3(signature = (pose, limits = WantedLimits::Described(true)), text_signature = "(self, pose, limits=True)")]
    fn swivel<'py>(
        &self,
        pose: PyReadonlyArray2<'py, f64>,
        limits: WantedLimits,
    ) -> PyResult<Option<Vec<(f64, i32, i32, Vec<[f64; 2]>)>>> {
        solving::swivel(&self.solver, &pose, Wanted::within(limits))
    }

    /// `base_from_tip` at these joint values, as a 4 x 4 matrix.
    fn fk<'py>(&self, py: Python<'py>, joints: Vec<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        solving::forward(py, &self.chain, &joints)
    }
}
