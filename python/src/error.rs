//! `midair.SceneError` and `midair.SceneWarning`.

use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::toolbox;

pyo3::create_exception!(
    midair,
    SceneError,
    pyo3::exceptions::PyValueError,
    "Request that cannot be answered: one line names the item, its value and the cure.

Examples
--------
>>> import midair
>>> try:
...     midair.Array.grid(0, 3, 0.01)
... except midair.SceneError as error:
...     print(error)
array.grid.nx is 0: give at least 1 transducer"
);
pyo3::create_exception!(
    midair,
    SceneWarning,
    pyo3::exceptions::PyUserWarning,
    "Request that is answered, but probably a mistake.

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
pub(crate) fn refused(error: midair::Error) -> PyErr {
    use midair::Error::{InBatch, InFrame};
    let cause = if let InBatch { error, .. } | InFrame { error, .. } = &error { error } else { &error };
    match cause {
        midair::Error::Memory { .. } => PyMemoryError::new_err(format!("{error} (MIDAIR_MEMORY in the environment)")),
        _ => SceneError::new_err(error.to_string()),
    }
}

/// Makes a [`SceneError`] about an argument that this binding rejects before it reaches the core.
pub(crate) fn invalid(item: &str, value: &str, cure: &str) -> PyErr {
    refused(midair::Error::invalid(item, value, cure))
}

/// Gives a [`SceneWarning`] that points to the line which called the package.
pub(crate) fn warn(py: Python<'_>, text: &impl ToString) -> PyResult<()> {
    toolbox::call(py, "warn", (text.to_string(),)).map(drop)
}

/// Gives a warning for each text.
pub(crate) fn warn_all(py: Python<'_>, texts: impl IntoIterator<Item = impl ToString>) -> PyResult<()> {
    texts.into_iter().try_for_each(|text| warn(py, &text))
}
