//! Sweep files, read for the Python package: values, keys and line numbers.

use midair::files::{self, Format, Source};
use pyo3::prelude::*;

use crate::error::refused;
use crate::node;

/// Returns the tables in a sweep file's text; `name` is its name in errors.
#[pyfunction]
pub(crate) fn read_sweep<'py>(py: Python<'py>, text: &[u8], name: &str) -> PyResult<Bound<'py, PyAny>> {
    let tables = files::read_sweep(text, Format::of_document(name, text), Source { name, folder: None });
    node::shown(py, &tables.map_err(refused)?)
}

/// Returns the error about a value in a text, with its line if that can be found.
#[pyfunction]
pub(crate) fn placed(text: &[u8], name: &str, refusal: &str) -> String {
    let found = files::placed(text, Format::of_document(name, text), Source { name, folder: None }, refusal);
    found.map_or_else(|| refusal.to_owned(), |error| error.to_string())
}
