//! The Python package's native module: specifications, knowledge bases, kinematics, planning and runs.
//!
//! Arrays are numpy arrays of `float64`, metres and radians. Long calls release the interpreter lock and stop at
//! Ctrl-C. Everything that is wrong with a specification comes as one `SpecificationError` with all diagnostics.

mod arrays;
mod distributed;
mod errors;
mod generate;
mod inverse;
mod knowledge;
mod long;
mod motion;
mod plan;
mod robot;
mod solving;
mod task;

use pyo3::prelude::*;

#[pymodule]
fn _robotc(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    errors::register(m)?;
    m.add_function(wrap_pyfunction!(distributed::plan_build, m)?)?;
    m.add_function(wrap_pyfunction!(distributed::build, m)?)?;
    m.add_class::<robot::Robot>()?;
    m.add_class::<task::Task>()?;
    m.add_class::<knowledge::KnowledgeBase>()?;
    m.add_class::<inverse::InverseKinematics>()?;
    m.add_function(wrap_pyfunction!(generate::generate_ik, m)?)?;
    m.add_class::<plan::Session>()?;
    m.add_class::<plan::Plan>()?;
    m.add_class::<motion::Motion>()?;
    Ok(())
}
