//! `midair.solve`, `midair.Solution`, `midair.Metrics` and `midair.solvers`.

use std::ffi::CString;
use std::time::Instant;

use midair::{Complex32, Control, OptionValue, Progress, Workspace, solvers as registry};
use numpy::{IntoPyArray, PyArray1, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::pulse::Pulse;
use crate::task::Task;
use crate::{SceneWarning, invalid, read, refused};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// How good an answer is, over the points with a pressure and a weight above 0, x = |p| / target.
#[pyclass(frozen, get_all, eq, module = "midair")]
#[derive(Clone, PartialEq)]
pub(crate) struct Metrics {
    /// sum |p| / sum target: eq. (12).
    accuracy: f64,
    /// Standard deviation of x / max x: eq. (13) for equal targets.
    sigma: f64,
    /// min x / max x.
    uniformity: f64,
    /// Mean x.
    level: f64,
    /// sum w (target - |p|)^2 / sum w target^2.
    residual: f64,
    /// max |p| over the quiet points over the largest target.
    leak: f64,
}

impl From<midair::Metrics> for Metrics {
    fn from(metrics: midair::Metrics) -> Self {
        let midair::Metrics { accuracy, sigma, uniformity, level, residual, leak } = metrics;
        Self { accuracy, sigma, uniformity, level, residual, leak }
    }
}

#[pymethods]
impl Metrics {
    fn __repr__(&self) -> String {
        let Self { accuracy, sigma, uniformity, level, residual, leak } = self;
        format!(
            "Metrics(accuracy={accuracy:.4}, sigma={sigma:.4}, uniformity={uniformity:.4}, level={level:.4}, residual={residual:.4}, leak={leak:.4})"
        )
    }
}

/// A drive and what it does at the points.
#[pyclass(frozen, module = "midair")]
pub(crate) struct Solution {
    pub(crate) inner: midair::Solution,
    pub(crate) choice: midair::Choice,
    trace: Option<Vec<f64>>,
    elapsed: f64,
}

impl Solution {
    pub(crate) fn new(
        inner: midair::Solution,
        choice: midair::Choice,
        trace: Option<Vec<f64>>,
        elapsed: f64,
    ) -> Self {
        Self { inner, choice, trace, elapsed }
    }
}

#[pymethods]
impl Solution {
    /// Drives q (N,), complex64, |q| <= 1.
    #[getter]
    fn drive<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<Complex32>> {
        self.inner.drive.to_pyarray(py)
    }

    /// Phases (N,) in rad in [0, 2 pi); 0 where the drive is 0.
    #[getter]
    fn phases<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        (0..self.inner.drive.len()).map(|i| self.inner.phase(i)).collect::<Vec<_>>().into_pyarray(py)
    }

    /// Amplitudes (N,), 0 to 1.
    #[getter]
    fn amplitudes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        (0..self.inner.drive.len()).map(|i| self.inner.amplitude(i)).collect::<Vec<_>>().into_pyarray(py)
    }

    /// Complex pressures (M,) in Pa (peak), complex64.
    #[getter]
    fn pressures<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<Complex32>> {
        self.inner.pressures.to_pyarray(py)
    }

    /// Radiation pressures (M,) in Pa, |p|^2/(rho c^2).
    #[getter]
    fn radiation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        (0..self.inner.pressures.len()).map(|j| self.inner.radiation(j)).collect::<Vec<_>>().into_pyarray(py)
    }

    /// Targets (M,) in Pa that the metrics refer to.
    #[getter]
    fn targets<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.targets().to_pyarray(py)
    }

    /// How good it is.
    #[getter]
    fn metrics(&self) -> Metrics {
        self.inner.metrics().into()
    }

    /// How the solve ended: "done", "out_of_steps" or "stopped".
    #[getter]
    fn status(&self) -> String {
        self.inner.status.to_string()
    }

    /// Steps taken.
    #[getter]
    fn steps(&self) -> usize {
        self.inner.steps
    }

    /// What supply or modulation have to multiply all drives by, at most 1: below 1 where the device has
    /// no amplitude for the answer. The pressures count it in, the drives do not.
    #[getter]
    fn scale(&self) -> f64 {
        self.inner.scale
    }

    /// Seconds from the checked scene to the answer.
    #[getter]
    fn elapsed(&self) -> f64 {
        self.elapsed
    }

    /// The residual after each step (steps,), or None where no trace was asked for.
    #[getter]
    fn trace<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.trace.as_ref().map(|trace| trace.to_pyarray(py))
    }

    /// The solver's name.
    #[getter]
    fn solver(&self) -> &str {
        &self.choice.name
    }

    /// Every option in full, whether the targets were balanced, and the level where the method uses one.
    #[getter]
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        read::option_dict(py, &self.choice.table())
    }

    fn __repr__(&self) -> String {
        let metrics = self.inner.metrics();
        let (name, status) = (&self.choice.name, self.inner.status);
        let (accuracy, sigma) = (metrics.accuracy, metrics.sigma);
        let scale = self.inner.scale;
        let supply = if scale < 1.0 { format!(", drives to be scaled by {scale:.4}") } else { String::new() };
        format!("<midair.Solution by {name}: {status}, accuracy {accuracy:.4}, sigma {sigma:.4}{supply}>")
    }
}

