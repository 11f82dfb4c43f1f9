//! `midair.solvers`.

use midair::solvers as registry;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::pickle::{Reduced, restored};
use crate::read;

/// One option of a solver.
#[pyclass(frozen, get_all, module = "midair")]
pub(crate) struct OptionInfo {
    /// Its default.
    default: Py<PyAny>,
    /// What it does, in one line.
    doc: String,
    /// The words that it takes; none where it takes no words.
    words: Vec<String>,
    /// Whether it takes a list of integers.
    list: bool,
}

#[pymethods]
impl OptionInfo {
    #[staticmethod]
    fn _restore(default: Py<PyAny>, doc: String, words: Vec<String>, list: bool) -> Self {
        Self { default, doc, words, list }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        restored::<Self>(py, (&self.default, &self.doc, &self.words, self.list))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Self>() else { return Ok(false) };
        let parts = |info: &Self| (info.doc.clone(), info.words.clone(), info.list);
        Ok(parts(self) == parts(other.get()) && self.default.bind(other.py()).eq(&other.get().default)?)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<default {}: {}>", self.default.bind(py).repr()?, self.doc))
    }
}

/// What is known of a solver.
#[pyclass(frozen, get_all, module = "midair")]
pub(crate) struct SolverInfo {
    /// Its name.
    name: String,
    /// What it does, in one line.
    summary: String,
    /// Paper and equation.
    source: String,
    /// Whether it balances unless told otherwise.
    balance: bool,
    /// Whether it uses the phases of complex pressures.
    uses_phases: bool,
    /// Whether it uses a start.
    uses_start: bool,
    /// Whether it uses an aim.
    uses_aim: bool,
    /// Its options by name.
    options: Py<PyDict>,
}

impl SolverInfo {
    fn uses(&self) -> [bool; 3] {
        [self.uses_phases, self.uses_start, self.uses_aim]
    }
}

#[pymethods]
impl SolverInfo {
    #[staticmethod]
    fn _restore(
        name: String,
        summary: String,
        source: String,
        balance: bool,
        uses: [bool; 3],
        options: Py<PyDict>,
    ) -> Self {
        let [uses_phases, uses_start, uses_aim] = uses;
        Self { name, summary, source, balance, uses_phases, uses_start, uses_aim, options }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let Self { name, summary, source, balance, options, .. } = self;
        restored::<Self>(py, (name, summary, source, *balance, self.uses(), options))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Self>() else { return Ok(false) };
        let texts = |info: &Self| (info.name.clone(), info.summary.clone(), info.source.clone());
        let parts = |info: &Self| (texts(info), info.balance, info.uses());
        Ok(parts(self) == parts(other.get()) && self.options.bind(other.py()).eq(&other.get().options)?)
    }

    fn __repr__(&self) -> String {
        format!("<{}: {}>", self.name, self.summary)
    }
}

/// Every solver by name, with its documented options and their defaults.
#[pyfunction]
pub(crate) fn solvers(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    let dict = PyDict::new(py);
    for entry in registry::SOLVERS {
        let options = PyDict::new(py);
        for option in entry.options() {
            let default = read::option_object(py, &option.default)?.unbind();
            let words = option.words.iter().map(ToString::to_string).collect();
            let info = OptionInfo { default, doc: option.doc.into(), words, list: option.list };
            options.set_item(option.name, Bound::new(py, info)?)?;
        }
        let registry::Info { name, summary, source, balance, .. } = *entry.info;
        let [label, summary, source] = [name, summary, source].map(String::from);
        let (uses_phases, options) = (entry.uses_phases(), options.unbind());
        let registry::Info { uses_start, uses_aim, .. } = *entry.info;
        let info = SolverInfo { name: label, summary, source, balance, uses_phases, uses_start, uses_aim, options };
        dict.set_item(name, Bound::new(py, info)?)?;
    }
    py.import("midair.notebook")?.call_method1("Solvers", (dict,))
}
