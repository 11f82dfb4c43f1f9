//! Pickles and copies: the data from which Python makes an equal object.

use pyo3::PyTypeInfo;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::error::invalid;

/// Returns a part of a pickled solution or batch; raises SceneError if it is missing.
pub(crate) fn part<'py>(record: &Bound<'py, PyDict>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    record.get_item(name)?.ok_or_else(|| invalid("record", &format!("without {name}"), "give one whole"))
}

/// Returns a part that may be None or missing.
pub(crate) fn part_or_none<'py>(record: &Bound<'py, PyDict>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
    Ok(record.get_item(name)?.filter(|part| !part.is_none()))
}

/// A callable and its arguments, as `__reduce__` returns them.
pub(crate) type Reduced<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

/// Pickles an object as a call of its class's `_restore` with `parts`.
pub(crate) fn restored<'py, T: PyTypeInfo>(
    py: Python<'py>,
    parts: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
) -> PyResult<Reduced<'py>> {
    Ok((py.get_type::<T>().getattr("_restore")?, parts.into_pyobject(py)?))
}

/// Pickles an object as a call with keywords: `call` has the callable, then its arguments.
pub(crate) fn called<'py>(call: Bound<'py, PyTuple>, keywords: &Bound<'py, PyDict>) -> PyResult<Reduced<'py>> {
    let py = keywords.py();
    let partial = py.import("functools")?.call_method("partial", call, Some(keywords))?;
    Ok((partial, PyTuple::empty(py)))
}

/// Pickles a class as its fields, which are listed with their types.
macro_rules! pickled {
    ($class:ident: $($field:ident: $type:ty),+) => {
        #[pymethods]
        impl $class {
            #[staticmethod]
            fn _restore($($field: $type),+) -> Self {
                Self { $($field),+ }
            }

            fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<$crate::pickle::Reduced<'py>> {
                $crate::pickle::restored::<Self>(py, ($(&self.$field,)+))
            }
        }
    };
}

pub(crate) use pickled;
