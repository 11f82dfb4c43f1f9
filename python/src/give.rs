//! Arrays for Python: copies, read-only unless stated.

use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

/// Arrays of one, two and three dimensions.
pub(crate) type Array1<'py, T> = Bound<'py, PyArray1<T>>;
pub(crate) type Array2<'py, T> = Bound<'py, PyArray2<T>>;
pub(crate) type Array3<'py, T> = Bound<'py, PyArray3<T>>;

/// Returns values as an array (K,).
pub(crate) fn list<T: Element>(py: Python<'_>, values: Vec<T>) -> Array1<'_, T> {
    let array = values.into_pyarray(py);
    array.readwrite().make_nonwriteable();
    array
}

/// Returns values as an array (K, L), row by row.
pub(crate) fn table<T: Element>(py: Python<'_>, values: Vec<T>, shape: [usize; 2]) -> PyResult<Array2<'_, T>> {
    list(py, values).reshape(shape)
}

/// Returns vectors as an array (K, 3).
pub(crate) fn rows<'py>(py: Python<'py>, vectors: &[[f64; 3]]) -> PyResult<Array2<'py, f64>> {
    table(py, vectors.as_flattened().to_vec(), [vectors.len(), 3])
}

/// Returns three vectors for each entry as an array (K, 3, L).
pub(crate) fn threes<'py, const L: usize>(py: Python<'py>, vectors: &[[[f64; L]; 3]]) -> PyResult<Array3<'py, f64>> {
    list(py, vectors.as_flattened().as_flattened().to_vec()).reshape([vectors.len(), 3, L])
}

/// Returns vectors as a writable array (K, 3).
pub(crate) fn fresh<'py>(py: Python<'py>, vectors: &[[f64; 3]]) -> PyResult<Array2<'py, f64>> {
    vectors.as_flattened().to_vec().into_pyarray(py).reshape([vectors.len(), 3])
}
