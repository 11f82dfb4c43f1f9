//! Reads arguments by their meaning (points, pressures, drives, options) for the core. Errors state the argument's name.

use midair::{Aim, Choice, Complex32, Complex64, Directivity, OptionValue, Options, Pose, Request, Start, Value};
use numpy::Element;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};

use crate::error::{invalid, refused};
use crate::numbers::{NUMBER, Numbers, REAL, array, numbers, quoted, reported, shaped};

/// An argument that may be left out.
pub(crate) type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Reads the number of boards along x and y; one by default.
pub(crate) fn tiles(value: Argument<'_, '_>) -> PyResult<[usize; 2]> {
    let Some(value) = value else { return Ok([1, 1]) };
    let [x, y] = pair("tiles", value, "give two whole numbers, boards along x and y")?;
    Ok([count("tiles[0]", &x)?, count("tiles[1]", &y)?])
}

/// Reads two values.
pub(crate) fn pair<'py>(item: &str, value: &Bound<'py, PyAny>, cure: &str) -> PyResult<[Bound<'py, PyAny>; 2]> {
    let few: Vec<_> = value.try_iter().and_then(|few| few.take(3).collect()).unwrap_or_default();
    few.try_into().map_err(|_| invalid(item, &quoted(value), cure))
}

/// The error for a first argument of another type.
pub(crate) fn unexpected(object: &Bound<'_, PyAny>, expected: &str, cure: &str) -> PyErr {
    let kind = object.get_type().qualname().map_or_else(|_| "this".into(), |name| name.to_string());
    PyTypeError::new_err(format!("expected {expected} first, not {kind}{cure}"))
}

/// Reads vectors (K, 3).
pub(crate) fn vectors(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 3]>> {
    let cure = "give real numbers of shape (K, 3), in metres";
    let vectors = shaped(item, value, REAL, cure, |shape| matches!(shape, [_, 3]) || shape.contains(&0))?;
    Ok(vectors.values.as_chunks().0.to_vec())
}

/// Reads one place or direction (3,).
pub(crate) fn place(item: &str, value: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    let place = shaped(item, value, REAL, "give three real numbers", |shape| *shape == [3])?.values;
    Ok([place[0], place[1], place[2]])
}

/// Reads a rotation and a translation.
pub(crate) fn pose(rotation: Argument<'_, '_>, translation: Argument<'_, '_>) -> PyResult<Pose> {
    let cure = "give (3,), axis times angle in rad, (4,), a quaternion w, x, y, z, or a matrix (3, 3)";
    let fits = |shape: &[usize]| matches!(shape, [3 | 4] | [3, 3]);
    let rotation = rotation.map(|value| shaped("rotation", value, REAL, cure, fits)).transpose()?;
    let numbers = rotation.map(|numbers| numbers.values).unwrap_or_default();
    let translation = translation.map_or(Ok([0.0; 3]), |value| place("translation", value))?;
    Pose::new(&numbers, translation).map_err(refused)
}

