//! Knowledge bases: compiling into one and looking at what it holds.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use robotc_kb::{Event, Graph, Knowledge, Observer, Outcome, Project, Store};

use crate::errors::{CompileError, PlanError, warn};
use crate::inverse::InverseKinematics;
use crate::long::{self, Interrupts};
use crate::plan::Session;
use crate::robot::Robot;
use crate::task::Task;

/// Everything that was compiled for a robot or a task.
#[pyclass(frozen, module = "robotc")]
pub(crate) struct KnowledgeBase {
    knowledge: Knowledge,
    built: usize,
}

#[derive(FromPyObject)]
pub(crate) enum Subject<'py> {
    Task(PyRef<'py, Task>),
    Robot(PyRef<'py, Robot>),
}

/// Passes progress on to a Python callable and asks whether to go on.
pub(crate) struct Watch<'a> {
    interrupts: &'a Interrupts,
    progress: Option<Py<PyAny>>,
}

impl<'a> Watch<'a> {
    /// Without a callable.
    pub(crate) fn silent(interrupts: &'a Interrupts) -> Self {
        Self { interrupts, progress: None }
    }
}

impl Observer for Watch<'_> {
    fn event(&self, event: Event<'_>) {
        if let Event::Warning { kind, subject, message } = event {
            let warned = Python::attach(|py| warn(py, &format!("{kind} of {subject}: {message}")));
            self.interrupts.keep(warned);
            return;
        }
        let Some(progress) = &self.progress else { return };
        let told = match event {
            Event::Started { kind, subject, .. } => Some((kind, subject, 0.0)),
            // Finished is what is stored: it is told as 1, and nothing else is.
            Event::Progress { kind, subject, done, total } if done < total => {
                Some((kind, subject, done as f64 / total as f64))
            }
            Event::Stored { kind, subject, .. } => Some((kind, subject, 1.0)),
            _ => None,
        };
        if let Some(arguments) = told {
            self.interrupts.keep(Python::attach(|py| progress.call1(py, arguments).map(drop)));
        }
    }

    fn cancelled(&self) -> bool {
        self.interrupts.stop()
    }
}

#[pymethods]
impl KnowledgeBase {
    /// Compiles what `subject` needs and `store` lacks. `progress(kind, subject, fraction)` is called now and
    /// then; the fraction is 1 when the artefact is stored.
    #[new]
    #[pyo3(signature = (subject, store, progress = None))]
    fn new(
        py: Python<'_>,
        subject: Subject<'_>,
        store: PathBuf,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let project = match &subject {
            Subject::Task(task) => Project::of_task(&task.spec),
            Subject::Robot(robot) => Project::of_robot(&robot.spec),
        };
        let report = long::run(py, |interrupts| {
            let failed = |e: &dyn std::fmt::Display| CompileError::new_err(e.to_string());
            let graph = Graph::plan(&project).map_err(|e| failed(&e))?;
            let store = Store::open(&store).map_err(|e| failed(&e))?;
            let watch = Watch { interrupts, progress };
            robotc_kb::compile(&Arc::new(graph), &Arc::new(store), &watch).map_err(|e| failed(&e))
        })??;
        let failures: Vec<String> = report
            .outcomes
            .iter()
            .zip(report.knowledge.graph().nodes())
            .filter_map(|(outcome, node)| match outcome {
                Outcome::Failed(error) => Some(format!("{}: {error}", node.title())),
                _ => None,
            })
            .collect();
        if !report.complete() {
            return Err(CompileError::new_err(failures.join("\n")));
        }
        let built = report.built().count();
        Ok(Self { knowledge: report.knowledge, built })
    }

    /// Number of artefacts that were computed; the others were there.
    #[getter]
    fn built(&self) -> usize {
        self.built
    }

    /// Kind, subject, key and content hash of all artefacts.
    #[getter]
    fn artefacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        let graph = self.knowledge.graph();
        for index in graph.indices() {
            let node = graph.node(index);
            let known = self.knowledge.known(index);
            for subject in &node.subjects {
                let entry = PyDict::new(py);
                entry.set_item("kind", node.kind_name())?;
                entry.set_item("subject", subject)?;
                entry.set_item("key", known.map(|k| k.key.to_string()))?;
                entry.set_item("content", known.map(|k| k.content.to_string()))?;
                list.append(entry)?;
            }
        }
        Ok(list)
    }

    /// The solver of an arm; the first arm without a name.
    #[pyo3(signature = (arm = None))]
    fn inverse_kinematics(&self, arm: Option<&str>) -> PyResult<InverseKinematics> {
        InverseKinematics::load(&self.knowledge, arm)
    }

    /// The task with its artefacts, ready to be planned.
    fn session(&self) -> PyResult<Session> {
        let session = robotc_runtime::Session::open(&self.knowledge);
        Ok(Session { session: session.map_err(|e| PlanError::new_err(e.to_string()))? })
    }
}
