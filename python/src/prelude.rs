//! Prelude: the names that nearly every class and function of the binding uses.

pub(crate) use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
pub(crate) use pyo3::prelude::*;
pub(crate) use pyo3::types::PyDict;

pub(crate) use crate::ctrl_c::attend;
pub(crate) use crate::error::{invalid, refused, warn_all};
pub(crate) use crate::getters::getters;
pub(crate) use crate::numbers::quoted;
pub(crate) use crate::pickle::{Reduced, pickled, restored};
pub(crate) use crate::{give, limits, read};

/// An argument that may be left out.
pub(crate) type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;
