//! `midair.Solution`.

use midair::Status;

use crate::metrics::Metrics;
use crate::pickle::{part, part_or_none};
use crate::prelude::*;
use crate::propagation::Matrix;
use crate::scene::Scene;
use crate::subject::{Beside, Subject};

/// Drive and its pressures at the points; from `midair.solve`.
///
/// Examples
/// --------
/// >>> import midair
/// >>> solution = midair.solve(midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]]))
/// >>> solution.drive.shape, solution.pressures.shape, solution.status
/// ((400,), (2,), 'done')
#[pyclass(frozen, eq, hash, module = "midair")]
pub(crate) struct Solution {
    pub(crate) inner: midair::Solution,
    pub(crate) choice: Arc<midair::Choice>,
    /// The scene that was given. If there is none, it is made from the solution at the first use.
    scene: Option<Scene>,
    trace: Option<Vec<f64>>,
    elapsed: f64,
}

impl Solution {
    pub(crate) fn new(inner: midair::Solution, choice: Arc<midair::Choice>, elapsed: f64) -> Self {
        Self { inner, choice, scene: None, trace: None, elapsed }
    }

    /// Adds a scene and the residual after each step to the solution.
    pub(crate) fn of(self, scene: Option<Scene>, trace: Option<Vec<f64>>) -> Self {
        Self { scene, trace, ..self }
    }
}

/// Compares values; the elapsed time does not count.
impl PartialEq for Solution {
    fn eq(&self, other: &Self) -> bool {
        self.inner == other.inner
            && self.choice == other.choice
            && self.trace == other.trace
            && self.request() == other.request()
    }
}

hashed!(Solution: self => (self.inner.steps, &self.choice.name, Metrics::from(self.inner.metrics())));

impl Solution {
    /// Returns G with its setup, and the request.
    pub(crate) fn matrix(&self) -> (Matrix, Request) {
        let (propagation, setup, request) = self.inner.requested();
        (Matrix { propagation: propagation.clone(), setup: Arc::new(setup.clone()) }, request)
    }

    fn request(&self) -> Option<Arc<midair::Scene>> {
        self.scene.as_ref().map(|scene| Arc::clone(&scene.inner)).or_else(|| self.inner.scene().map(Arc::new))
    }
}

