//! The argument `signature`, factors that turn foci into traps: conversion from Python and back.

use midair::Signature;
use pyo3::types::PyList;

use crate::numbers::{NUMBER, shaped};
use crate::prelude::*;

/// Reads a signature: a name, a list with a name or None for each point, or factors (N,) or (M, N) for N `transducers`.
pub(crate) fn read_signature(value: &Bound<'_, PyAny>, transducers: usize) -> PyResult<Signature> {
    if let Ok(name) = value.cast::<PyString>() {
        return Signature::named(&name.to_string()).map_err(refused);
    }
    if let Ok(list) = value.cast::<PyList>()
        && list.iter().any(|one| one.is_none() || one.is_instance_of::<PyString>())
    {
        let one = |(j, one): (usize, Bound<'_, PyAny>)| match one.cast::<PyString>() {
            _ if one.is_none() => Ok(Signature::Focus),
            Ok(name) => Signature::of_point(&name.to_string()).map_err(refused),
            Err(_) => Err(invalid(&format!("signature[{j}]"), &quoted(&one), "give a name, or None for a focus")),
        };
        let each: Vec<_> = list.iter().enumerate().map(one).collect::<PyResult<_>>()?;
        return Ok(Signature::Each(each.into()));
    }
    let cure = "give \"trap\", \"twin\", \"vortex\" or complex factors of shape (N,) or (M, N)";
    let fits = |shape: &[usize]| shape.len() <= 2 && shape.last() == Some(&transducers);
    Ok(Signature::Given(shaped::<Complex64>("signature", value, NUMBER, cure, fits)?.values.into()))
}

/// Returns a signature in the form in which it was given, its factors as complex128.
pub(crate) fn signature_object<'py>(
    py: Python<'py>,
    signature: Option<&Signature>,
    transducers: usize,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    Ok(match signature {
        Some(Signature::Given(factors)) if factors.len() == transducers => {
            Some(give::list(py, factors.to_vec()).into_any())
        }
        Some(Signature::Given(factors)) => {
            Some(give::table(py, factors.to_vec(), [factors.len() / transducers, transducers])?.into_any())
        }
        Some(Signature::Each(each)) => {
            let names = each.iter().map(|one| one.name().filter(|_| *one != Signature::Focus));
            Some(PyList::new(py, names)?.into_any())
        }
        named => named.and_then(Signature::name).map(|name| PyString::new(py, name).into_any()),
    })
}
