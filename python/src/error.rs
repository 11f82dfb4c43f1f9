//! `midair.SceneError` and `midair.SceneWarning`.

use std::ops::Deref;

use midair::solvers::Remark;
use midair::{ErrorCode, Notice};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyType};

use crate::toolbox;

pyo3::create_exception!(
    midair,
    SceneError,
    pyo3::exceptions::PyValueError,
    "Request that cannot be answered: one line names the item, its value and the cure.

Attributes
----------
code : str
    What the error is about, such as \"too-near\"; docs/errors.md lists all codes, which never change.
item, value, cure : str
    Parts of the text.
index : int or None
    Number of the problem of a batch or of the frame of a sequence, else the first number in the item.

Examples
--------
>>> import midair
>>> try:
...     midair.Array.grid(0, 3, 0.01)
... except midair.SceneError as error:
...     print(error)
...     print(error.code, error.item, error.value)
array.grid.nx is 0: give at least 1 transducer
out-of-range array.grid.nx 0"
);
pyo3::create_exception!(
    midair,
    SceneWarning,
    pyo3::exceptions::PyUserWarning,
    "Request that is answered, but probably a mistake.

Attributes
----------
code, item, value, cure : str
    As for `SceneError`.
index : int or None
    As for `SceneError`.

Examples
--------
>>> import midair, warnings
>>> with warnings.catch_warnings(record=True) as caught:
...     warnings.simplefilter('always')
...     scene = midair.Scene(midair.Array.preset('autd3'), [[0, 0, 0.15]], temperature=293)
>>> caught[0].category.__name__
'SceneWarning'"
);

/// Converts an error of the core to the exception that users see.
pub(crate) fn refused(mut error: midair::Error) -> PyErr {
    Python::attach(|py| {
        let mut kind = py.get_type::<SceneError>();
        if error.code == ErrorCode::Memory {
            error.cure += " (MIDAIR_MEMORY in the environment)";
            kind = py.get_type::<PyMemoryError>();
        }
        raised(kind, &error).map_or_else(|error| error, PyErr::from_value)
    })
}

/// Makes a [`SceneError`] about an argument that this binding rejects before it reaches the core.
pub(crate) fn invalid(item: &str, value: &str, cure: &str) -> PyErr {
    refused(midair::Error::invalid(item, value, cure))
}

/// Makes a [`SceneError`] with a code.
pub(crate) fn coded(code: ErrorCode, item: &str, value: &str, cure: &str) -> PyErr {
    refused(midair::Error::new(code, item, value, cure))
}

/// The parts of an error that no public attribute has, in the order of the attribute that keeps them.
const PARTS: &str = "_parts";

/// Makes an exception or a warning that has the parts of a notice as attributes.
fn raised<'py>(kind: Bound<'py, PyType>, notice: &Notice) -> PyResult<Bound<'py, PyAny>> {
    let exception = kind.call1((notice.to_string(),))?;
    let Notice { code, place, item, verb, value, hint, cure, example, other, index, .. } = notice;
    exception.setattr("code", code.name())?;
    exception.setattr("item", item)?;
    exception.setattr("value", value)?;
    exception.setattr("cure", format!("{hint}{cure}"))?;
    exception.setattr("index", index)?;
    exception.setattr(PARTS, (place, verb, hint, cure, example, other))?;
    Ok(exception)
}

/// Gives the classes the attributes that an exception has which Python code made of a text alone.
pub(crate) fn add_parts(py: Python<'_>) -> PyResult<()> {
    for kind in [py.get_type::<SceneError>(), py.get_type::<SceneWarning>()] {
        kind.setattr("code", ErrorCode::Invalid.name())?;
        for part in ["item", "value", "cure"] {
            kind.setattr(part, "")?;
        }
        kind.setattr("index", py.None())?;
    }
    Ok(())
}

/// Returns the parts of an exception, which Python code may have made of a text alone.
pub(crate) fn error_of(exception: &Bound<'_, PyAny>) -> PyResult<midair::Error> {
    let Ok(parts) = exception.getattr(PARTS) else {
        return Ok(midair::Error::invalid("", exception.str()?, ""));
    };
    let code: String = exception.getattr("code")?.extract()?;
    let code = ErrorCode::of(&code).unwrap_or(ErrorCode::Invalid);
    let mut error = midair::Error::new(code, "", "", "");
    (error.item, error.value) = (exception.getattr("item")?.extract()?, exception.getattr("value")?.extract()?);
    (error.place, error.verb, error.hint, error.cure, error.example, error.other) = parts.extract()?;
    error.index = exception.getattr("index")?.extract()?;
    Ok(error)
}

