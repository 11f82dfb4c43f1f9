//! `midair.solvers`.

use midair::solvers as registry;

use crate::prelude::*;

/// Option of a solver; from `midair.solvers`.
///
/// Examples
/// --------
/// >>> import midair
/// >>> option = midair.solvers()["greedy"].options["order"]
/// >>> option.default in option.words
/// True
#[pyclass(frozen, get_all, module = "midair")]
pub(crate) struct OptionInfo {
    /// Default value.
    default: Py<PyAny>,
    /// Description in one line.
    doc: String,
    /// Words that the option accepts; empty for other types.
    words: Vec<String>,
    /// Whether the option accepts a list of integers.
    list: bool,
}

pickled!(OptionInfo: default: Py<PyAny>, doc: String, words: Vec<String>, list: bool);

#[pymethods]
impl OptionInfo {
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Self>() else { return Ok(false) };
        let parts = |info: &Self| (info.doc.clone(), info.words.clone(), info.list);
        Ok(parts(self) == parts(other.get()) && self.default.bind(other.py()).eq(&other.get().default)?)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<default {}: {}>", self.default.bind(py).repr()?, self.doc))
    }
}

/// Description of a solver; from `midair.solvers`.
///
/// Examples
/// --------
/// >>> import midair
/// >>> fast = midair.solvers()["fast"]
/// >>> fast.name, "seed" in fast.options
/// ('fast', True)
#[pyclass(frozen, module = "midair")]
pub(crate) struct SolverInfo {
    /// Name of the solver.
    #[pyo3(get)]
    name: String,
    /// Description in one line.
    #[pyo3(get)]
    summary: String,
    /// Paper and equation.
    #[pyo3(get)]
    source: String,
    /// Whether the solver balances by default.
    #[pyo3(get)]
    balance: bool,
    /// Whether the solver uses the phases of complex pressures, a start and an aim.
    uses: [bool; 3],
    /// Options by name.
    #[pyo3(get)]
    options: Py<PyDict>,
}

pickled!(SolverInfo: name: String, summary: String, source: String, balance: bool, uses: [bool; 3], options: Py<PyDict>);

#[pymethods]
impl SolverInfo {
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Self>() else { return Ok(false) };
        let texts = |info: &Self| (info.name.clone(), info.summary.clone(), info.source.clone());
        let parts = |info: &Self| (texts(info), info.balance, info.uses);
        Ok(parts(self) == parts(other.get()) && self.options.bind(other.py()).eq(&other.get().options)?)
    }

    fn __repr__(&self) -> String {
        format!("<{}: {}>", self.name, self.summary)
    }
}

getters! {
    SolverInfo:

    /// Whether the solver uses the phases of complex pressures.
    uses_phases(self) -> bool = self.uses[0];

    /// Whether the solver uses a start.
    uses_start(self) -> bool = self.uses[1];

    /// Whether the solver uses an aim.
    uses_aim(self) -> bool = self.uses[2];
}

/// Return every solver by name, with its options, their documentation and defaults.
///
/// Returns
/// -------
/// dict of str to midair.SolverInfo
///     The solvers.
#[pyfunction]
pub(crate) fn solvers(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for entry in registry::SOLVERS {
        let options = PyDict::new(py);
        for option in entry.options() {
            let default = read::option_object(py, &option.default)?.unbind();
            let words = option.words.iter().map(ToString::to_string).collect();
            let info = OptionInfo { default, doc: option.doc.into(), words, list: option.list };
            options.set_item(option.name, Bound::new(py, info)?)?;
        }
        let registry::Info { name, summary, source, balance, uses_start, uses_aim, .. } = *entry.info;
        let [label, summary, source] = [name, summary, source].map(String::from);
        let uses = [entry.uses_phases(), uses_start, uses_aim];
        let info = SolverInfo { name: label, summary, source, balance, uses, options: options.unbind() };
        dict.set_item(name, Bound::new(py, info)?)?;
    }
    Ok(dict)
}
