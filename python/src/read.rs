//! The argument reader: Python and NumPy values to the core's, everything else refused by name.

use midair::{Aim, Complex32, Complex64, Directivity, OptionValue, Options, Request, Value};
use numpy::{PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

use crate::error::{invalid, refused};

/// How a value reads in an error: short, on one line.
pub(crate) fn quoted(value: &Bound<'_, PyAny>) -> String {
    let text = value.repr().map_or_else(|_| "something".into(), |text| text.to_string());
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if text.chars().count() <= 60 { text } else { text.chars().take(57).chain("...".chars()).collect() }
}

/// A numpy array of the wanted type, if the value holds numbers of one of `kinds` (numpy's letters).
fn numbers<'py, T: numpy::Element>(
    item: &str,
    value: &Bound<'py, PyAny>,
    kinds: &str,
    dtype: &str,
    cure: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let numpy = value.py().import("numpy")?;
    // A ragged list is no array at all; what else goes wrong in there is not ours to hide.
    if has_bool(value) {
        return Err(invalid(item, &quoted(value), cure));
    }
    let array = match numpy.call_method1("asarray", (value,)) {
        Ok(array) => array,
        Err(error) if error.is_instance_of::<pyo3::exceptions::PyException>(value.py()) => {
            return Err(invalid(item, &quoted(value), cure));
        }
        Err(error) => return Err(error),
    };
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !kinds.contains(&kind) {
        return Err(invalid(item, &quoted(value), cure));
    }
    let keywords = [("dtype", dtype), ("order", "C")].into_py_dict(value.py())?;
    let array = numpy.call_method("asarray", (array,), Some(&keywords))?;
    Ok(array.cast_into::<PyArrayDyn<T>>()?.readonly())
}

/// Whether a bool hides in a list, where numpy would make a number of it.
fn has_bool(value: &Bound<'_, PyAny>) -> bool {
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        return value.try_iter().is_ok_and(|mut items| items.any(|item| item.is_ok_and(|item| has_bool(&item))));
    }
    let name = value.get_type().name();
    value.is_instance_of::<PyBool>() || name.is_ok_and(|name| name == "bool" || name == "bool_")
}

fn shape_of<T: numpy::Element>(array: &PyReadonlyArrayDyn<'_, T>) -> String {
    let sizes: Vec<String> = array.shape().iter().map(ToString::to_string).collect();
    format!("of shape ({}{})", sizes.join(", "), if sizes.len() == 1 { "," } else { "" })
}

/// Vectors (K, 3).
pub(crate) fn vectors(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 3]>> {
    let cure = "give real numbers of shape (K, 3), in metres";
    let array = numbers::<f64>(item, value, "iuf", "float64", cure)?;
    if array.is_empty() {
        return Ok(Vec::new());
    }
    match array.shape() {
        [_, 3] => Ok(array.as_slice()?.as_chunks().0.to_vec()),
        _ => Err(invalid(item, &shape_of(&array), cure)),
    }
}

