//! The argument `bead`, the sphere for which traps are made: conversion from Python and back.

use midair::{Bead, Particle};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

use crate::error::{invalid, refused};
use crate::numbers::quoted;
use crate::read;

/// Reads a bead from a dict; missing keys have their defaults.
pub(crate) fn read_bead(value: &Bound<'_, PyAny>) -> PyResult<Bead> {
    let Ok(given) = value.cast::<PyDict>() else {
        return Err(invalid("bead", &quoted(value), "give a dict such as {\"radius\": 1e-3, \"density\": 29}"));
    };
    let (mut numbers, mut gravity) = (Vec::new(), None);
    for (name, value) in given.iter() {
        let name = name.to_string();
        let Some(key) = Bead::KEYS.iter().find(|key| key.name == name) else {
            let known = Bead::KEYS.iter().map(|key| key.name);
            return Err(refused(midair::Error::unknown("key of bead", name, known)));
        };
        let item = format!("bead.{name}");
        match Particle::key(key.name) {
            Some(key) => numbers.push((key.name, read::real(&item, &value)?)),
            None => gravity = Some(read::place(&item, &value)?),
        }
    }
    Bead::default().with(&numbers, gravity).map_err(refused)
}

/// Returns a dict with all keys of a bead.
pub(crate) fn shown_bead(py: Python<'_>, bead: Bead) -> PyResult<Bound<'_, PyDict>> {
    let dict = bead.particle.numbers().collect::<Vec<_>>().into_py_dict(py)?;
    dict.set_item("gravity", bead.gravity.to_vec())?;
    Ok(dict)
}
