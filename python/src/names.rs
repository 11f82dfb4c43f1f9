//! Finds the names of solvers and presets; case, "-" and "_" do not matter.

use midair::{Error, presets, solvers};

use crate::prelude::*;

/// Returns a solver's name as `midair.solvers` lists it.
#[pyfunction]
pub(crate) fn solver_name(name: &str) -> PyResult<&'static str> {
    Ok(solvers::find(name).map_err(refused)?.info.name)
}

/// Returns a preset's name as `midair.presets` lists it.
#[pyfunction]
pub(crate) fn preset_name(name: &str) -> PyResult<&'static str> {
    Ok(presets::find(name).map_err(refused)?.name)
}

/// Returns the known name that was probably meant, or "".
#[pyfunction]
pub(crate) fn nearest(name: Lossy, known: Vec<String>) -> String {
    Error::unknown("", &*name, known.iter().map(String::as_str)).other.clone()
}

/// Makes the error about an unknown keyword of `Solver.__call__`. The Python package wraps all other functions for this
/// error; `__call__` stays unwrapped, because it must be fast.
#[cold]
pub(crate) fn unknown_argument(name: &str, others: &Bound<'_, PyDict>, known: &[&str]) -> PyErr {
    let other = others.keys().iter().next().map_or_else(String::new, |key| key.to_string());
    let known = known.iter().copied();
    PyTypeError::new_err(Error::unknown(format!("argument of {name}"), other, known).to_string())
}
