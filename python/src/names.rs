//! Names as they are listed, for those that somebody typed: whatever their case, "-" and "_".

use midair::{presets, solvers};
use pyo3::prelude::*;

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
