//! Prelude: the names that nearly every class and function of the binding uses.

pub(crate) use std::sync::Arc;

pub(crate) use midair::{Choice, Complex32, Complex64, Control, Extras, Model, Problem, Request};
pub(crate) use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods,
};
pub(crate) use pyo3::exceptions::PyTypeError;
pub(crate) use pyo3::prelude::*;
pub(crate) use pyo3::types::{IntoPyDict, PyDict, PyString, PyTuple};

pub(crate) use crate::ctrl_c::attend;
pub(crate) use crate::error::{Lossy, invalid, refused, warn_all};
pub(crate) use crate::getters::{bits, getters, hashed};
pub(crate) use crate::give::{Array1, Array2, Array3};
pub(crate) use crate::numbers::quoted;
pub(crate) use crate::pickle::{Reduced, pickled, restored};
pub(crate) use crate::read::{Argument, unexpected};
pub(crate) use crate::{give, limits, read};
