//! Sweep files, read for the Python package: values, keys and line numbers.

use midair::files::{self, Format, Source};
use pyo3::prelude::*;

use crate::error::{error_of, refused};
use crate::node;

/// Returns the tables in a sweep file's text; `name` is its name in errors.
#[pyfunction]
pub(crate) fn read_sweep<'py>(py: Python<'py>, text: &[u8], name: &str) -> PyResult<Bound<'py, PyAny>> {
    let tables = files::read_sweep(text, Format::of_document(name, text), Source { name, folder: None });
    node::object(py, &tables.map_err(refused)?)
}

/// Returns the SceneError about a value in a text with its line; None if the text has no such value.
///
/// Parameters
/// ----------
/// error : midair.SceneError
///
/// Returns
/// -------
/// midair.SceneError or None
#[pyfunction]
pub(crate) fn placed(text: &[u8], name: &str, error: &Bound<'_, PyAny>) -> PyResult<Option<Py<PyAny>>> {
    let source = Source { name, folder: None };
    let fault = files::placed(text, Format::of_document(name, text), source, &error_of(error)?);
    Ok(fault.map(|fault| refused(fault).into_value(error.py()).into_any()))
}
