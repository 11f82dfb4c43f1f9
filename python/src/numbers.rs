//! Reads arrays of numbers in any memory layout as copies in C order. Rejects values that NumPy would convert wrongly.

use midair::{Complex64, ErrorCode};
use numpy::ndarray::{Dimension, IxDyn};
use numpy::{
    Element, PyArray, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArray, PyUntypedArray,
    PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyException, PyRecursionError};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyBool, PyFloat, PyInt, PyList, PyTuple};

use crate::error::{Lossy, coded, invalid};
use crate::give;

/// Largest number of dimensions of an argument: (B, M, 3).
pub(crate) const DEEPEST: usize = 3;

/// Kinds of numbers, as NumPy's letters.
pub(crate) const REAL: &str = "iuf";
pub(crate) const NUMBER: &str = "iufc";

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

impl<T: Copy> Numbers<T> {
    /// Returns the numbers if their shape fits.
    pub(crate) fn fitting(self, item: &str, cure: &str, fits: impl FnOnce(&[usize]) -> bool) -> PyResult<Self> {
        if fits(&self.shape) { Ok(self) } else { Err(misshapen(item, &self.shape, cure)) }
    }

    /// Returns numbers of a size such as (B, M). (M,) apply to each of B, a single number to all.
    pub(crate) fn repeated(self, item: &str, cure: &str, size: &[usize]) -> PyResult<Vec<T>> {
        match &self.shape[..] {
            [] => Ok(self.values.repeat(size.iter().product())),
            [length] if size.last() == Some(length) => Ok(self.values.repeat(size[..size.len() - 1].iter().product())),
            shape if shape == size => Ok(self.values),
            shape => Err(misshapen(item, shape, cure)),
        }
    }
}

/// Reads the numbers of an argument whose type is one of `kinds`, and whose shape fits.
pub(crate) fn shaped<T: Element + Copy>(
    item: &str,
    value: &Bound<'_, PyAny>,
    kinds: &str,
    cure: &str,
    fits: impl FnOnce(&[usize]) -> bool,
) -> PyResult<Numbers<T>> {
    numbers(item, value, kinds, cure)?.fitting(item, cure, fits)
}

/// Returns a shape as text for an error.
pub(crate) fn reported(shape: &[usize]) -> String {
    let sizes: Vec<String> = shape.iter().map(ToString::to_string).collect();
    format!("of shape ({}{})", sizes.join(", "), if sizes.len() == 1 { "," } else { "" })
}

/// The error for an argument of another shape.
pub(crate) fn misshapen(item: &str, shape: &[usize], cure: &str) -> PyErr {
    coded(ErrorCode::Shape, item, &reported(shape), cure)
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
    let refusal = || coded(ErrorCode::Type, item, &quoted(value), cure);
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
    let dtype = array.cast::<PyUntypedArray>()?.dtype();
    let kind = char::from(dtype.kind());
    if kinds.contains(kind) {
        return Ok((array, kind));
    }
    // The values of an array of another type are right, but not their type.
    let foreign = kind != 'O' && !value.is_instance_of::<PyList>() && !value.is_instance_of::<PyTuple>();
    if foreign && array.getattr("ndim")?.is_truthy()? {
        return Err(coded(ErrorCode::Type, item, &format!("of dtype {dtype}"), cure));
    }
    Err(refusal())
}

/// Returns an array of anything that NumPy reads or that has `__dlpack__`, without a copy if possible. Data on a GPU are
/// copied.
fn as_array<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let numpy = value.py().import("numpy")?;
    if !value.is_instance_of::<PyUntypedArray>() && value.get_type().hasattr("__dlpack__")? {
        // `from_dlpack` fails for GPU memory and for types that NumPy lacks; NumPy 1.26 does not accept `device`.
        let on_cpu = [("device", "cpu")].into_py_dict(value.py())?;
        for keywords in [None, Some(&on_cpu)] {
            match numpy.call_method("from_dlpack", (value,), keywords) {
                Err(error) if error.is_instance_of::<PyException>(value.py()) => {}
                array => return array,
            }
        }
    }
    numpy.call_method1("asarray", (value,))
}

