//! Builds by many workers: what there is to do, and doing one part of it.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use robotc_kb::depot::{self, Depot, Work};
use robotc_kb::{Graph, Project, Shard, Store};

use crate::errors::CompileError;
use crate::knowledge::{Subject, Watch};
use crate::long;

fn graph(subject: &Subject<'_>) -> PyResult<Graph> {
    let project = match subject {
        Subject::Task(task) => Project::of_task(&task.spec),
        Subject::Robot(robot) => Project::of_robot(&robot.spec),
    };
    Graph::plan(&project).map_err(failed)
}

fn failed(error: impl std::fmt::Display) -> PyErr {
    CompileError::new_err(error.to_string())
}

/// What a depot may need beside its address.
fn settings() -> Vec<(String, String)> {
    let text =
        |(name, value): (OsString, OsString)| Some((name.into_string().ok()?, value.into_string().ok()?));
    std::env::vars_os().filter_map(text).collect()
}

/// The artefacts that a subject needs, inputs first: recipe, kind, subjects, inputs, most shards, level.
#[pyfunction]
pub(crate) fn plan_build<'py>(py: Python<'py>, subject: Subject<'_>) -> PyResult<Bound<'py, PyList>> {
    let graph = graph(&subject)?;
    let list = PyList::empty(py);
    for (node, level) in graph.nodes().iter().zip(graph.levels()) {
        let step = PyDict::new(py);
        let inputs: Vec<String> =
            node.inputs.iter().map(|&input| graph.node(input).recipe.to_string()).collect();
        step.set_item("recipe", node.recipe.to_string())?;
        step.set_item("kind", node.kind_name())?;
        step.set_item("subjects", &node.subjects)?;
        step.set_item("inputs", inputs)?;
        step.set_item("shards", if node.kind.info().in_pieces { robotc_kb::context::PIECES } else { 1 })?;
        step.set_item("level", level)?;
        list.append(step)?;
    }
    Ok(list)
}

/// Computes one artefact, or the shard `i/n` of it, with what the depot has, and puts it there. `True` when the artefact is
/// complete.
#[pyfunction]
#[pyo3(signature = (subject, recipe, depot, store, shard = "0/1"))]
pub(crate) fn build(
    py: Python<'_>,
    subject: Subject<'_>,
    recipe: &str,
    depot: &str,
    store: PathBuf,
    shard: &str,
) -> PyResult<bool> {
    let graph = Arc::new(graph(&subject)?);
    let shard: Shard = shard.parse().map_err(PyValueError::new_err)?;
    let [node] = graph.with_recipe(recipe)[..] else {
        return Err(PyValueError::new_err(format!("not the recipe of one artefact: {recipe}")));
    };
    let worked = long::run(py, |interrupts| {
        let shared = depot::open(depot, &settings()).map_err(failed)?;
        let store = Arc::new(Store::open(&store).map_err(failed)?);
        let depot: &dyn Depot = &*shared;
        depot::work(&graph, &store, depot, node, shard, &Watch::silent(interrupts)).map_err(failed)
    })??;
    Ok(!matches!(worked, Work::Shard { .. }))
}
