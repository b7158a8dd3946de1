//! A checked task.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyList;
use robotc_core::Sources;
use robotc_core::spec::{self, TaskSpec};
use robotc_kb::os::OsSystem;

use crate::errors::{accept, diagnostics};

/// A task from its specification.
#[pyclass(frozen, module = "robotc")]
pub(crate) struct Task {
    pub(crate) spec: TaskSpec,
    warnings: Py<PyList>,
}

#[pymethods]
impl Task {
    /// Reads a `*.task.toml` with the robot it names.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let mut sources = Sources::new();
        let table = robotc_kb::kinds::parameter_table();
        let (spec, found) = spec::load_task(&OsSystem, &mut sources, &path, &table);
        let spec = accept(py, spec, &found, &sources)?;
        Ok(Self { spec, warnings: diagnostics(py, &found, &sources)?.unbind() })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.spec.task.name
    }

    #[getter]
    fn warnings(&self, py: Python<'_>) -> Py<PyList> {
        self.warnings.clone_ref(py)
    }

    #[getter]
    fn objects(&self) -> Vec<String> {
        self.spec.task.objects.iter().map(|o| o.name.clone()).collect()
    }

    #[getter]
    fn obstacles(&self) -> Vec<String> {
        self.spec.task.obstacles.iter().map(|o| o.name.clone()).collect()
    }

    fn __repr__(&self) -> String {
        let task = &self.spec.task;
        format!("Task({:?}, {} objects, {} goals)", task.name, task.objects.len(), task.goals.len())
    }
}
