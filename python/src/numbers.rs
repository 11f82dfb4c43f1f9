//! Reads arrays of numbers in any memory layout as copies in C order. Rejects values that NumPy would convert wrongly.

use numpy::ndarray::{Dimension, IxDyn};
use numpy::{
    Element, PyArray, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArray, PyUntypedArray,
    PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyException, PyRecursionError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{IntoPyDict, PyBool, PyFloat, PyInt, PyList, PyTuple};

use crate::error::invalid;

/// Largest number of dimensions of an argument: (B, M, 3).
const DEEPEST: usize = 3;

/// Values in C order, and their shape.
pub(crate) struct Numbers<T> {
    pub(crate) values: Vec<T>,
    pub(crate) shape: Vec<usize>,
}

impl<T: Element + Copy> Numbers<T> {
    /// Returns the numbers of an array with any byte order, alignment and strides.
    pub(crate) fn of(array: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Some(array) = in_place::<T, IxDyn>(array) {
            return Ok(Self { shape: array.shape().to_vec(), values: array.as_slice()?.to_vec() });
        }
        let py = array.py();
        let keywords = [("dtype", dtype::<T>(py).into_any()), ("order", "C".into_pyobject(py)?.into_any())];
        let copy = py.import("numpy")?.call_method("array", (array,), Some(&keywords.into_py_dict(py)?))?;
        let copy = copy.cast_into::<PyArrayDyn<T>>()?;
        Ok(Self { shape: copy.shape().to_vec(), values: copy.readonly().as_slice()?.to_vec() })
    }
}

/// Returns a shape as text for an error.
pub(crate) fn reported(shape: &[usize]) -> String {
    let sizes: Vec<String> = shape.iter().map(ToString::to_string).collect();
    format!("of shape ({}{})", sizes.join(", "), if sizes.len() == 1 { "," } else { "" })
}

/// Reads the numbers of an argument whose type is one of `kinds` (NumPy's letters).
pub(crate) fn numbers<T: Element + Copy>(
    item: &str,
    value: &Bound<'_, PyAny>,
    kinds: &str,
    cure: &str,
) -> PyResult<Numbers<T>> {
    Numbers::of(&array(item, value, kinds, cure)?.0)
}

/// Returns the NumPy array of an argument, and NumPy's letter for its type, which is one of `kinds`.
pub(crate) fn array<'py>(
    item: &str,
    value: &Bound<'py, PyAny>,
    kinds: &str,
    cure: &str,
) -> PyResult<(Bound<'py, PyAny>, char)> {
    let refusal = || invalid(item, &quoted(value), cure);
    let array = if value.is_exact_instance_of::<PyUntypedArray>() {
        value.clone()
    } else {
        if !is_array_like(value, 0, kinds.contains('b')) {
            return Err(refusal());
        }
        refuse_hidden(item, value)?;
        // A ragged list is no array. Exceptions of other kinds, such as Ctrl-C, are passed on.
        match as_array(value) {
            Err(error) if error.is_instance_of::<PyException>(value.py()) => return Err(refusal()),
            array => array?,
        }
    };
    let kind = char::from(array.cast::<PyUntypedArray>()?.dtype().kind());
    if kinds.contains(kind) { Ok((array, kind)) } else { Err(refusal()) }
}

fn as_array<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    static AS_ARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    static FROM_DLPACK: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    // While midair is being imported, arrays are made from lists only, which need no module of the package.
    let read = if value.hasattr("__dlpack__")? {
        FROM_DLPACK.import(value.py(), "midair._support.arguments", "as_array")?
    } else {
        AS_ARRAY.import(value.py(), "numpy", "asarray")?
    };
    read.call1((value,))
}

/// Returns whether nested lists can be an array of numbers: not nested too deeply, and without bools, which NumPy would
/// convert to numbers.
fn is_array_like(value: &Bound<'_, PyAny>, depth: usize, bools: bool) -> bool {
    if value.is_exact_instance_of::<PyFloat>() || value.is_exact_instance_of::<PyInt>() {
        return true;
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let fits = |entry: PyResult<Bound<'_, PyAny>>| entry.is_ok_and(|entry| is_array_like(&entry, depth + 1, bools));
        return depth < DEEPEST && value.try_iter().is_ok_and(|mut entries| entries.all(fits));
    }
    let name = value.get_type().name();
    bools || !(value.is_instance_of::<PyBool>() || name.is_ok_and(|name| name == "bool" || name == "bool_"))
}

/// Rejects masked arrays with masked entries, also in lists: NumPy would use the values under the mask.
pub(crate) fn refuse_hidden(item: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        return value.try_iter()?.try_for_each(|entry| refuse_hidden(item, &entry?));
    }
    if !value.is_instance_of::<PyUntypedArray>() || value.is_exact_instance_of::<PyUntypedArray>() {
        return Ok(());
    }
    let hidden: usize = value.py().import("numpy")?.getattr("ma")?.call_method1("count_masked", (value,))?.extract()?;
    if hidden == 0 {
        return Ok(());
    }
    let reported = format!("masked in {hidden} of {} entries", value.getattr("size")?);
    Err(invalid(item, &reported, "fill what the mask hides, or leave it out"))
}

/// Returns an array that can be read without a copy, else None.
pub(crate) fn in_place<'py, T: Element, D: Dimension>(value: &Bound<'py, PyAny>) -> Option<PyReadonlyArray<'py, T, D>> {
    let array = value.cast_exact::<PyArray<T, D>>().ok()?;
    // Memory in Fortran order is contiguous, too, so C order is checked explicitly.
    (array.is_c_contiguous() && array.is_aligned()).then(|| array.try_readonly().ok()).flatten()
}

/// Returns a value as text for an error: short, on one line.
pub(crate) fn quoted(value: &Bound<'_, PyAny>) -> String {
    let text = value.repr().map_or_else(
        |error| {
            let deep = error.is_instance_of::<PyRecursionError>(value.py());
            if deep { "nested too deeply" } else { "something that cannot be shown" }.to_owned()
        },
        |text| text.to_string(),
    );
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if text.chars().count() <= 60 { text } else { text.chars().take(57).chain("...".chars()).collect() }
}
