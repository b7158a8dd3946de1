//! Sessions and plans.

use std::path::{Path, PathBuf};
use std::time::Instant;

use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use robotc_core::Seed;
use robotc_planning::manipulation;
use robotc_planning::{Budget, Interrupt};
use robotc_runtime::film::{TreeKeeper, film};
use robotc_runtime::{MotionTable, execute, view};

use crate::arrays;
use crate::errors::PlanError;
use crate::long;

/// A task with its artefacts.
#[pyclass(frozen, module = "robotc")]
pub(crate) struct Session {
    pub(crate) session: robotc_runtime::Session,
}

/// A plan with its certificate, and the motion of all joints.
#[pyclass(frozen, module = "robotc")]
pub(crate) struct Plan {
    session: Py<Session>,
    plan: manipulation::Plan,
    trees: TreeKeeper,
    table: MotionTable,
    seconds: f64,
}

/// Ticks a second of the simulated controller.
const CONTROL_RATE: f64 = 250.0;

#[pymethods]
impl Session {
    /// Plans the whole task and certifies the plan. Depends on the seed alone unless the time limit ends it.
    #[pyo3(signature = (seed = None, time_limit = 30.0))]
    fn plan(slf: Py<Self>, py: Python<'_>, seed: Option<u64>, time_limit: f64) -> PyResult<Plan> {
        let this = slf.get();
        let seed = Seed::new(seed.unwrap_or(this.session.task().seed));
        let options = this.session.options();
        let mut trees = TreeKeeper::default();
        let start = Instant::now();
        let (plan, seconds) = long::run(py, |interrupts| {
            let interrupt = || {
                if interrupts.stop() {
                    return Some(Interrupt::Cancelled);
                }
                (start.elapsed().as_secs_f64() > time_limit).then_some(Interrupt::TimeUp)
            };
            let plan = this
                .session
                .plan(&options, &Budget::new(&interrupt), seed, &mut trees)
                .map_err(|e| PlanError::new_err(e.to_string()))?;
            let seconds = start.elapsed().as_secs_f64();
            PyResult::Ok((plan, seconds))
        })??;
        let task = this.session.task();
        let table = MotionTable::of(&task.robot.model, &task.start, &plan);
        Ok(Plan { session: slf, plan, trees, table, seconds })
    }
}

#[pymethods]
impl Plan {
    /// Whether every goal of the task is reached.
    #[getter]
    fn complete(&self) -> bool {
        self.plan.is_complete()
    }

    /// Why goals are left out.
    #[getter]
    fn skipped(&self) -> Vec<String> {
        self.plan.skipped.iter().map(|s| s.reason.to_string()).collect()
    }

    /// Seconds that planning took.
    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.plan.duration()
    }

    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.table.names.clone()
    }

    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.table.times)
    }

    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::rows(py, &self.table.positions, self.table.names.len())
    }

    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::rows(py, &self.table.velocities, self.table.names.len())
    }

    #[getter]
    fn accelerations<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::rows(py, &self.table.accelerations, self.table.names.len())
    }

    /// Kind, object and seconds of each segment, in order.
    #[getter]
    fn segments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let task = self.session.get().session.task();
        let list = PyList::empty(py);
        for segment in &self.plan.segments {
            let entry = PyDict::new(py);
            entry.set_item("kind", segment.kind.to_string())?;
            entry.set_item("object", task.name_of(&task.goals[segment.goal]))?;
            entry.set_item("duration", segment.trajectory.duration())?;
            list.append(entry)?;
        }
        Ok(list)
    }

    /// Follows the plan in a kinematic simulation: final poses of all objects by name, 4 x 4 matrices. Writes a page
    /// or a binary glTF file when asked to.
    #[pyo3(signature = (view = None, glb = None))]
    fn execute<'py>(
        &self,
        py: Python<'py>,
        view: Option<PathBuf>,
        glb: Option<PathBuf>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let session = &self.session.get().session;
        let execution = py.detach(|| {
            let execution = execute(session.world(), session.task(), &self.plan, CONTROL_RATE)
                .map_err(|e| PlanError::new_err(e.to_string()))?;
            if view.is_some() || glb.is_some() {
                let recording = film(session, &execution, &self.trees);
                if let Some(path) = &view {
                    write(path, view::html(&recording).as_bytes())?;
                }
                if let Some(path) = &glb {
                    write(path, &view::glb(&recording))?;
                }
            }
            PyResult::Ok(execution)
        })?;
        let poses = PyDict::new(py);
        if let Some(last) = execution.ticks.last() {
            for (object, pose) in session.task().objects.iter().zip(&last.world_from_objects) {
                poses.set_item(&object.name, arrays::matrix(py, pose))?;
            }
        }
        Ok(poses)
    }
}

fn write(path: &Path, bytes: &[u8]) -> PyResult<()> {
    std::fs::write(path, bytes).map_err(|e| PyOSError::new_err(format!("{}: {e}", path.display())))
}
