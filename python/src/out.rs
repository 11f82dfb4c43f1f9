//! Arrays for results, `out`: checked before a solve, then written.

use numpy::ndarray::Dimension;
use numpy::{BorrowError, PyArray, PyReadwriteArray, PyUntypedArray};

use crate::numbers::{refuse_hidden, reported};
use crate::prelude::*;

/// Borrows a writable array of a shape, so that no other call can write it. For a batch it must be contiguous.
pub(crate) fn borrowed<'py, D: Dimension>(
    value: &Bound<'py, PyAny>,
    shape: &[usize],
) -> PyResult<PyReadwriteArray<'py, Complex32, D>> {
    let contiguous = if shape.len() > 1 { "C-contiguous " } else { "" };
    // The error's text is made only when needed, because this function runs for every frame of a stream.
    let refusal = |value: &str| {
        let cure = format!("give a writable {contiguous}complex64 array {}", reported(shape));
        invalid("out", value, &cure)
    };
    let Ok(any) = value.cast::<PyUntypedArray>() else { return Err(refusal(&quoted(value))) };
    if any.shape() != shape {
        return Err(refusal(&reported(any.shape())));
    }
    let Ok(array) = value.cast::<PyArray<Complex32, D>>() else {
        return Err(refusal(&format!("of dtype {}", any.dtype())));
    };
    refuse_hidden("out", value)?;
    if !array.is_aligned() {
        return Err(refusal("misaligned"));
    }
    let apart = |(&stride, &size): (&isize, &usize)| size <= 1 || stride.unsigned_abs() >= size_of::<Complex32>();
    if !array.strides().iter().zip(shape).all(apart) {
        return Err(refusal("an array whose entries overlap"));
    }
    if !contiguous.is_empty() && !array.is_c_contiguous() {
        return Err(refusal("not C-contiguous"));
    }
    array.try_readwrite().map_err(|error| match error {
        BorrowError::NotWriteable => refusal("read-only"),
        _ => refusal("in use by another call"),
    })
}

/// Writes a drive (N,) to an array.
pub(crate) fn write(mut out: PyReadwriteArray<'_, Complex32, numpy::Ix1>, drive: &[Complex32]) -> PyResult<()> {
    if out.is_c_contiguous() {
        out.as_slice_mut()?.copy_from_slice(drive);
        return Ok(());
    }
    // Strides may be no multiple of the entry's size (a field of records); NumPy handles them.
    let (py, array) = (out.py(), out.as_any().clone());
    drop(out);
    array.set_item(py.Ellipsis(), PyArray1::from_slice(py, drive))
}
