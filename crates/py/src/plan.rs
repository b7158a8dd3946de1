//! Sessions and plans.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use nalgebra::Point3;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use robotc_core::Seed;
use robotc_core::geom::{HeightField, PointCloud};
use robotc_core::model::{Geometry, Origin, Shape};
use robotc_core::task::Obstacle;
use robotc_planning::manipulation;
use robotc_planning::problem::unknown_keys;
use robotc_planning::{Budget, Interrupt};
use robotc_runtime::film::{TreeKeeper, film};
use robotc_runtime::{MotionTable, execute, view};

use crate::arrays;
use crate::errors::{PlanError, warn_of};
use crate::long;
use crate::motion::{self, Given, Motion, Wanted};

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

impl Session {
    fn with_seen(
        &self,
        name: &str,
        shape: Shape,
        pose: Option<PyReadonlyArray2<'_, f64>>,
        without_robot: Option<f64>,
    ) -> PyResult<Self> {
        if without_robot.is_some_and(|margin| !(0.0..=1.0).contains(&margin)) {
            return Err(PyValueError::new_err("`without_robot` is between 0 and 1 m"));
        }
        let world_from_obstacle = pose.as_ref().map(arrays::pose).transpose()?.unwrap_or_default();
        let geometry = Arc::new(vec![Geometry { origin: Origin::default(), shape, colour: None }]);
        let seen = Obstacle { name: name.to_owned(), geometry, world_from_obstacle, without_robot };
        let session = self.session.with_obstacle(seen);
        Ok(Self { session: session.map_err(|error| PyValueError::new_err(error.to_string()))? })
    }
}

/// Ticks a second of the simulated controller.
const CONTROL_RATE: f64 = 250.0;

#[pymethods]
impl Session {
    /// The joints that free motions are of.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.session.arm().names().to_vec()
    }

    /// Where the task starts.
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.session.motion_problem().start)
    }

    /// `world_from_tool`, shape (4, 4).
    fn tool<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (values, expected) = (q.as_array().to_vec(), self.session.arm().dofs().len());
        if values.len() != expected {
            let found = values.len();
            return Err(PyValueError::new_err(format!("expected {expected} joint values, got {found}")));
        }
        Ok(arrays::matrix(py, &self.session.arm().world_from_tool(&values)))
    }

    /// The same session with a cloud of points as an obstacle.
    #[pyo3(signature = (name, points, radius, pose = None, without_robot = None))]
    fn with_cloud(
        &self,
        name: &str,
        points: PyReadonlyArray2<'_, f64>,
        radius: f64,
        pose: Option<PyReadonlyArray2<'_, f64>>,
        without_robot: Option<f64>,
    ) -> PyResult<Self> {
        let points = points.as_array();
        if points.ncols() != 3 {
            return Err(PyValueError::new_err(format!(
                "points have the shape (n, 3), not {:?}",
                points.shape()
            )));
        }
        let finite = points.outer_iter().filter(|p| p.iter().all(|x| x.is_finite()));
        let cloud = PointCloud::new(finite.map(|p| Point3::new(p[0], p[1], p[2])).collect(), radius);
        let cloud = Arc::new(cloud.map_err(|error| PyValueError::new_err(error.to_string()))?);
        self.with_seen(name, Shape::Cloud { cloud, uri: String::new() }, pose, without_robot)
    }

    /// The same session with heights on a grid as an obstacle.
    #[pyo3(signature = (name, heights, spacing, floor = None, pose = None))]
    fn with_heights(
        &self,
        name: &str,
        heights: PyReadonlyArray2<'_, f64>,
        spacing: [f64; 2],
        floor: Option<f64>,
        pose: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Self> {
        let heights = heights.as_array();
        let field = HeightField::new(heights.ncols(), heights.iter().copied().collect(), spacing, floor);
        let field = Arc::new(field.map_err(|error| PyValueError::new_err(error.to_string()))?);
        self.with_seen(name, Shape::HeightField { field, uri: String::new() }, pose, None)
    }

    /// A problem of free motion with all defaults and no goal, as JSON.
    fn motion_problem(&self) -> String {
        self.session.motion_problem().write()
    }

    /// The options of `plan`, as JSON.
    fn options(&self) -> String {
        self.session.options().document()
    }

    /// Plans a free motion of the arm to one of many goals.
    #[pyo3(signature = (goals = None, poses = vec![], start = None, held = None, bodies = BTreeMap::new(),
        joints = BTreeMap::new(), problem = None, seed = None, time_limit = None, progress = None, race = None))]
    fn plan_motion(
        &self,
        py: Python<'_>,
        goals: Option<PyReadonlyArray2<'_, f64>>,
        poses: Vec<PyReadonlyArray2<'_, f64>>,
        start: Option<PyReadonlyArray1<'_, f64>>,
        held: Option<(String, PyReadonlyArray2<'_, f64>)>,
        bodies: BTreeMap<String, PyReadonlyArray2<'_, f64>>,
        joints: BTreeMap<String, f64>,
        problem: Option<Bound<'_, PyAny>>,
        seed: Option<u64>,
        time_limit: Option<f64>,
        progress: Option<Py<PyAny>>,
        race: Option<u32>,
    ) -> PyResult<Motion> {
        let given = Given { problem, bodies, joints, held };
        let wanted = Wanted { goals, poses, start, seed, race, time_limit, progress };
        motion::plan_motion(py, &self.session, &given, &wanted)
    }

    /// Where a path first meets something, or `None`.
    #[pyo3(signature = (path, held = None, bodies = BTreeMap::new(), joints = BTreeMap::new(), problem = None))]
    fn validate<'py>(
        &self,
        py: Python<'py>,
        path: PyReadonlyArray2<'py, f64>,
        held: Option<(String, PyReadonlyArray2<'py, f64>)>,
        bodies: BTreeMap<String, PyReadonlyArray2<'py, f64>>,
        joints: BTreeMap<String, f64>,
        problem: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        motion::validate(py, &self.session, &path, &Given { problem, bodies, joints, held })
    }

    /// Plans the whole task and certifies the plan. Depends on the seed alone unless the time limit ends it. `options` is JSON
    /// with what differs from the defaults.
    #[pyo3(signature = (seed = None, time_limit = 30.0, options = None))]
    fn plan(
        slf: Py<Self>,
        py: Python<'_>,
        seed: Option<u64>,
        time_limit: f64,
        options: Option<&str>,
    ) -> PyResult<Plan> {
        let this = slf.get();
        let seed = Seed::new(seed.unwrap_or(this.session.task().seed));
        let own = this.session.options();
        let options = match options {
            None => own,
            Some(text) => {
                let options = own.with_document(text).map_err(|e| PyValueError::new_err(e.to_string()))?;
                warn_of(py, &unknown_keys(text, &options))?;
                options
            }
        };
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
            entry.set_item("object", self.plan.name_of(task, segment.goal))?;
            entry.set_item("duration", segment.trajectory.duration())?;
            list.append(entry)?;
        }
        Ok(list)
    }

    /// What was taken for each goal reached, in order, and what came of the other objects that would have done.
    #[getter]
    fn choices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let task = self.session.get().session.task();
        let list = PyList::empty(py);
        for choice in &self.plan.choices {
            let entry = PyDict::new(py);
            entry.set_item("goal", choice.goal())?;
            entry.set_item("object", self.plan.name_of(task, choice.goal()))?;
            let passed_over: Vec<String> = choice.passed_over().iter().map(|o| o.to_string()).collect();
            entry.set_item("passed_over", passed_over)?;
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
