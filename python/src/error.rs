//! `midair.SceneError` and `midair.SceneWarning`.

use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::toolbox;

pyo3::create_exception!(
    midair,
    SceneError,
    pyo3::exceptions::PyValueError,
    "A request that cannot be answered: one line that names the item, its value and what to change."
);
pyo3::create_exception!(
    midair,
    SceneWarning,
    pyo3::exceptions::PyUserWarning,
    "A request that is answered, but hardly meant that way."
);

/// A core error as the exception that users see.
pub(crate) fn refused(error: midair::Error) -> PyErr {
    use midair::Error::{InBatch, InFrame};
    let cause = if let InBatch { error, .. } | InFrame { error, .. } = &error { error } else { &error };
    match cause {
        midair::Error::Memory { .. } => PyMemoryError::new_err(format!("{error} (MIDAIR_MEMORY in the environment)")),
        _ => SceneError::new_err(error.to_string()),
    }
}

/// A [`SceneError`] of this door's own: an argument that never reaches the core.
pub(crate) fn invalid(item: &str, value: &str, cure: &str) -> PyErr {
    refused(midair::Error::invalid(item, value, cure))
}

/// Warns by a [`SceneWarning`], at the line that called the package.
pub(crate) fn warn(py: Python<'_>, text: &impl ToString) -> PyResult<()> {
    toolbox::call(py, "warn", (text.to_string(),)).map(drop)
}

/// Warns of each.
pub(crate) fn warn_all(py: Python<'_>, texts: impl IntoIterator<Item = impl ToString>) -> PyResult<()> {
    texts.into_iter().try_for_each(|text| warn(py, &text))
}
