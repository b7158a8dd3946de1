//! x
use pyo3::prelude::*;
#[pymodule]
fn _robotc(_m: &Bound<'_, PyModule>) -> PyResult<()> { Ok(()) }
