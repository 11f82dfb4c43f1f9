//! Returned arrays: read-only copies.

use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// Values (K,).
pub(crate) fn list<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    let array = values.into_pyarray(py);
    array.readwrite().make_nonwriteable();
    array
}

/// Values (K, L), row by row.
pub(crate) fn table<T: Element>(py: Python<'_>, values: Vec<T>, shape: [usize; 2]) -> PyResult<Bound<'_, PyArray2<T>>> {
    list(py, values).reshape(shape)
}

/// Vectors (K, 3).
pub(crate) fn rows<'py>(py: Python<'py>, vectors: &[[f64; 3]]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    table(py, vectors.as_flattened().to_vec(), [vectors.len(), 3])
}

/// Vectors (K, 3) that belong to the caller alone.
pub(crate) fn fresh<'py>(py: Python<'py>, vectors: &[[f64; 3]]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    vectors.as_flattened().to_vec().into_pyarray(py).reshape([vectors.len(), 3])
}