/// The solver, its options and whether to balance, from the keywords and the scene file.
fn chosen(
    task: &Task,
    solver: Argument<'_, '_>,
    keywords: Option<&Bound<'_, PyDict>>,
) -> PyResult<midair::Choice> {
    let name = match solver {
        None => None,
        Some(name) => match name.extract::<String>() {
            Ok(name) => Some(name),
            Err(_) => return Err(invalid("solver", &name.to_string(), "give a name as text")),
        },
    };
    let given = read::options(keywords)?;
    // Another solver's options in the file do not fit; the same one's do, and keywords win over them.
    let file = task.choice().filter(|choice| name.as_ref().is_none_or(|name| *name == choice.name));
    let name =
        name.or_else(|| file.map(|choice| choice.name.clone())).unwrap_or_else(|| registry::DEFAULT.into());
    let mut options = file.map(|choice| choice.options.clone()).unwrap_or_default();
    options.extend(given);
    let (balance, level) = file.map_or((None, None), |choice| (choice.balance, choice.level));
    Ok(midair::Choice { name, options, balance, level })
}

/// A level by its name.
pub(crate) fn aim(level: &Bound<'_, PyAny>) -> PyResult<midair::Aim> {
    match level.extract::<String>() {
        Ok(name) => midair::Aim::read("level", &midair::Value::Text(name)).map_err(refused),
        Err(_) => Err(invalid("level", &level.to_string(), "give \"target\" or \"max\"")),
    }
}

/// True or False.
pub(crate) fn flag(item: &str, value: &Bound<'_, PyAny>) -> PyResult<bool> {
    value.extract().map_err(|_| invalid(item, &value.to_string(), "give True, False or None"))
}

/// A start: a Solution or complex numbers are a drive (N,), real numbers are point phases (M,).
pub(crate) fn begin(start: &Bound<'_, PyAny>) -> PyResult<midair::Start> {
    if let Ok(solution) = start.cast::<Solution>() {
        return Ok(midair::Start::Drive(solution.get().inner.drive.clone()));
    }
    if read::is_complex(start) {
        return read::drive("start", start).map(midair::Start::Drive);
    }
    read::reals("start", start).map(midair::Start::Phases)
}