/// Numbers (M,); one number stands for all M.
pub(crate) fn list(item: &str, value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<f64>> {
    let cure = format!("give one real number, or one for each of the {count} points");
    let array = numbers::<f64>(item, value, "iuf", "float64", &cure)?;
    match array.shape() {
        [] => Ok(vec![array.as_slice()?[0]; count]),
        [length] if *length == count => Ok(array.as_slice()?.to_vec()),
        _ => Err(invalid(item, &shape_of(&array), &cure)),
    }
}

/// One real number.
pub(crate) fn real(item: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let cure = "give one real number";
    let array = numbers::<f64>(item, value, "iuf", "float64", cure)?;
    match array.shape() {
        [] => Ok(array.as_slice()?[0]),
        _ => Err(invalid(item, &shape_of(&array), cure)),
    }
}

/// One real number, or the default where it is left out.
pub(crate) fn real_or(item: &str, value: Option<&Bound<'_, PyAny>>, default: f64) -> PyResult<f64> {
    value.map_or(Ok(default), |value| real(item, value))
}

/// A whole number that counts something; `least` is refused by the core, below 0 is refused here.
pub(crate) fn count(item: &str, value: &Bound<'_, PyAny>) -> PyResult<usize> {
    let number = integer(value).and_then(|number| usize::try_from(number).ok());
    number.ok_or_else(|| invalid(item, &quoted(value), "give a whole number, 1 or above"))
}

fn integer(value: &Bound<'_, PyAny>) -> Option<i128> {
    if value.is_instance_of::<PyBool>() || value.is_instance_of::<PyFloat>() {
        return None;
    }
    // numpy's integers are no `int`, but count as one; its bools do not.
    if !value.is_instance_of::<PyInt>() {
        let kind = value.getattr("dtype").and_then(|dtype| dtype.getattr("kind")).ok()?;
        if !matches!(kind.extract::<&str>(), Ok("i" | "u")) {
            return None;
        }
    }
    value.call_method0("__index__").ok()?.extract().ok()
}

/// Points (B, M, 3) of a batch, one after the other, and B and M.
pub(crate) fn batch_of_points(item: &str, value: &Bound<'_, PyAny>) -> PyResult<(Vec<[f64; 3]>, [usize; 2])> {
    let cure = "give real numbers of shape (B, M, 3), in metres, B and M at least 1";
    let array = numbers::<f64>(item, value, "iuf", "float64", cure)?;
    match array.shape() {
        &[count, size, 3] if count * size > 0 => Ok((array.as_slice()?.as_chunks().0.to_vec(), [count, size])),
        _ => Err(invalid(item, &shape_of(&array), cure)),
    }
}

/// B of numbers (B, M).
pub(crate) fn batch_size(item: &str, value: Option<&Bound<'_, PyAny>>, size: usize) -> PyResult<usize> {
    let cure = format!("give real numbers of shape (B, {size}), one row a problem");
    let Some(value) = value else { return Err(invalid(item, "left out", &cure)) };
    let array = numbers::<f64>(item, value, "iuf", "float64", &cure)?;
    match array.shape() {
        &[count, columns] if columns == size && count > 0 => Ok(count),
        _ => Err(invalid(item, &shape_of(&array), &cure)),
    }
}

/// Yes or no (N,).
pub(crate) fn flags(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<bool>> {
    let cure = "give True or False of shape (N,), one a transducer";
    let array = value.py().import("numpy")?.call_method1("asarray", (value,));
    let array = array.ok().and_then(|array| array.cast_into::<PyArrayDyn<bool>>().ok());
    let array = array.ok_or_else(|| invalid(item, &quoted(value), cure))?.readonly();
    match array.shape() {
        [_] => Ok(array.as_array().iter().copied().collect()),
        _ => Err(invalid(item, &shape_of(&array), cure)),
    }
}

/// Numbers (B, M) of a batch; (M,) stand for every problem, one number for every point.
pub(crate) fn batch_of_numbers(item: &str, value: &Bound<'_, PyAny>, shape: [usize; 2]) -> PyResult<Vec<f64>> {
    let [count, size] = shape;
    let cure = format!("give one real number, {size} of them, or an array of shape ({count}, {size})");
    let array = numbers::<f64>(item, value, "iuf", "float64", &cure)?;
    match array.shape() {
        [] => Ok(vec![array.as_slice()?[0]; count * size]),
        &[length] if length == size => Ok(array.as_slice()?.repeat(count)),
        &[rows, columns] if [rows, columns] == shape => Ok(array.as_slice()?.to_vec()),
        _ => Err(invalid(item, &shape_of(&array), &cure)),
    }
}

/// Drives (B, N) of a batch.
pub(crate) fn batch_of_drives(item: &str, value: &Bound<'_, PyAny>, shape: [usize; 2]) -> PyResult<Vec<Complex32>> {
    let cure = format!("give complex drives of shape ({}, {}) or real point phases", shape[0], shape[1]);
    let array = numbers::<Complex64>(item, value, "c", "complex128", &cure)?;
    if array.shape() != shape {
        return Err(invalid(item, &shape_of(&array), &cure));
    }
    Ok(array.as_slice()?.iter().map(|q| Complex32::new(q.re as f32, q.im as f32)).collect())
}

/// Complex numbers (N,) in double precision.
pub(crate) fn complexes(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Complex64>> {
    let cure = "give numbers of shape (N,), one a transducer";
    let array = numbers::<Complex64>(item, value, "iufc", "complex128", cure)?;
    match array.shape() {
        [_] => Ok(array.as_slice()?.to_vec()),
        _ => Err(invalid(item, &shape_of(&array), cure)),
    }
}

/// A drive (N,).
pub(crate) fn drive(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Complex32>> {
    let cure = "give numbers of shape (N,), one a transducer";
    // Rounded here and not by numpy: what does not fit f32 becomes infinite and is refused by name.
    let array = numbers::<Complex64>(item, value, "iufc", "complex128", cure)?;
    match array.shape() {
        [_] => Ok(array.as_slice()?.iter().map(|q| Complex32::new(q.re as f32, q.im as f32)).collect()),
        _ => Err(invalid(item, &shape_of(&array), cure)),
    }
}

/// Real numbers (K,).
pub(crate) fn reals(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let cure = "give real numbers of shape (K,)";
    let array = numbers::<f64>(item, value, "iuf", "float64", cure)?;
    match array.shape() {
        [_] => Ok(array.as_slice()?.to_vec()),
        _ => Err(invalid(item, &shape_of(&array), cure)),
    }
}

/// Whether numpy sees complex numbers in it.
pub(crate) fn is_complex(value: &Bound<'_, PyAny>) -> bool {
    let array = value.py().import("numpy").and_then(|numpy| numpy.call_method1("iscomplexobj", (value,)));
    array.and_then(|complex| complex.extract::<bool>()).unwrap_or(false)
}

/// A complex matrix (M, N): its entries and M.
pub(crate) fn matrix(item: &str, value: &Bound<'_, PyAny>) -> PyResult<(Vec<Complex64>, usize)> {
    let cure = "give numbers of shape (M, N): points by transducers";
    let array = numbers::<Complex64>(item, value, "iufc", "complex128", cure)?;
    match array.shape() {
        [points, _] => Ok((array.as_slice()?.to_vec(), *points)),
        _ => Err(invalid(item, &shape_of(&array), cure)),
    }
}

/// A directivity: a name, or a dictionary of one name and its parameter.
pub(crate) fn directivity(value: &Bound<'_, PyAny>) -> PyResult<Directivity> {
    if let Ok(name) = value.cast::<PyString>() {
        return Directivity::named(name.to_str()?, None).map_err(refused);
    }
    let table = value.cast::<PyDict>().ok().filter(|table| table.len() == 1);
    if let Some((name, parameter)) = table.and_then(|table| table.iter().next())
        && let Ok(name) = name.extract::<String>()
    {
        let parameter = real(&format!("directivity.{name}"), &parameter)?;
        return Directivity::named(&name, Some(parameter)).map_err(refused);
    }
    Err(invalid("directivity", &quoted(value), "give a name such as \"point\" or {\"piston\": 4.5e-3}"))
}

/// A solver's options from keywords; `None` leaves the default.
pub(crate) fn options(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Options> {
    let mut options = Options::new();
    for (name, value) in keywords.into_iter().flatten() {
        if !value.is_none() {
            let name: String = name.extract()?;
            // `lambda` is a word of Python's own: lambda_ stands for it.
            let name = name.strip_suffix('_').unwrap_or(&name);
            options.insert(name.to_owned(), option(name, &value)?);
        }
    }
    Ok(options)
}

fn option(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(Value::Bool(flag.is_true()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::Text(text.to_str()?.to_owned()));
    }
    if value.is_instance_of::<PyInt>() {
        return integer(value)
            .map(Value::Integer)
            .ok_or_else(|| invalid(item, &quoted(value), "give a number of at most 64 bits"));
    }
    let cure = "give a number, a word or a list of whole numbers";
    if let Some(number) = integer(value) {
        return Ok(Value::Integer(number));
    }
    if let Ok(number) = real(item, value) {
        return Ok(Value::Real(number));
    }
    let array = numbers::<i64>(item, value, "iu", "int64", cure)?;
    match array.shape() {
        [_] => Ok(Value::Integers(array.as_slice()?.to_vec())),
        _ => Err(invalid(item, &shape_of(&array), cure)),
    }
}

/// Options as Python values.
pub(crate) fn option_dict<'py>(py: Python<'py>, options: &Options) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in options {
        dict.set_item(name, option_object(py, value)?)?;
    }
    Ok(dict)
}

/// An option's value as a Python value.
pub(crate) fn option_object<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Bool(flag) => flag.into_pyobject(py)?.to_owned().into_any(),
        Value::Integer(number) => number.into_pyobject(py)?.into_any(),
        Value::Real(number) => number.into_pyobject(py)?.into_any(),
        Value::Text(text) => text.into_pyobject(py)?.into_any(),
        Value::Integers(list) => list.into_pyobject(py)?.into_any(),
    })
}