#[pymethods]
impl Solution {
    /// Sound pressure levels (M,) in dB at the points: 20 log10(|p| / sqrt(2) / 20 uPa); -inf where there is silence.
    #[getter]
    fn spl<'py>(&self, py: Python<'py>) -> Array1<'py, f64> {
        let level = |p: &Complex32| midair::spl(f64::from(p.re).hypot(f64::from(p.im)));
        give::list(py, self.inner.pressures.iter().map(level).collect())
    }

    /// The scene of the solution, or None for a matrix of your own.
    #[getter]
    pub(crate) fn scene(&self) -> PyResult<Option<Scene>> {
        match &self.scene {
            Some(scene) => Ok(Some(scene.clone())),
            None => self.inner.scene().map(Scene::of).transpose(),
        }
    }

    #[staticmethod]
    fn _restore(record: &Bound<'_, PyDict>) -> PyResult<Self> {
        let (part, maybe) = (|name: &str| part(record, name), |name: &str| part_or_none(record, name));
        let [pressures, weights, quantization, positions] =
            ["requested", "weights", "quantization", "positions"].map(maybe);
        let (pressures, weights) = (pressures?, weights?);
        let (quantization, positions) = (quantization?, positions?);
        let phases = maybe("phases")?.map(|phases| read::reals("phases", &phases)).transpose()?;
        let subject = part("scene")?;
        let beside = Beside {
            pressures: pressures.as_ref(),
            weights: weights.as_ref(),
            quantization: quantization.as_ref(),
            mask: None,
            positions: positions.as_ref(),
        };
        let mut subject = Subject::read(&subject, beside)?;
        if let (Subject::Given(_, request), Some(phases)) = (&mut subject, phases) {
            request.phases = Some(phases);
        }
        let status = Status::named(&part("status")?.extract::<String>()?).map_err(refused)?;
        let outcome = (status, read::count("steps", &part("steps")?)?, read::real("scale", &part("scale")?)?);
        let drive = read::drive("drive", &part("drive")?)?;
        let received = read::drive("pressures", &part("pressures")?)?;
        let targets = read::reals("targets", &part("targets")?)?;
        let inner = attend(record.py(), None, |mut control| {
            let problem = subject.problem(false, &mut control)?;
            midair::Solution::restored(&problem, drive, received, outcome, Some(targets), &mut control)
        })?;
        let choice = read::choice(part("solver")?.extract()?, part("options")?.cast()?)?;
        let trace = maybe("trace")?.map(|trace| read::reals("trace", &trace)).transpose()?;
        let elapsed = read::real("elapsed", &part("elapsed")?)?;
        Ok(Self::new(inner, Arc::new(choice), elapsed).of(subject.scene(), trace))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let record = PyDict::new(py);
        if let Some(scene) = self.scene()? {
            record.set_item("scene", scene)?;
        } else {
            let (matrix, request) = self.matrix();
            record.set_item("scene", matrix.write(&record)?)?;
            record.set_item("requested", request.pressures)?;
            record.set_item("phases", request.phases)?;
            record.set_item("weights", request.weights)?;
        }
        record.set_item("solver", self.solver())?;
        record.set_item("options", self.options(py)?)?;
        record.set_item("drive", self.drive(py))?;
        record.set_item("pressures", self.pressures(py))?;
        record.set_item("targets", self.targets(py))?;
        record.set_item("status", self.status())?;
        record.set_item("steps", self.steps())?;
        record.set_item("scale", self.scale())?;
        record.set_item("elapsed", self.elapsed)?;
        record.set_item("trace", self.trace(py))?;
        restored::<Self>(py, (record,))
    }

    fn __repr__(&self) -> String {
        let metrics = self.inner.metrics();
        let (name, status) = (&self.choice.name, self.inner.status);
        let (accuracy, sigma) = (metrics.accuracy, metrics.sigma);
        // Without pressures there is no request that a drive could miss.
        let has_targets = self.inner.requested().2.pressures.is_some();
        let [before, after] = if has_targets { ["accuracy ", ""] } else { ["", " of the balanced level"] };
        let scale = self.inner.scale;
        let supply = if scale < 1.0 { format!(", drives to be scaled by {scale:.4}") } else { String::new() };
        format!("<midair.Solution by {name}: {status}, {before}{accuracy:.4}{after}, sigma {sigma:.4}{supply}>")
    }
}

