//! Inverse kinematics generated from a URDF alone.

use std::collections::BTreeMap;
use std::path::PathBuf;

use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::exceptions::{PyKeyError, PyOSError, PyValueError};
use pyo3::prelude::*;
use robotc_core::urdf::{self, LoadOptions, MeshPolicy};
use robotc_core::{Kinematics, SerialChain, Sources};
use robotc_ikgen::generate::natural;
use robotc_ikgen::{Compiled, GoalType, Options, RustOptions, Solver, compile};
use robotc_kb::os::OsSystem;

use crate::errors::{CompileError, accept};
use crate::solving::{self, Wanted, WantedLimits};

/// A solver of one chain, usable at once, and its source.
#[pyclass(frozen, module = "robotc.ik")]
pub(crate) struct GeneratedSolver {
    compiled: Compiled,
    solver: Solver,
}

/// Compiles the chain from link `base` to link `tip` of a URDF or xacro file; `free` names joints whose values will be
/// given; `packages` says where packages are, `arguments` are values for a xacro file.
#[pyfunction(name = "_generate_ik")]
#[pyo3(signature = (
    urdf, base, tip, free = None, tolerance = None, r#type = "transform6d", *, packages = None, arguments = None
))]
#[allow(clippy::too_many_arguments, reason = "most are keywords")]
pub(crate) fn generate_ik(
    py: Python<'_>,
    urdf: PathBuf,
    base: &str,
    tip: &str,
    free: Option<Vec<String>>,
    tolerance: Option<f64>,
    r#type: &str,
    packages: Option<BTreeMap<String, PathBuf>>,
    arguments: Option<BTreeMap<String, String>>,
) -> PyResult<GeneratedSolver> {
    let mut sources = Sources::new();
    let load = LoadOptions {
        packages: packages.unwrap_or_default(),
        arguments: arguments.unwrap_or_default(),
        meshes: MeshPolicy::Ignore,
    };
    let (model, found) = urdf::load(&OsSystem, &mut sources, &urdf, &load);
    let model = accept(py, model, &found, &sources)?;
    let link = |name: &str| {
        model.link_named(name).ok_or_else(|| PyKeyError::new_err(format!("there is no link {name}")))
    };
    let (base, tip) = (link(base)?, link(tip)?);
    let chain = SerialChain::between(&Kinematics::new(model.into()), base, tip)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let position = |name: &String| {
        let position = chain.variables.iter().position(|v| v.name == *name);
        position.ok_or_else(|| PyKeyError::new_err(format!("the chain has no joint {name}")))
    };
    let mut free: Option<Vec<usize>> =
        free.map(|names| names.iter().map(position).collect::<PyResult<_>>()).transpose()?;
    if let Some(free) = &mut free {
        free.sort_unstable();
        free.dedup();
    }
    let goal = match GoalType::from_name(r#type) {
        Some(goal) => goal,
        None if r#type == "auto" => natural(&chain),
        None => {
            let known = GoalType::ALL.map(GoalType::name).join(", ");
            return Err(PyValueError::new_err(format!(
                "there is no type {:?}; there are auto, {known}",
                r#type
            )));
        }
    };
    let mut options = Options { goal, free, ..Options::default() };
    if let Some(tolerance) = tolerance {
        if !(tolerance.is_finite() && tolerance >= 0.0) {
            return Err(PyValueError::new_err("the tolerance cannot be negative"));
        }
        options.tolerance = tolerance;
    }
    let compiled =
        py.detach(|| compile(&chain, &options)).map_err(|refusal| CompileError::new_err(refusal.reason))?;
    Ok(GeneratedSolver { solver: compiled.solver(), compiled })
}

#[pymethods]
impl GeneratedSolver {
    /// Class of the chain and how it is solved.
    #[getter]
    fn kind(&self) -> &str {
        &self.compiled.class
    }

    /// What it is asked for: the name of the goal type.
    #[getter]
    fn r#type(&self) -> &'static str {
        self.compiled.program.goal.name()
    }

    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.compiled.chain().variables.iter().map(|v| v.name.clone()).collect()
    }

    #[getter]
    fn free_joints(&self) -> Vec<String> {
        let variables = &self.compiled.longer_chain().variables;
        self.compiled.free.iter().map(|&i| variables[i].name.clone()).collect()
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
        solving::solve(py, &self.solver, &self.free_joints(), &pose, &free, wanted)
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
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, f64)> {
        solving::free_intervals(py, &self.solver, &self.free_joints(), &pose, joint, free, limits)
    }

    /// `base_from_tip` at these joint values, as a 4 x 4 matrix.
    fn fk<'py>(&self, py: Python<'py>, joints: Vec<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        solving::forward(py, self.compiled.chain(), &joints)
    }

    /// Writes the solver to a file: Rust (`.rs`), C with its header beside it (`.c`), or the solution program (`.ik`).
    fn write(&self, path: PathBuf) -> PyResult<()> {
        let write = |path: &PathBuf, text: &str| {
            std::fs::write(path, text).map_err(|e| PyOSError::new_err(format!("{}: {e}", path.display())))
        };
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("rs") => write(&path, &self.compiled.rust_source(&RustOptions::default())),
            Some("ik") => write(&path, &self.compiled.text()),
            Some("c") => {
                let stem = path.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
                let source = self.compiled.c_source(&stem);
                let source = source.map_err(|error| PyValueError::new_err(error.to_string()))?;
                write(&path.with_extension("h"), &source.header)?;
                write(&path, &source.source)
            }
            _ => Err(PyValueError::new_err("the name must end in .rs, .c or .ik")),
        }
    }
}