/// Pressures and weights of `count` points as the core takes them.
pub(crate) fn request(
    count: usize,
    pressures: Option<&Bound<'_, PyAny>>,
    weights: Option<&Bound<'_, PyAny>>,
) -> PyResult<Request> {
    let read = |item, value: Option<&Bound<'_, PyAny>>| value.map(|value| list(item, value, count)).transpose();
    Ok(Request { pressures: read("pressures", pressures)?, weights: read("weights", weights)? })
}

/// An aim by its name.
pub(crate) fn aim(aim: &Bound<'_, PyAny>) -> PyResult<Aim> {
    match aim.extract::<String>() {
        Ok(name) => Aim::read("aim", &Value::Text(name)).map_err(refused),
        Err(_) => Err(invalid("aim", &aim.to_string(), "give \"target\" or \"max\"")),
    }
}

/// True or False.
pub(crate) fn flag(item: &str, value: &Bound<'_, PyAny>) -> PyResult<bool> {
    value.extract().map_err(|_| invalid(item, &value.to_string(), "give True, False or None"))
}

/// A solver's name.
pub(crate) fn name(value: &Bound<'_, PyAny>) -> PyResult<String> {
    value.extract().map_err(|_| invalid("solver", &value.to_string(), "give a name as text"))
}

/// A callback, called with `arguments`.
pub(crate) fn callback(value: Option<&Bound<'_, PyAny>>, arguments: &str) -> PyResult<()> {
    match value {
        Some(callback) if !callback.is_callable() => {
            Err(invalid("progress", &callback.to_string(), &format!("give a function of ({arguments})")))
        }
        _ => Ok(()),
    }
}

/// Vectors as a numpy array (K, 3).
pub(crate) fn rows<'py>(py: Python<'py>, vectors: &[[f64; 3]]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    vectors.as_flattened().to_pyarray(py).reshape([vectors.len(), 3])
}
