//! Tables of numbers, texts and tables, as scene files have them, from and to Python.

use midair::files::Node;
use pyo3::IntoPyObjectExt;
use pyo3::types::{PyInt, PyList};

use crate::numbers::{DEEPEST, Numbers, REAL, array};
use crate::prelude::*;

/// Reads a table.
pub(crate) fn table(table: &Bound<'_, PyDict>) -> PyResult<Node> {
    inner_table(table, 0)
}

fn inner_table(table: &Bound<'_, PyDict>, depth: usize) -> PyResult<Node> {
    let pair = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key = key.extract::<String>()?;
        let node = entry(&key, &value, depth)?;
        Ok((key, node))
    };
    table.iter().map(pair).collect::<PyResult<_>>().map(Node::Table)
}

/// Reads a value of a table: a flag, a text, numbers of any shape, or a table.
pub(crate) fn read(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Node> {
    entry(item, value, 0)
}

fn entry(item: &str, value: &Bound<'_, PyAny>, depth: usize) -> PyResult<Node> {
    if value.is_none() {
        return Ok(Node::Null);
    }
    if let Ok(flag) = value.extract() {
        return Ok(Node::Bool(flag));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Node::Text(text.to_string_lossy().into_owned()));
    }
    if let Ok(table) = value.cast::<PyDict>()
        && depth < DEEPEST
    {
        return inner_table(table, depth + 1);
    }
    if value.is_instance_of::<PyInt>()
        && let Ok(number) = value.extract()
    {
        return Ok(Node::Integer(number));
    }
    let array = array(item, value, REAL, "give numbers");
    // Lists that are no array of numbers are rejected by name later, at the first entry that is wrong.
    if array.is_err() && depth < DEEPEST && (value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>()) {
        return value.try_iter()?.map(|inner| entry(item, &inner?, depth + 1)).collect::<PyResult<_>>().map(Node::List);
    }
    let (array, kind) = array?;
    let Numbers { values, shape } = Numbers::<f64>::of(&array)?;
    Ok(nested(&values, &shape, kind != 'f'))
}

/// Returns an array as lists of lists.
fn nested(values: &[f64], shape: &[usize], whole: bool) -> Node {
    match shape {
        [] if whole => Node::Integer(values[0] as i64),
        [] => Node::Real(values[0]),
        [_, rest @ ..] if values.is_empty() || rest.contains(&0) => Node::List(Vec::new()),
        [count, rest @ ..] => {
            let rows = values.chunks(values.len() / count).map(|row| nested(row, rest, whole));
            Node::list(rows.collect())
        }
    }
}

/// Returns a value of a table as a Python object.
pub(crate) fn object<'py>(py: Python<'py>, node: &Node) -> PyResult<Bound<'py, PyAny>> {
    match node {
        Node::Null => Ok(py.None().into_bound(py)),
        Node::Bool(flag) => flag.into_bound_py_any(py),
        Node::Integer(number) => number.into_bound_py_any(py),
        Node::Large(number) => number.into_bound_py_any(py),
        Node::Real(number) => number.into_bound_py_any(py),
        Node::Text(text) => text.into_bound_py_any(py),
        Node::Numbers(list) => list.into_bound_py_any(py),
        Node::List(list) => {
            list.iter().map(|node| object(py, node)).collect::<PyResult<Vec<_>>>()?.into_bound_py_any(py)
        }
        Node::Table(entries) => {
            let table = PyDict::new(py);
            for (key, node) in entries {
                table.set_item(key, object(py, node)?)?;
            }
            Ok(table.into_any())
        }
    }
}
