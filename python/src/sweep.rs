//! Sweep files, read for the toolbox: values, keys and places.

use std::path::PathBuf;

use midair::files::{self, Node};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::refused;
use crate::files::{bytes_of, read};

/// The keys of a table of sweep files.
#[pyfunction]
pub(crate) fn sweep_keys(table: &str) -> Vec<&'static str> {
    files::sweep_keys(table).collect()
}

/// The tables of a sweep file.
#[pyfunction]
pub(crate) fn read_sweep(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    let tables = read(&path, &bytes_of(&path)?, |bytes, format, source| {
        files::read_sweep(bytes, format, source).map_err(refused)
    });
    value(py, &tables?)
}

/// A refusal of a file's value with its place, where it has one.
#[pyfunction]
pub(crate) fn placed(path: PathBuf, refusal: &str) -> PyResult<String> {
    read(&path, &bytes_of(&path)?, |bytes, format, source| {
        let found = files::placed(bytes, format, source, refusal);
        Ok(found.map_or_else(|| refusal.to_owned(), |error| error.to_string()))
    })
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
