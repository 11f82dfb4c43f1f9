//! Listed names for a typed name, ignoring case, "-" and "_".

use midair::{Error, presets, solvers};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::refused;

/// The listed name of a solver.
#[pyfunction]
pub(crate) fn solver_name(name: &str) -> PyResult<&'static str> {
    Ok(solvers::find(name).map_err(refused)?.info.name)
}

/// The listed name of a preset.
#[pyfunction]
pub(crate) fn preset_name(name: &str) -> PyResult<&'static str> {
    Ok(presets::find(name).map_err(refused)?.name)
}

/// The hint at the known name that an unknown one probably means, or ""; and the line that rejects it.
#[pyfunction]
pub(crate) fn unknown(kind: &str, name: &str, known: Vec<String>) -> (String, String) {
    let error = Error::unknown(kind, name, known.iter().map(String::as_str));
    let hint = if let Error::Unknown { hint, .. } = &error { hint.clone() } else { String::new() };
    (hint, error.to_string())
}

/// Rejects a keyword that a call does not have. Python does so for all functions except `Solver.__call__`, the fastest one.
#[cold]
pub(crate) fn unknown_argument(name: &str, others: &Bound<'_, PyDict>, known: &[&str]) -> PyErr {
    let other = others.keys().iter().next().map_or_else(String::new, |key| key.to_string());
    let known = known.iter().copied();
    PyTypeError::new_err(Error::unknown(format!("argument of {name}"), other, known).to_string())
}
