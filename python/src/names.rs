//! Finds the names of solvers and presets; case, "-" and "_" do not matter.

use midair::{Error, presets, solvers};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::refused;

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

/// Returns a hint at the known name that was probably meant, or "", and the text of the error about an unknown name.
#[pyfunction]
pub(crate) fn unknown(kind: &str, name: &str, known: Vec<String>) -> (String, String) {
    let error = Error::unknown(kind, name, known.iter().map(String::as_str));
    let hint = if let Error::Unknown { hint, .. } = &error { hint.clone() } else { String::new() };
    (hint, error.to_string())
}

/// Makes the error about an unknown keyword of `Solver.__call__`. The Python package wraps all other functions for this
/// error; `__call__` stays unwrapped, because it must be fast.
#[cold]
pub(crate) fn unknown_argument(name: &str, others: &Bound<'_, PyDict>, known: &[&str]) -> PyErr {
    let other = others.keys().iter().next().map_or_else(String::new, |key| key.to_string());
    let known = known.iter().copied();
    PyTypeError::new_err(Error::unknown(format!("argument of {name}"), other, known).to_string())
}