/// Finds a drive for a scene, or for propagation with pressures and weights.
///
/// solver is a name of `solvers()`; left out it is the scene file's, else the default. Its options are keywords.
/// balance=True solves at the level the array can reach and reduces the drives afterwards; None is the method's
/// own habit. start (a drive, point phases or a Solution) and level ("target" or "max") are for the methods that
/// use them. progress(step, steps, residual) is called every step and stops the solve by returning False;
/// trace=True keeps the residuals.
///
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
/// >>> solution = midair.solve(scene, "greedy", phases=16, seed=1)
/// >>> solution.drive.shape, solution.status
/// ((400,), 'done')
#[pyfunction]
#[pyo3(signature = (
    scene, solver=None, *, pressures=None, weights=None, balance=None, level=None, start=None, progress=None,
    trace=false, **options
))]
#[allow(clippy::too_many_arguments, reason = "Python's keywords")]
pub(crate) fn solve(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    solver: Argument<'_, '_>,
    pressures: Argument<'_, '_>,
    weights: Argument<'_, '_>,
    balance: Argument<'_, '_>,
    level: Argument<'_, '_>,
    start: Argument<'_, '_>,
    progress: Option<Py<PyAny>>,
    trace: bool,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Solution> {
    let task = Task::read(scene, pressures, weights)?;
    let mut choice = chosen(&task, solver, options)?;
    if let Some(callback) = progress.as_ref().map(|callback| callback.bind(py))
        && !callback.is_callable()
    {
        return Err(invalid("progress", &callback.to_string(), "give a function of (step, steps, residual)"));
    }
    if let Some(level) = level {
        choice.level = Some(aim(level)?);
    }
    let configured = choice.configured(task.quantization()).map_err(refused)?;
    if start.is_some() && !configured.info.uses_start {
        return Err(refused(registry::unused("start", configured.info.name, |info| info.uses_start)));
    }
    if let Some(balance) = balance {
        choice.balance = Some(flag("balance", balance)?);
    }
    let balance = choice.balance.unwrap_or(configured.info.balance);
    choice.balance = Some(balance);
    choice.options = configured.options;
    let clock = Instant::now();
    let start = start.map(begin).transpose()?;
    let level = crate::level::level()?;
    let problem = py.detach(|| match start {
        None => task.problem(level),
        Some(start) => task.problem(level)?.with_start(start),
    });
    let mut problem = problem.map_err(refused)?;
    if let Some(level) = choice.level {
        problem = problem.with_aim(level);
    }
    if configured.info.uses_aim {
        choice.level = Some(problem.aim());
    } else if problem.is_weak() && !balance {
        let part = 1.0 / problem.balance();
        let part = if part < 0.01 { format!("{part:.1e}") } else { format!("{part:.2}") };
        let text = format!(
            "targets are {part} of the balanced level: foci this weak come out smeared, balance=True cures it"
        );
        warn(py, text)?;
    }
    let mut pulse = Pulse::new(progress);
    let (solution, trace) = py.detach(|| {
        let mut observer = |progress: Progress<'_>| pulse.beat(&progress);
        let control = Control::watched(&mut observer);
        let mut control = if trace { control.traced() } else { control };
        let solution =
            midair::solve(&problem, &*configured.solver, balance, &mut Workspace::new(), &mut control);
        (solution, control.into_trace())
    });
    let elapsed = clock.elapsed().as_secs_f64();
    pulse.raised()?;
    let inner = solution.map_err(refused)?;
    if let Some(beyond) = py.detach(|| problem.beyond()) {
        warn(py, beyond.to_string())?;
    }
    if inner.scale < 1.0 {
        let scale = inner.scale;
        let text = format!(
            "the device has no such amplitude: scale all drives by {scale:.4} by supply or modulation (solution.scale)"
        );
        warn(py, text)?;
    }
    Ok(Solution { inner, choice, trace, elapsed })
}

/// Warns by a `SceneWarning`.
fn warn(py: Python<'_>, text: String) -> PyResult<()> {
    PyErr::warn(py, &py.get_type::<SceneWarning>(), &CString::new(text).unwrap_or_default(), 1)
}

/// One option of a solver.
#[pyclass(frozen, get_all, module = "midair")]
pub(crate) struct OptionInfo {
    /// Its default.
    default: Py<PyAny>,
    /// What it does, in one line.
    doc: &'static str,
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
            options.set_item(option.name, Bound::new(py, OptionInfo { default, doc: option.doc })?)?;
        }
        let registry::Info { name, summary, source, balance, .. } = *entry.info;
        let info = SolverInfo { name, summary, source, balance, options: options.unbind() };
        dict.set_item(name, Bound::new(py, info)?)?;
    }
    Ok(dict)
}
