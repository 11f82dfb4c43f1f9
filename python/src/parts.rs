//! Parts of an array: conversion from Python and back. They are the keywords of all constructors of arrays.

use midair::{Array, Directivity, Part, PartKind, PartValue};

use crate::prelude::*;
use crate::quantization::{self, read_quantization};

/// Parts with the values that an array gets.
pub(crate) type Values = Vec<(&'static Part, PartValue)>;

/// Reads the parts by their names; parts that are missing or None do not change.
pub(crate) fn values<'py>(value: impl Fn(&str) -> PyResult<Option<Bound<'py, PyAny>>>) -> PyResult<Values> {
    let read = |part: &'static Part| {
        let value = value(part.name).transpose()?;
        Some(value.and_then(|value| Ok((part, read_part(part, &value)?))))
    };
    Array::PARTS.iter().filter_map(read).collect()
}

/// Reads the keywords of a call that accepts only parts.
pub(crate) fn keywords(call: &str, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Values> {
    let Some(keywords) = keywords else { return Ok(Values::new()) };
    for name in keywords.keys() {
        let (name, known) = (name.to_string(), Array::PARTS.iter().map(|part| part.name));
        if !known.clone().any(|part| part == name) {
            let unknown = midair::Error::unknown(format!("argument of midair.{call}"), name, known);
            return Err(PyTypeError::new_err(unknown.to_string()));
        }
    }
    values(|name| Ok(keywords.get_item(name)?.filter(|value| !value.is_none())))
}

fn read_part(part: &Part, value: &Bound<'_, PyAny>) -> PyResult<PartValue> {
    Ok(match part.kind() {
        PartKind::Real => PartValue::Real(read::real(part.name, value)?),
        PartKind::Directivity => PartValue::Directivity(read::directivity(value)?),
        PartKind::Complexes => PartValue::Complexes(read::complexes(part.name, value)?),
        PartKind::Flags => PartValue::Flags(read::flags(part.name, value)?),
        PartKind::Indices => PartValue::Indices(read::indices(part.name, value)?),
        PartKind::Quantization => PartValue::Quantization(read_quantization(value)?),
    })
}

/// Returns the value of a part as a Python object.
pub(crate) fn object(py: Python<'_>, value: PartValue) -> PyResult<Bound<'_, PyAny>> {
    Ok(match value {
        PartValue::Real(number) => number.into_pyobject(py)?.into_any(),
        PartValue::Directivity(law) => directivity(py, law)?,
        PartValue::Complexes(list) => give::list(py, list).into_any(),
        PartValue::Flags(list) => give::list(py, list).into_any(),
        PartValue::Indices(list) => give::list(py, list.into_iter().map(usize::cast_signed).collect()).into_any(),
        PartValue::Quantization(board) => quantization::object(py, &board)?.into_any(),
    })
}

fn directivity(py: Python<'_>, law: Directivity) -> PyResult<Bound<'_, PyAny>> {
    match law.name() {
        (name, None) => Ok(name.into_pyobject(py)?.into_any()),
        (name, Some(parameter)) => Ok([(name, parameter)].into_py_dict(py)?.into_any()),
    }
}

/// Returns the kind of each part by its name, for stubs and sweeps.
#[pyfunction]
pub(crate) fn array_parts(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let kind = |part: &Part| (part.name, format!("{:?}", part.kind()).to_lowercase());
    Array::PARTS.iter().map(kind).collect::<Vec<_>>().into_py_dict(py)
}
