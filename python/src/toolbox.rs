//! Toolbox: functions of the Python package that the extension calls; it imports no Python code of midair itself.

use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// The module that `midair` registers when it is imported.
static TOOLBOX: PyOnceLock<Py<PyAny>> = PyOnceLock::new();

/// Stores the module whose functions the extension calls; only the first call has an effect.
#[pyfunction]
pub(crate) fn register(toolbox: Bound<'_, PyAny>) {
    let py = toolbox.py();
    TOOLBOX.get_or_init(py, || toolbox.unbind());
}

/// Calls a function of the toolbox by its name.
pub(crate) fn call<'py>(
    py: Python<'py>,
    name: &str,
    arguments: impl IntoPyObject<'py, Target = pyo3::types::PyTuple> + pyo3::call::PyCallArgs<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let toolbox = TOOLBOX.get(py).ok_or_else(|| PyImportError::new_err("import midair, not midair._midair alone"))?;
    toolbox.bind(py).call_method1(name, arguments)
}
