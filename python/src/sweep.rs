//! Sweep files, read for the Python package: values, keys and line numbers.

use midair::files::{self, Format, Node, Source};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{error_of, refused};

/// Returns the tables in a sweep file's text; `name` is its name in errors.
#[pyfunction]
pub(crate) fn read_sweep<'py>(py: Python<'py>, text: &[u8], name: &str) -> PyResult<Bound<'py, PyAny>> {
    let tables = files::read_sweep(text, Format::of_document(name, text), Source { name, folder: None });
    value(py, &tables.map_err(refused)?)
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
    let found = files::placed(text, Format::of_document(name, text), source, &error_of(error)?);
    Ok(found.map(|found| refused(found).into_value(error.py()).into_any()))
}

fn value<'py>(py: Python<'py>, node: &Node) -> PyResult<Bound<'py, PyAny>> {
    match node {
        Node::Null => Ok(py.None().into_bound(py)),
        Node::Bool(flag) => flag.into_bound_py_any(py),
        Node::Integer(number) => number.into_bound_py_any(py),
        Node::Large(number) => number.into_bound_py_any(py),
        Node::Real(number) => number.into_bound_py_any(py),
        Node::Text(text) => text.into_bound_py_any(py),
        Node::Numbers(list) => list.into_bound_py_any(py),
        Node::List(list) => {
            list.iter().map(|node| value(py, node)).collect::<PyResult<Vec<_>>>()?.into_bound_py_any(py)
        }
        Node::Table(entries) => {
            let table = PyDict::new(py);
            for (key, node) in entries {
                table.set_item(key, value(py, node)?)?;
            }
            Ok(table.into_any())
        }
    }
}
