//! Free motions of the arm of a session: planned from goals, and validated.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use robotc_planning::problem::{HeldDocument, PoseDocument, unknown_keys};
use robotc_planning::{Interrupt, PlanningProblem, Registry};
use robotc_runtime::motion::interrupted;

use crate::arrays;
use crate::errors::{PlanError, warn_of};
use crate::long;

/// A free motion of an arm.
#[pyclass(frozen, module = "robotc")]
pub(crate) struct Motion {
    motion: robotc_runtime::Motion,
    seconds: f64,
}

/// Calls between two reports of progress.
const EVERY: u32 = 256;

/// What the arguments of a call say about a problem.
pub(crate) struct Given<'py> {
    /// A document, as JSON text or as a dictionary.
    pub(crate) problem: Option<Bound<'py, PyAny>>,
    /// Where bodies are, by name.
    pub(crate) bodies: BTreeMap<String, PyReadonlyArray2<'py, f64>>,
    /// Values of joints that are not planned for, by name.
    pub(crate) joints: BTreeMap<String, f64>,
    /// An object in the gripper, and where it is in the tool frame.
    pub(crate) held: Option<(String, PyReadonlyArray2<'py, f64>)>,
}

impl Given<'_> {
    fn problem(&self, session: &robotc_runtime::Session) -> PyResult<PlanningProblem> {
        let mut problem = match &self.problem {
            None => session.motion_problem(),
            Some(document) => {
                let text: String = match document.extract() {
                    Ok(text) => text,
                    Err(_) => document.py().import("json")?.call_method1("dumps", (document,))?.extract()?,
                };
                let problem =
                    session.read_problem(&text).map_err(|error| PyValueError::new_err(error.to_string()))?;
                warn_of(document.py(), &unknown_keys(&text, &problem))?;
                problem
            }
        };
        for (name, pose) in &self.bodies {
            problem.situation.bodies.insert(name.clone(), PoseDocument::of(&arrays::pose(pose)?));
        }
        problem.situation.joints.extend(self.joints.clone());
        if let Some((object, pose)) = &self.held {
            let tool_from_object = PoseDocument::of(&arrays::pose(pose)?);
            problem.situation.held = Some(HeldDocument { object: object.clone(), tool_from_object });
        }
        Ok(problem)
    }
}

/// From where to where, and how long.
pub(crate) struct Wanted<'py> {
    pub(crate) goals: Option<PyReadonlyArray2<'py, f64>>,
    pub(crate) poses: Vec<PyReadonlyArray2<'py, f64>>,
    pub(crate) start: Option<PyReadonlyArray1<'py, f64>>,
    pub(crate) seed: Option<u64>,
    pub(crate) race: Option<u32>,
    pub(crate) time_limit: Option<f64>,
    pub(crate) progress: Option<Py<PyAny>>,
}

/// Plans a free motion.
pub(crate) fn plan_motion(
    py: Python<'_>,
    session: &robotc_runtime::Session,
    given: &Given<'_>,
    wanted: &Wanted<'_>,
) -> PyResult<Motion> {
    let mut problem = given.problem(session)?;
    if let Some(start) = &wanted.start {
        problem.start = start.as_array().to_vec();
    }
    if let Some(goals) = &wanted.goals {
        problem.goals.extend(goals.as_array().outer_iter().map(|row| row.to_vec()));
    }
    for pose in &wanted.poses {
        problem.tool_goals.push(PoseDocument::of(&arrays::pose(pose)?));
    }
    problem.seed = wanted.seed.unwrap_or(problem.seed);
    problem.race = wanted.race.unwrap_or(problem.race);
    problem.time_limit = wanted.time_limit.or(problem.time_limit);
    problem.check().map_err(|error| PyValueError::new_err(error.to_string()))?;
    let start = Instant::now();
    let calls = AtomicU32::new(0);
    let progress = wanted.progress.as_ref();
    let (motion, seconds) = long::run(py, |interrupts| {
        let interrupt = || {
            let elapsed = start.elapsed().as_secs_f64();
            if let Some(progress) = progress
                && calls.fetch_add(1, Ordering::Relaxed).is_multiple_of(EVERY)
                && Python::attach(|py| told(py, progress, elapsed, interrupts))
            {
                return Some(Interrupt::Cancelled);
            }
            interrupted(&problem, elapsed, interrupts.stop())
        };
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let motion = session.solve_motion(&problem, &Registry::standard(), threads, &interrupt);
        (motion, start.elapsed().as_secs_f64())
    })?;
    let motion = motion.map_err(|error| match error {
        robotc_runtime::MotionError::NoPath(_) => PlanError::new_err(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    })?;
    Ok(Motion { motion, seconds })
}

/// Tells the seconds so far; whether the search shall stop, because of what was returned or raised.
fn told(py: Python<'_>, progress: &Py<PyAny>, elapsed: f64, interrupts: &long::Interrupts) -> bool {
    match progress.call1(py, (elapsed,)) {
        Ok(answer) => {
            answer.bind(py).is_instance_of::<pyo3::types::PyBool>() && !answer.is_truthy(py).unwrap_or(true)
        }
        Err(error) => {
            interrupts.keep(Err(error));
            true
        }
    }
}

/// Where a path first meets something.
pub(crate) fn validate<'py>(
    py: Python<'py>,
    session: &robotc_runtime::Session,
    path: &PyReadonlyArray2<'py, f64>,
    given: &Given<'_>,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let problem = given.problem(session)?;
    let path: Vec<Vec<f64>> = path.as_array().outer_iter().map(|row| row.to_vec()).collect();
    let found = py.detach(|| session.validate_path(&problem, &path));
    let Some(contact) = found.map_err(|error| PyValueError::new_err(error.to_string()))? else {
        return Ok(None);
    };
    let entry = PyDict::new(py);
    entry.set_item("edge", contact.edge)?;
    entry.set_item("fraction", contact.fraction)?;
    entry.set_item("q", PyArray1::from_slice(py, &contact.q))?;
    entry.set_item("link", contact.link)?;
    entry.set_item("body", contact.body)?;
    entry.set_item("depth", contact.depth)?;
    entry.set_item("message", contact.message)?;
    Ok(Some(entry))
}

#[pymethods]
impl Motion {
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.motion.trajectory.names().to_vec()
    }

    #[getter]
    fn path<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::rows(py, &self.motion.solved.path, self.motion.trajectory.dofs().len())
    }

    #[getter]
    fn goal(&self) -> usize {
        self.motion.solved.goal
    }

    #[getter]
    fn length(&self) -> f64 {
        self.motion.solved.length
    }

    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.motion.trajectory.duration()
    }

    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.motion.trajectory.times())
    }

    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let rows: Vec<Vec<f64>> =
            self.motion.trajectory.knots().iter().map(|k| k.positions.clone()).collect();
        arrays::rows(py, &rows, self.motion.trajectory.dofs().len())
    }

    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let rows: Vec<Vec<f64>> =
            self.motion.trajectory.knots().iter().map(|k| k.velocities.clone()).collect();
        arrays::rows(py, &rows, self.motion.trajectory.dofs().len())
    }
}
