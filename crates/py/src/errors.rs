//! Exceptions: one for wrong input, with its diagnostics, and ones for planning and for the machine.

use std::ffi::CString;

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use robotc_core::{Diagnostics, Severity, Sources};
use robotc_planning::problem::UnknownKey;

create_exception!(robotc, SpecificationError, PyValueError, "A specification cannot be used.");
create_exception!(robotc, CompileError, PyException, "An artefact could not be computed.");
create_exception!(robotc, PlanError, PyException, "The planner found no plan; the message says why.");

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = m.py();
    m.add("SpecificationError", py.get_type::<SpecificationError>())?;
    m.add("CompileError", py.get_type::<CompileError>())?;
    m.add("PlanError", py.get_type::<PlanError>())?;
    Ok(())
}

/// Diagnostics as a list of dictionaries: severity, code, message, path, line, column, expected, hint.
pub(crate) fn diagnostics<'py>(
    py: Python<'py>,
    found: &Diagnostics,
    sources: &Sources,
) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for d in found {
        let entry = PyDict::new(py);
        let severity = if d.severity == Severity::Error { "error" } else { "warning" };
        entry.set_item("severity", severity)?;
        entry.set_item("code", d.code)?;
        entry.set_item("message", &d.message)?;
        entry.set_item("expected", &d.expected)?;
        entry.set_item("hint", &d.hint)?;
        let place = d.span.map(|span| (sources.path(span.file), sources.line_column(span)));
        entry.set_item("path", place.map(|(path, _)| path))?;
        entry.set_item("line", place.map(|(_, at)| at.line))?;
        entry.set_item("column", place.map(|(_, at)| at.column))?;
        list.append(entry)?;
    }
    Ok(list)
}

/// The value, or all that was found as an exception with the attribute `diagnostics`.
pub(crate) fn accept<T>(
    py: Python<'_>,
    value: Option<T>,
    found: &Diagnostics,
    sources: &Sources,
) -> PyResult<T> {
    match value {
        Some(value) => Ok(value),
        None => {
            let error = SpecificationError::new_err(found.to_plain_text(sources).trim_end().to_owned());
            error.value(py).setattr("diagnostics", diagnostics(py, found, sources)?)?;
            Err(error)
        }
    }
}

/// A `UserWarning`; an error where warnings are errors.
pub(crate) fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(text).unwrap_or_default(), 1)
}

/// Warns of the keys of a document that were ignored.
pub(crate) fn warn_of(py: Python<'_>, ignored: &[UnknownKey]) -> PyResult<()> {
    ignored.iter().try_for_each(|key| warn(py, &key.to_string()))
}
