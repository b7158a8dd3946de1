//! A checked robot: model, kinematics.

use std::path::PathBuf;
use std::sync::Arc;

use nalgebra::Point3;
use numpy::{PyArray2, PyReadonlyArray1};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyList;
use robotc_core::spec::{self, RobotSpec};
use robotc_core::{Configuration, Kinematics, LinkIdx, LinkPoses, Sources};
use robotc_kb::os::OsSystem;

use crate::arrays;
use crate::errors::{accept, diagnostics};

/// A robot from its specification.
#[pyclass(frozen, module = "robotc")]
pub(crate) struct Robot {
    pub(crate) spec: RobotSpec,
    pub(crate) kinematics: Kinematics,
    warnings: Py<PyList>,
}

impl Robot {
    fn configuration(&self, q: &PyReadonlyArray1<'_, f64>) -> PyResult<Configuration> {
        let values: Vec<f64> = q.as_array().to_vec();
        let expected = self.kinematics.model().dofs().len();
        if values.len() != expected {
            return Err(PyValueError::new_err(format!(
                "expected {expected} joint values, got {}",
                values.len()
            )));
        }
        Ok(Configuration::from_values(values))
    }

    fn link(&self, name: &str) -> PyResult<LinkIdx> {
        let model = self.kinematics.model();
        model.link_named(name).ok_or_else(|| {
            let near = robotc_core::diag::nearest(name, model.links().iter().map(|l| l.name.as_str()));
            let hint = near.map_or(String::new(), |near| format!("; did you mean {near}?"));
            PyKeyError::new_err(format!("the robot has no link {name}{hint}"))
        })
    }
}

#[pymethods]
impl Robot {
    /// Reads a `*.robot.toml`.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let mut sources = Sources::new();
        let table = robotc_kb::kinds::parameter_table();
        let (spec, found) = spec::load_robot(&OsSystem, &mut sources, &path, &table);
        let spec = accept(py, spec, &found, &sources)?;
        let kinematics = Kinematics::new(Arc::clone(&spec.robot.model));
        Ok(Self { spec, kinematics, warnings: diagnostics(py, &found, &sources)?.unbind() })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.spec.name
    }

    #[getter]
    fn warnings(&self, py: Python<'_>) -> Py<PyList> {
        self.warnings.clone_ref(py)
    }

    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.kinematics.model().dofs().iter().map(|d| d.name.clone()).collect()
    }

    #[getter]
    fn link_names(&self) -> Vec<String> {
        self.kinematics.model().links().iter().map(|l| l.name.clone()).collect()
    }

    #[getter]
    fn arms(&self) -> Vec<String> {
        self.spec.robot.arms.iter().map(|a| a.name.clone()).collect()
    }

    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let rows: Vec<Vec<f64>> =
            self.kinematics.model().dofs().iter().map(|d| vec![d.lower, d.upper]).collect();
        arrays::rows(py, &rows, 2)
    }

    /// `root_from_link` as a 4 x 4 matrix.
    fn fk<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'py, f64>,
        link: &str,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let pose = self.kinematics.root_from_link(&self.configuration(&q)?, self.link(link)?);
        Ok(arrays::matrix(py, &pose))
    }

    /// Six rows: linear, then angular velocity of a point of the link in root axes; a column for each joint value.
    #[pyo3(signature = (q, link, point = [0.0; 3]))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'py, f64>,
        link: &str,
        point: [f64; 3],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let mut poses = LinkPoses::default();
        self.kinematics.link_poses(&self.configuration(&q)?, &mut poses);
        let jacobian = self.kinematics.jacobian(&poses, self.link(link)?, &Point3::from(point));
        let rows: Vec<Vec<f64>> = (0..6).map(|i| jacobian.row(i).iter().copied().collect()).collect();
        Ok(arrays::rows(py, &rows, jacobian.ncols()))
    }

    fn __repr__(&self) -> String {
        let model = self.kinematics.model();
        format!("Robot({:?}, {} joints, {} links)", self.spec.name, model.dofs().len(), model.links().len())
    }
}