/// Returns the SceneError `item words: cure`, such as `targets are 0 everywhere: give one above 0`. The first of the words
/// is the verb, the others are the value. Without an item, the words alone are the value.
///
/// Returns
/// -------
/// midair.SceneError
#[pyfunction]
#[pyo3(signature = (item, words, cure, code="invalid"))]
pub(crate) fn stated(py: Python<'_>, item: Lossy, words: Lossy, cure: Lossy, code: &str) -> PyResult<Py<PyAny>> {
    let code = ErrorCode::of(code).ok_or_else(|| invalid("code", code, "give one of docs/errors.md"))?;
    let (verb, value) = if item.is_empty() { ("", &*words) } else { words.split_once(' ').unwrap_or((&words, "")) };
    let error = midair::Error::of(Notice::new(code, &*item, value, one_line(&cure)).verb(verb));
    Ok(refused(error).into_value(py).into_any())
}

/// Returns the SceneError about an unknown name, with the known ones.
///
/// Returns
/// -------
/// midair.SceneError
#[pyfunction]
pub(crate) fn unknown_name(py: Python<'_>, kind: &str, name: Lossy, known: Vec<String>) -> Py<PyAny> {
    refused(midair::Error::unknown(kind, &*name, known.iter().map(String::as_str))).into_value(py).into_any()
}

/// Returns the same SceneError about another item, with another place, inside of a place, or with another index. The name
/// that was `meant` is added to an error about an unknown name that has no hint.
///
/// Parameters
/// ----------
/// error : midair.SceneError
///
/// Returns
/// -------
/// midair.SceneError
#[pyfunction]
#[pyo3(signature = (error, *, item=None, place=None, inside=None, index=None, meant=None))]
pub(crate) fn restated(
    error: &Bound<'_, PyAny>,
    item: Option<&str>,
    place: Option<&str>,
    inside: Option<&str>,
    index: Option<usize>,
    meant: Option<&str>,
) -> PyResult<Py<PyAny>> {
    let mut changed = error_of(error)?;
    changed.item = item.map_or(changed.item.clone(), str::to_owned);
    changed.place = place.map_or(changed.place.clone(), one_line);
    if let Some(name) = meant.filter(|_| changed.hint.is_empty()) {
        changed.hint = format!("did you mean {name}? ");
    }
    if let Some(place) = inside {
        changed = changed.inside(one_line(place));
    }
    changed.index = index.or(changed.index);
    Ok(refused(changed).into_value(error.py()).into_any())
}

/// A text that may contain a user's: halves of surrogate pairs, which Rust's texts cannot contain, are replaced.
pub(crate) struct Lossy(String);

impl FromPyObject<'_, '_> for Lossy {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        Ok(Self(given.cast::<PyString>()?.to_string_lossy().into_owned()))
    }
}

impl Deref for Lossy {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What a warning is made of: a notice, a remark, or a text alone.
pub(crate) trait Warning {
    fn notice(&self) -> Notice;
}

impl Warning for Notice {
    fn notice(&self) -> Notice {
        self.clone()
    }
}

impl Warning for Remark {
    fn notice(&self) -> Notice {
        Self::notice(self)
    }
}

impl Warning for String {
    fn notice(&self) -> Notice {
        let mut notice = Notice::new(ErrorCode::Doubtful, "", "", "");
        notice.value.clone_from(self);
        notice
    }
}

impl<T: Warning> Warning for &T {
    fn notice(&self) -> Notice {
        T::notice(self)
    }
}

/// Gives a [`SceneWarning`] that points to the line which called the package.
pub(crate) fn warn(py: Python<'_>, warning: impl Warning) -> PyResult<()> {
    let warning = raised(py.get_type::<SceneWarning>(), &warning.notice())?;
    toolbox::call(py, "warn", (warning,)).map(drop)
}

/// Gives several warnings.
pub(crate) fn warn_all(py: Python<'_>, warnings: impl IntoIterator<Item = impl Warning>) -> PyResult<()> {
    warnings.into_iter().try_for_each(|warning| warn(py, warning))
}
