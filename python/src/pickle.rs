//! Pickles and copies: the data from which a class is made again.

use pyo3::PyTypeInfo;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::error::invalid;

/// A part of what a solution or a batch is made of again.
pub(crate) fn part<'py>(record: &Bound<'py, PyDict>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    record.get_item(name)?.ok_or_else(|| invalid("record", &format!("without {name}"), "give one whole"))
}

/// One that can be None or left out.
pub(crate) fn part_or_none<'py>(record: &Bound<'py, PyDict>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
    Ok(record.get_item(name)?.filter(|part| !part.is_none()))
}

/// A callable and its arguments.
pub(crate) type Reduced<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

/// A value that its class's `_restore` makes of `parts`.
pub(crate) fn restored<'py, T: PyTypeInfo>(
    py: Python<'py>,
    parts: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
) -> PyResult<Reduced<'py>> {
    Ok((py.get_type::<T>().getattr("_restore")?, parts.into_pyobject(py)?))
}

/// A value that a call makes: the callable first, then its arguments.
pub(crate) fn called<'py>(call: Bound<'py, PyTuple>, keywords: &Bound<'py, PyDict>) -> PyResult<Reduced<'py>> {
    let py = keywords.py();
    let partial = py.import("functools")?.call_method("partial", call, Some(keywords))?;
    Ok((partial, PyTuple::empty(py)))
}
