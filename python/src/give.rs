//! Arrays for Python: copies, read-only unless stated.

use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// Returns values as an array (K,).
pub(crate) fn list<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    let array = values.into_pyarray(py);
    array.readwrite().make_nonwriteable();
    array
}

/// Returns values as an array (K, L), row by row.
pub(crate) fn table<T: Element>(py: Python<'_>, values: Vec<T>, shape: [usize; 2]) -> PyResult<Bound<'_, PyArray2<T>>> {
    list(py, values).reshape(shape)
}

/// Returns vectors as an array (K, 3).
pub(crate) fn rows<'py>(py: Python<'py>, vectors: &[[f64; 3]]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    table(py, vectors.as_flattened().to_vec(), [vectors.len(), 3])
}

/// Returns vectors as a writable array (K, 3).
pub(crate) fn fresh<'py>(py: Python<'py>, vectors: &[[f64; 3]]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    vectors.as_flattened().to_vec().into_pyarray(py).reshape([vectors.len(), 3])
}