/// Reads numbers (M,); a single number applies to all M points.
pub(crate) fn list(item: &str, value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<f64>> {
    let cure = format!("give one real number, or one for each of the {count} points");
    numbers(item, value, REAL, &cure)?.repeated(item, &cure, &[count])
}

/// Reads pressures (M,); a single number applies to all M points, complex numbers have phases.
pub(crate) fn pressures(value: &Bound<'_, PyAny>, count: usize) -> PyResult<Request> {
    requested(value, &[count], &format!("give one real or complex number, or one for each of the {count} points"))
}

fn requested(value: &Bound<'_, PyAny>, size: &[usize], cure: &str) -> PyResult<Request> {
    let item = "pressures";
    let (array, kind) = array(item, value, NUMBER, cure)?;
    if kind == 'c' {
        return Numbers::of(&array)?.repeated(item, cure, size).map(|values| Request::of_complex(&values));
    }
    Ok(Request { pressures: Some(Numbers::of(&array)?.repeated(item, cure, size)?), ..Request::default() })
}

/// Reads one real number.
pub(crate) fn real(item: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    Ok(shaped(item, value, REAL, "give one real number", <[usize]>::is_empty)?.values[0])
}

/// Reads one real number; returns the default if it is not given.
pub(crate) fn real_or(item: &str, value: Argument<'_, '_>, default: f64) -> PyResult<f64> {
    value.map_or(Ok(default), |value| real(item, value))
}

/// Reads a whole number. Negative numbers are rejected here, other invalid ones by the core.
pub(crate) fn count(item: &str, value: &Bound<'_, PyAny>) -> PyResult<usize> {
    let number = integer(value).and_then(|number| usize::try_from(number).ok());
    number.ok_or_else(|| invalid(item, &quoted(value), "give a whole number, 1 or above"))
}

fn integer(value: &Bound<'_, PyAny>) -> Option<i128> {
    if value.is_instance_of::<PyBool>() || value.is_instance_of::<PyFloat>() {
        return None;
    }
    // NumPy's integers are not `int` and are accepted; its bools are not.
    if !value.is_instance_of::<PyInt>() {
        let kind = value.getattr("dtype").and_then(|dtype| dtype.getattr("kind")).ok()?;
        if !matches!(kind.extract::<&str>(), Ok("i" | "u")) {
            return None;
        }
    }
    value.call_method0("__index__").ok()?.extract().ok()
}

/// Reads points (B, M, 3) of a batch; returns them one after the other, with B and M.
pub(crate) fn batch_of_points(item: &str, value: &Bound<'_, PyAny>) -> PyResult<(Vec<[f64; 3]>, [usize; 2])> {
    let cure = "give real numbers of shape (B, M, 3), in metres, B and M at least 1";
    let fits = |shape: &[usize]| matches!(shape, [count, size, 3] if count * size > 0);
    let Numbers { values, shape } = shaped(item, value, REAL, cure, fits)?;
    Ok((values.as_chunks().0.to_vec(), [shape[0], shape[1]]))
}

/// Returns the number of problems B from numbers (B, M).
pub(crate) fn batch_size(item: &str, value: Argument<'_, '_>, size: usize) -> PyResult<usize> {
    let cure = format!("give numbers of shape (B, {size}), one row a problem");
    let Some(value) = value else { return Err(invalid(item, "left out", &cure)) };
    let fits = |shape: &[usize]| matches!(*shape, [count, columns] if columns == size && count > 0);
    Ok(shaped::<Complex64>(item, value, NUMBER, &cure, fits)?.shape[0])
}

/// Reads numbers (B, M) of a batch; (M,) apply to every problem, a single number to every point.
pub(crate) fn batch_of_numbers(item: &str, value: &Bound<'_, PyAny>, size: [usize; 2]) -> PyResult<Vec<f64>> {
    let cure = format!("give one real number, {} of them, or an array {}", size[1], reported(&size));
    numbers(item, value, REAL, &cure)?.repeated(item, &cure, &size)
}

/// Reads pressures (B, M) of a batch; (M,) apply to every problem, a single number to every point; complex ones have phases.
pub(crate) fn batch_of_pressures(value: &Bound<'_, PyAny>, size: [usize; 2]) -> PyResult<Request> {
    let cure = format!("give one real or complex number, {} of them, or an array {}", size[1], reported(&size));
    requested(value, &size, &cure)
}

/// Reads the starts of a batch: complex numbers are drives (B, N), real numbers are point phases (B, M).
pub(crate) fn batch_of_starts(
    item: &str,
    value: &Bound<'_, PyAny>,
    drives: [usize; 2],
    phases: [usize; 2],
) -> PyResult<Starts> {
    let cure = format!("give complex drives {} or real point phases", reported(&drives));
    let (array, kind) = array(item, value, NUMBER, &cure)?;
    if kind != 'c' {
        return batch_of_numbers(item, value, phases).map(Starts::Phases);
    }
    Ok(Starts::Drives(rounded(&Numbers::of(&array)?.fitting(item, &cure, |shape| *shape == drives)?.values)))
}

/// Reads drives (B, N) of `transducers` each; returns them one after the other, with B.
pub(crate) fn batch_of_drives(
    item: &str,
    value: &Bound<'_, PyAny>,
    transducers: usize,
) -> PyResult<(Vec<Complex32>, usize)> {
    let cure = format!("give complex numbers of shape (B, {transducers})");
    let fits = |shape: &[usize]| matches!(*shape, [_, columns] if columns == transducers);
    let Numbers { values, shape } = shaped(item, value, NUMBER, &cure, fits)?;
    Ok((rounded(&values), shape[0]))
}

/// Starts of all problems of a batch, one after the other.
pub(crate) enum Starts {
    None,
    Drives(Vec<Complex32>),
    Phases(Vec<f64>),
}

/// Reads the start of an iterative method: complex numbers are a drive (N,), real numbers are point phases (M,).
pub(crate) fn start(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Start> {
    let (_, kind) = array(item, value, NUMBER, "give a drive (N,), a Solution or point phases (M,)")?;
    if kind == 'c' { drive(item, value).map(Start::Drive) } else { reals(item, value).map(Start::Phases) }
}

/// Reads bools (N,).
pub(crate) fn flags(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<bool>> {
    one_each(item, value, "b", "give True or False of shape (N,), one a transducer")
}

/// Reads whole numbers (N,) of at least 0.
pub(crate) fn indices(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<usize>> {
    let cure = "give whole numbers of 0 or above of shape (N,), one a transducer";
    let index = |number: i64| usize::try_from(number).map_err(|_| invalid(item, &number.to_string(), cure));
    one_each(item, value, "iu", cure)?.into_iter().map(index).collect()
}

/// Reads complex numbers (N,) in double precision.
pub(crate) fn complexes(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Complex64>> {
    one_each(item, value, NUMBER, "give numbers of shape (N,), one a transducer")
}

/// Reads a drive (N,).
pub(crate) fn drive(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Complex32>> {
    complexes(item, value).map(|values| rounded(&values))
}

/// Reads real numbers (K,).
pub(crate) fn reals(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    one_each(item, value, REAL, "give real numbers of shape (K,)")
}

/// Reads values of shape (K,).
fn one_each<T: Element + Copy>(item: &str, value: &Bound<'_, PyAny>, kinds: &str, cure: &str) -> PyResult<Vec<T>> {
    Ok(shaped(item, value, kinds, cure, |shape| shape.len() == 1)?.values)
}

/// Rounds to single precision. NumPy would warn of values too large for it; here they become infinite, and are rejected by
/// name.
fn rounded(values: &[Complex64]) -> Vec<Complex32> {
    values.iter().map(|q| Complex32::new(q.re as f32, q.im as f32)).collect()
}

/// Reads a complex matrix (M, N); returns its entries and M.
pub(crate) fn matrix(item: &str, value: &Bound<'_, PyAny>) -> PyResult<(Vec<Complex64>, usize)> {
    let cure = "give numbers of shape (M, N): points by transducers";
    let Numbers { values, shape } = shaped(item, value, NUMBER, cure, |shape| shape.len() == 2)?;
    Ok((values, shape[0]))
}

/// Reads a directivity: a name, or a dict with one name and its parameter.
pub(crate) fn directivity(value: &Bound<'_, PyAny>) -> PyResult<Directivity> {
    if let Ok(name) = value.cast::<PyString>() {
        return Directivity::named(&name.to_string_lossy(), None).map_err(refused);
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

/// Reads a solver's options from keywords; `None` means the default.
pub(crate) fn options(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Options> {
    let mut options = Options::new();
    for (name, value) in keywords.into_iter().flatten() {
        if !value.is_none() {
            let name: String = name.extract()?;
            // `lambda` is a keyword of Python, so that option is given as `lambda_`.
            let name = name.strip_suffix('_').unwrap_or(&name);
            options.insert(name.to_owned(), option(name, &value)?);
        }
    }
    Ok(options)
}

/// Returns a solver's choice from its name and options, as `Solution.options` and `Scene.solver` contain them.
pub(crate) fn choice(name: String, options: &Bound<'_, PyDict>) -> PyResult<Choice> {
    Choice::new(name, self::options(Some(options))?).map_err(refused)
}

pub(crate) fn option(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(Value::Bool(flag.is_true()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::Text(text.to_string_lossy().into_owned()));
    }
    if value.is_instance_of::<PyInt>() {
        return integer(value)
            .map(Value::Integer)
            .ok_or_else(|| invalid(item, &quoted(value), "give a number of at most 64 bits"));
    }
    if let Some(number) = integer(value) {
        return Ok(Value::Integer(number));
    }
    if let Ok(number) = real(item, value) {
        return Ok(Value::Real(number));
    }
    one_each(item, value, "iu", "give a number, a word or a list of whole numbers").map(Value::Integers)
}

/// Returns options as a Python dict.
pub(crate) fn option_dict<'py>(py: Python<'py>, options: &Options) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in options {
        dict.set_item(name, option_object(py, value)?)?;
    }
    Ok(dict)
}

/// Returns an option's value as a Python object.
pub(crate) fn option_object<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Bool(flag) => flag.into_pyobject(py)?.to_owned().into_any(),
        Value::Integer(number) => number.into_pyobject(py)?.into_any(),
        Value::Real(number) => number.into_pyobject(py)?.into_any(),
        Value::Text(text) => text.into_pyobject(py)?.into_any(),
        Value::Integers(list) => list.into_pyobject(py)?.into_any(),
    })
}

/// Reads pressures and weights of `count` points.
pub(crate) fn request(count: usize, pressures: Argument<'_, '_>, weights: Argument<'_, '_>) -> PyResult<Request> {
    let request = pressures.map_or_else(|| Ok(Request::default()), |value| self::pressures(value, count))?;
    Ok(Request { weights: weights.map(|value| list("weights", value, count)).transpose()?, ..request })
}

/// Reads an aim by its name.
pub(crate) fn aim(aim: &Bound<'_, PyAny>) -> PyResult<Aim> {
    word("aim", aim, "give \"target\" or \"max\"")
}

/// Reads a text.
pub(crate) fn text(item: &str, value: &Bound<'_, PyAny>, cure: &str) -> PyResult<String> {
    value.extract().map_err(|_| invalid(item, &quoted(value), cure))
}

/// Reads one of a few words.
pub(crate) fn word<T: OptionValue>(item: &str, value: &Bound<'_, PyAny>, cure: &str) -> PyResult<T> {
    T::read(item, &Value::Text(text(item, value, cure)?)).map_err(refused)
}

/// Reads True or False.
pub(crate) fn flag(item: &str, value: &Bound<'_, PyAny>) -> PyResult<bool> {
    value.extract().map_err(|_| invalid(item, &quoted(value), "give True, False or None"))
}

/// Reads a solver's name.
pub(crate) fn name(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if value.is_callable() {
        let cure = "give a name; a function solves scenes by midair.solve, or many by midair.solve_batch";
        return Err(invalid("solver", &quoted(value), cure));
    }
    text("solver", value, "give a name as text; pressures go by keyword, pressures=")
}

/// Rejects a callback that cannot be called; `arguments` describes its arguments in the error.
pub(crate) fn callback(value: Argument<'_, '_>, arguments: &str) -> PyResult<()> {
    match value {
        Some(callback) if !callback.is_callable() => {
            Err(invalid("progress", &quoted(callback), &format!("give a function of ({arguments})")))
        }
        _ => Ok(()),
    }
}