/// Reads an argument of the toolbox: finite numbers, float64 or, if they are complex, complex128; the array is read-only.
///
/// `shapes` are the shapes that it may have, or `None` for any; in a shape, -k stands for any size of at least k. `kinds`
/// are NumPy's letters of the types that are accepted. Values are at least `least`, and their moduli at most `most`. With
/// `copy=False` the result is the array in its own type, without a copy if possible, and its values are not checked.
///
/// Returns
/// -------
/// ndarray
#[pyfunction]
#[pyo3(name = "numbers", signature = (item, value, shapes, cure, *, kinds=REAL, least=None, most=None, copy=true))]
pub(crate) fn checked<'py>(
    item: Lossy,
    value: &Bound<'py, PyAny>,
    shapes: Option<Vec<Vec<isize>>>,
    cure: &str,
    kinds: &str,
    least: Option<f64>,
    most: Option<f64>,
    copy: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let item = &*item;
    let (array, kind) = array(item, value, kinds, cure)?;
    let shape = array.cast::<PyUntypedArray>()?.shape();
    let size = |(&n, &size): (&usize, &isize)| n == size.unsigned_abs() || size < 0 && n > size.unsigned_abs();
    let fits = |pattern: &Vec<isize>| pattern.len() == shape.len() && shape.iter().zip(pattern).all(size);
    if shapes.is_some_and(|shapes| !shapes.iter().any(fits)) {
        return Err(misshapen(item, shape, cure));
    }
    match kind {
        _ if !copy => Ok(array),
        'c' => Numbers::of(&array)?.within(array.py(), item, [None, most], |q: &Complex64| (0.0, q.norm())),
        _ => {
            let least = least.or(most.map(|most| -most));
            Numbers::of(&array)?.within(array.py(), item, [least, most], |x: &f64| (*x, x.abs()))
        }
    }
}

impl<T: Element> Numbers<T> {
    /// Returns these numbers as a read-only array. Rejects the first one that is not finite or out of range; `of` returns
    /// what has a lower bound, and what has an upper bound.
    fn within<'py>(
        self,
        py: Python<'py>,
        item: &str,
        [least, most]: [Option<f64>; 2],
        of: impl Fn(&T) -> (f64, f64),
    ) -> PyResult<Bound<'py, PyAny>> {
        let wrong = self.values.iter().map(&of).position(|(x, modulus)| {
            !modulus.is_finite() || least.is_some_and(|least| x < least) || most.is_some_and(|most| modulus > most)
        });
        let finite = wrong.is_none_or(|wrong| of(&self.values[wrong]).1.is_finite());
        let array = give::list(py, self.values).reshape(&self.shape[..])?;
        let Some(wrong) = wrong else { return Ok(array.into_any()) };
        let (mut left, mut place) = (wrong, Vec::new());
        for size in self.shape.iter().rev() {
            place.insert(0, (left % size).to_string());
            left /= size;
        }
        let item = if place.is_empty() { item.to_owned() } else { format!("{item}[{}]", place.join(", ")) };
        // A bound such as 1 + 1e-6 allows for rounding.
        let cure = match (least, most.map(|most| (most * 1e4).round() / 1e4)) {
            (None, None) => "give finite numbers".into(),
            (Some(least), None) => format!("give numbers of at least {least}"),
            (None, Some(most)) => format!("give numbers of at most {most} in modulus"),
            (Some(least), Some(most)) => format!("give numbers from {least} to {most}"),
        };
        let value = quoted(&array.call_method1("item", (wrong,))?);
        let code = if finite { ErrorCode::OutOfRange } else { ErrorCode::NotFinite };
        Err(coded(code, &item, &value, &cure))
    }
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
