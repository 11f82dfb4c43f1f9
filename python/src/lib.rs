//! The Python door of `midair`: numpy in, numpy out, the GIL released. It reads arguments, calls the core once
//! and hands over the answer; it decides nothing.

mod array;
mod batch;
mod field;
mod level;
mod levels;
mod pulse;
mod read;
mod scene;
mod setting;
mod solve;
mod solver;
mod task;

use pyo3::prelude::*;

pyo3::create_exception!(
    midair,
    SceneError,
    pyo3::exceptions::PyValueError,
    "A request that cannot be answered: one line that names the item, its value and what to change."
);
pyo3::create_exception!(
    midair,
    SceneWarning,
    pyo3::exceptions::PyUserWarning,
    "A request that is answered, but hardly meant that way."
);

/// A core error as the exception that users see.
fn refused(error: midair::Error) -> PyErr {
    SceneError::new_err(error.to_string())
}

/// A [`SceneError`] of this door's own: an argument that never reaches the core.
fn invalid(item: &str, value: &str, cure: &str) -> PyErr {
    refused(midair::Error::invalid(item, value, cure))
}

/// The compiled core of midair; import `midair` instead.
#[pymodule]
mod _midair {
    use numpy::PyArray1;
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::array::{Array, PresetInfo, presets};
    #[pymodule_export]
    use super::batch::{Batch, BatchMetrics, solve_batch};
    #[pymodule_export]
    use super::field::{Field, Plane, bound, field, judge};
    #[pymodule_export]
    use super::scene::{Propagation, Reach, Scene};
    #[pymodule_export]
    use super::solve::{Metrics, OptionInfo, Solution, SolverInfo, solve, solvers};
    #[pymodule_export]
    use super::solver::Solver;
    #[pymodule_export]
    use super::{SceneError, SceneWarning};

    /// The first array makes the numpy crate look for NumPy; were Ctrl-C to come in between, it would panic. Imports
    /// may be interrupted.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.py().import("numpy")?;
        PyArray1::<f64>::zeros(module.py(), 0, false);
        Ok(())
    }
}