getters! {
    Solution:

    /// Drives q (N,), complex64, |q| <= 1.
    drive(self, py) -> Array1<'py, Complex32> = give::list(py, self.inner.drive.clone());

    /// Phases (N,) in rad in [0, 2 pi); 0 where the drive is 0.
    phases(self, py) -> Array1<'py, f64> =
        give::list(py, (0..self.inner.drive.len()).map(|i| self.inner.phase(i)).collect());

    /// Amplitudes (N,), 0 to 1.
    amplitudes(self, py) -> Array1<'py, f64> =
        give::list(py, (0..self.inner.drive.len()).map(|i| self.inner.amplitude(i)).collect());

    /// Complex pressures (M,) in Pa (peak), complex64.
    pressures(self, py) -> Array1<'py, Complex32> = give::list(py, self.inner.pressures.clone());

    /// Radiation pressures (M,) in Pa, |p|^2/(rho c^2).
    radiation(self, py) -> Array1<'py, f64> =
        give::list(py, (0..self.inner.pressures.len()).map(|j| self.inner.radiation(j)).collect());

    /// Targets (M,) in Pa, to which the metrics refer.
    targets(self, py) -> Array1<'py, f64> = give::list(py, self.inner.targets().to_vec());

    /// Quality of the drive.
    metrics(self) -> Metrics = self.inner.metrics().into();

    /// sqrt(sum w |p - target|^2 / sum w |target|^2) of complex targets over the points of weight above 0, or None if
    /// pressures have no phases.
    complex_error(self) -> Option<f64> = self.inner.complex_error();

    /// How the solve ended: "done", "missed" (by more than 1 %), "out_of_steps" or "stopped".
    status(self) -> String = self.inner.status.to_string();

    /// How many traps hold their bead, as `rest` judges it, and the number of traps; None without named traps, for a
    /// matrix of your own, and where the force on a bead is unknown.
    beads(self, py) -> PyResult<Option<(usize, usize)>> =
        Ok(attend(py, None, |mut control| self.inner.beads(&mut control))?.map(Into::into));

    /// Number of steps.
    steps(self) -> usize = self.inner.steps;

    /// Factor, at most 1, by which the device's supply or modulation is to be reduced. It is below 1 if the device cannot
    /// play amplitudes as small as those of the drive. The pressures include it, the drives do not.
    scale(self) -> f64 = self.inner.scale;

    /// Time in s from the checked scene to the solution.
    elapsed(self) -> f64 = self.elapsed;

    /// The residual after each step (steps,), or None without a trace.
    trace(self, py) -> Option<Array1<'py, f64>> = self.trace.clone().map(|trace| give::list(py, trace));

    /// The solver's name.
    solver(self) -> &str = &self.choice.name;

    /// All options, whether the targets were balanced, and the aim if the method uses one.
    options(self, py) -> PyResult<Bound<'py, PyDict>> = read::option_dict(py, &self.choice.table());
}

/// Scene, drive and place from a function's first arguments: `(scene, drive, place)`, or `(solution, place)`.
pub(crate) type About<'py> = (Bound<'py, Scene>, Bound<'py, PyAny>, Option<Bound<'py, PyAny>>);

/// Returns scene, drive and place: all as given, or scene and drive of a Solution.
#[pyfunction]
#[pyo3(signature = (scene, drive=None, place=None))]
pub(crate) fn about<'py>(
    scene: &Bound<'py, PyAny>,
    drive: Option<Bound<'py, PyAny>>,
    place: Option<Bound<'py, PyAny>>,
) -> PyResult<About<'py>> {
    if let Ok(solution) = scene.cast::<Solution>() {
        let Some(origin) = solution.get().scene()? else {
            let cure = "it answers a matrix of its own, which has no air: multiply that matrix with solution.drive";
            return Err(invalid("solution.scene", "None", cure));
        };
        if drive.is_some() && place.is_some() {
            return Err(PyTypeError::new_err("drive is given, but the Solution has its own: leave it out"));
        }
        return Ok((Bound::new(scene.py(), origin)?, scene.clone(), drive.or(place)));
    }
    let cure = ": midair.Scene(array, points) makes one";
    let scene = scene.cast::<Scene>().map_err(|_| unexpected(scene, "a midair.Scene or a midair.Solution", cure))?;
    let drive = drive.ok_or_else(|| invalid("drive", "None", "give one (N,), or a Solution alone"))?;
    Ok((scene.clone(), drive, place))
}

/// Returns the played drive: a drive (N,) unchanged, or a Solution's times its scale.
pub(crate) fn played(drive: &Bound<'_, PyAny>) -> PyResult<Vec<Complex32>> {
    match drive.cast::<Solution>() {
        Ok(solution) => Ok(solution.get().inner.played()),
        Err(_) => read::drive("drive", drive),
    }
}

/// Reads a start: a Solution or complex numbers give a drive (N,), real numbers are point phases (M,).
pub(crate) fn begin(start: &Bound<'_, PyAny>) -> PyResult<midair::Start> {
    if let Ok(solution) = start.cast::<Solution>() {
        return Ok(midair::Start::Drive(solution.get().inner.drive.clone()));
    }
    read::start("start", start)
}
