//! Inverse kinematics generated from a URDF alone.

use std::collections::BTreeMap;
use std::path::PathBuf;

use pyo3::exceptions::{PyKeyError, PyOSError, PyValueError};
use pyo3::prelude::*;
use robotc_core::urdf::{self, LoadOptions, MeshPolicy};
use robotc_core::{Kinematics, SerialChain, Sources};
use robotc_ikgen::backend::COptions;
use robotc_ikgen::generate::natural;
use robotc_ikgen::{Compiled, GoalType, Options, RustOptions, compile};
use robotc_kb::os::OsSystem;

use crate::errors::{CompileError, accept};
use crate::inverse::InverseKinematics;

/// A solver of one chain, usable at once, and its source.
#[pyclass(frozen, extends = InverseKinematics, module = "robotc.ik")]
pub(crate) struct GeneratedSolver {
    compiled: Compiled,
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
) -> PyResult<Py<GeneratedSolver>> {
    let mut sources = Sources::new();
    let load = LoadOptions {
        packages: packages.unwrap_or_default(),
        arguments: arguments.unwrap_or_default(),
        meshes: MeshPolicy::Ignore,
        ..LoadOptions::default()
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
    let variables = &compiled.longer_chain().variables;
    let free_joints = compiled.free.iter().map(|&i| variables[i].name.clone()).collect();
    let solves =
        InverseKinematics { chain: compiled.chain().clone(), solver: compiled.solver(), free_joints };
    Py::new(py, PyClassInitializer::from(solves).add_subclass(GeneratedSolver { compiled }))
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

    /// Writes the solver to a file: Rust (`.rs`), C with its header beside it (`.c`), or the solution program (`.ik`). With `calibrated`
    /// the source finds all branches of measured arms too.
    #[pyo3(signature = (path, *, calibrated=false))]
    fn write(&self, path: PathBuf, calibrated: bool) -> PyResult<()> {
        let write = |path: &PathBuf, text: &str| {
            std::fs::write(path, text).map_err(|e| PyOSError::new_err(format!("{}: {e}", path.display())))
        };
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("rs") => write(
                &path,
                &self.compiled.rust_source(&RustOptions { calibrated, ..RustOptions::default() }),
            ),
            Some("ik") => write(&path, &self.compiled.text()),
            Some("c") => {
                let stem = path.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
                let source = self.compiled.c_source(&stem, &COptions { calibrated });
                let source = source.map_err(|error| PyValueError::new_err(error.to_string()))?;
                write(&path.with_extension("h"), &source.header)?;
                write(&path, &source.source)
            }
            _ => Err(PyValueError::new_err("the name must end in .rs, .c or .ik")),
        }
    }
}
