//! `midair.solvers`.

use midair::solvers as registry;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::read;

/// One option of a solver.
#[pyclass(frozen, get_all, module = "midair")]
pub(crate) struct OptionInfo {
    /// Its default.
    default: Py<PyAny>,
    /// What it does, in one line.
    doc: &'static str,
    /// The words that it takes; none where it takes no words.
    words: Vec<&'static str>,
    /// Whether it takes a list of integers.
    list: bool,
}

#[pymethods]
impl OptionInfo {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<default {}: {}>", self.default.bind(py).repr()?, self.doc))
    }
}

/// What is known of a solver.
#[pyclass(frozen, get_all, module = "midair")]
pub(crate) struct SolverInfo {
    /// Its name.
    name: &'static str,
    /// What it does, in one line.
    summary: &'static str,
    /// Paper and equation.
    source: &'static str,
    /// Whether it balances unless told otherwise.
    balance: bool,
    /// Its options by name.
    options: Py<PyDict>,
}

#[pymethods]
impl SolverInfo {
    fn __repr__(&self) -> String {
        format!("<{}: {}>", self.name, self.summary)
    }
}

/// Every solver by name, with its documented options and their defaults.
#[pyfunction]
pub(crate) fn solvers(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for entry in registry::SOLVERS {
        let options = PyDict::new(py);
        for option in entry.options() {
            let default = read::option_object(py, &option.default)?.unbind();
            let info = OptionInfo { default, doc: option.doc, words: option.words.to_vec(), list: option.list };
            options.set_item(option.name, Bound::new(py, info)?)?;
        }
        let registry::Info { name, summary, source, balance, .. } = *entry.info;
        let info = SolverInfo { name, summary, source, balance, options: options.unbind() };
        dict.set_item(name, Bound::new(py, info)?)?;
    }
    Ok(dict)
}
