//! `midair.solve_batch` and `midair.Batch`.

use std::time::Instant;

use midair::{SolveRequest, Start, Status};
use pyo3::exceptions::{PyIndexError, PyOverflowError};

use crate::chosen::Chosen;
use crate::error::SceneError;
use crate::give::rows;
use crate::metrics::BatchMetrics;
use crate::out;
use crate::pickle::{part, part_or_none};
use crate::prelude::*;
use crate::read::Starts;
use crate::setting::{Setting, Source, points_of};
use crate::solution::Solution;

/// Solutions of B problems of M points each; `batch[i]` is the Solution of one.
///
/// Examples
/// --------
/// >>> import midair
/// >>> batch = midair.solve_batch(midair.Array.preset("paper20"), [[[0, 0, 0.15]], [[0.02, 0, 0.15]]])
/// >>> batch.drives.shape, batch[1].status
/// ((2, 400), 'done')
#[pyclass(frozen, module = "midair")]
pub(crate) struct Batch {
    drives: Py<PyArray2<Complex32>>,
    inner: midair::Batch,
    points: usize,
    elapsed: f64,
    request: BatchRequest,
}

/// The requests of all problems, one after the other.
#[derive(PartialEq)]
struct BatchRequest {
    source: Source,
    chosen: Chosen,
    /// Points (B, M, 3); empty for a given matrix G.
    points: Vec<[f64; 3]>,
    request: Request,
}

impl BatchRequest {
    /// Writes the request of problem `k` of `size` points.
    fn write(&self, k: usize, size: usize, single: &mut SolveRequest) {
        let range = k * size..(k + 1) * size;
        let Request { pressures, phases, weights } = &self.request;
        let lists = [pressures, phases, weights].map(|list| list.as_ref().map(|list| &list[range.clone()]));
        single.write(self.points.get(range.clone()).unwrap_or_default(), lists);
        single.aim = self.chosen.choice.aim;
    }
}

impl Batch {
    /// Borrows the drives for reading; raises SceneError while another call writes them.
    fn borrowed<'py>(&self, py: Python<'py>) -> PyResult<PyReadonlyArray2<'py, Complex32>> {
        let drives = self.drives.bind(py).try_readonly();
        drives.map_err(|_| invalid("out", "in use by another call", "wait for that one"))
    }
}

#[pymethods]
impl Batch {
    /// Return the solution of problem `index`; a negative index counts from the end. `elapsed` is its share of the time.
    fn __getitem__(&self, index: &Bound<'_, PyAny>) -> PyResult<Solution> {
        let (py, count, size) = (index.py(), self.inner.steps.len(), self.points);
        let outside = || PyIndexError::new_err(format!("problem {} of a batch of {count}", quoted(index)));
        let at: isize = index
            .extract()
            .map_err(|error: PyErr| if error.is_instance_of::<PyOverflowError>(py) { outside() } else { error })?;
        let k = if at < 0 { at.checked_add_unsigned(count) } else { Some(at) };
        let k = k.and_then(|k| usize::try_from(k).ok()).filter(|&k| k < count).ok_or_else(outside)?;
        let (whole, mut single) = (&self.request, SolveRequest::default());
        whole.write(k, size, &mut single);
        let SolveRequest { points, request, aim, .. } = single;
        let problem = attend(py, None, |mut control| whole.source.problem(&points, &request, &mut control))?;
        let problem = problem.with_aim(aim);
        let drives = self.borrowed(py)?;
        let transducers = drives.len() / count;
        let drive = drives.as_slice()?[k * transducers..(k + 1) * transducers].to_vec();
        let outcome = (self.inner.status[k], self.inner.steps[k], self.inner.scale[k]);
        let pressures = self.inner.pressures[k * size..(k + 1) * size].to_vec();
        let solution = attend(py, None, |mut control| {
            midair::Solution::restored(&problem, drive, pressures, outcome, None, &mut control)
        })
        .map_err(|error| {
            let cure = "out was written over: copy it before it is used again";
            let other = error.is_instance_of::<SceneError>(py);
            if other { invalid(&format!("drives[{k}]"), "not what was answered", cure) } else { error }
        })?;
        Ok(Solution::new(solution, whole.chosen.answered(&problem), self.elapsed / count as f64))
    }

    /// Number of steps of each problem (B,).
    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> Array1<'py, i64> {
        let steps = self.inner.steps.iter().map(|&steps| i64::try_from(steps).unwrap_or(i64::MAX));
        give::list(py, steps.collect())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Self>() else { return Ok(false) };
        let (py, other) = (other.py(), other.get());
        let equal = self.inner == other.inner && self.request == other.request;
        Ok(equal && self.borrowed(py)?.as_slice()? == other.borrowed(py)?.as_slice()?)
    }

    #[staticmethod]
    fn _restore(record: &Bound<'_, PyDict>) -> PyResult<Self> {
        let py = record.py();
        let (part, maybe) = (|name: &str| part(record, name), |name: &str| part_or_none(record, name));
        let options = part("options")?;
        let Setting { chosen, source, .. } =
            Setting::read(&part("scene")?, Some(&part("solver")?), Some(options.cast()?))?;
        let list = |name: &str| maybe(name)?.map(|list| read::reals(name, &list)).transpose();
        let request = BatchRequest {
            source,
            chosen,
            points: read::vectors("points", &part("points")?)?,
            request: Request { pressures: list("requested")?, phases: list("phases")?, weights: list("weights")? },
        };
        let status = part("status")?.extract::<Vec<String>>()?;
        let inner = midair::Batch {
            pressures: read::drive("pressures", &part("pressures")?.call_method1("ravel", ())?)?,
            metrics: part("metrics")?.cast::<BatchMetrics>()?.get().inner.clone(),
            scale: read::reals("scale", &part("scale")?)?,
            status: status.iter().map(|name| Status::named(name)).collect::<Result<_, _>>().map_err(refused)?,
            steps: part("steps")?.extract()?,
            beyond: read::flags("beyond", &part("beyond")?)?,
            weak: read::flags("weak", &part("weak")?)?,
            remarks: part("remarks")?.extract()?,
        };
        let count = inner.steps.len();
        let points = inner.pressures.len() / count;
        let drives = read::drive("drives", &part("drives")?.call_method1("ravel", ())?)?;
        let transducers = drives.len() / count;
        let drives = give::table(py, drives, [count, transducers])?.unbind();
        Ok(Self { drives, inner, points, elapsed: read::real("elapsed", &part("elapsed")?)?, request })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let (record, request) = (PyDict::new(py), &self.request);
        let (scene, options) = request.source.arguments(py, &request.chosen.choice)?;
        record.set_item("scene", scene)?;
        record.set_item("solver", &request.chosen.choice.name)?;
        record.set_item("options", options)?;
        record.set_item("points", rows(py, &request.points)?)?;
        let Request { pressures, phases, weights } = request.request.clone();
        for (name, list) in [("requested", pressures), ("phases", phases), ("weights", weights)] {
            record.set_item(name, list.map(|list| give::list(py, list)))?;
        }
        record.set_item("drives", &self.drives)?;
        record.set_item("pressures", self.pressures(py)?)?;
        record.set_item("metrics", self.metrics())?;
        record.set_item("scale", self.scale(py))?;
        record.set_item("status", self.status())?;
        record.set_item("steps", self.inner.steps.clone())?;
        record.set_item("beyond", self.beyond(py))?;
        record.set_item("weak", self.weak(py))?;
        record.set_item("remarks", self.inner.remarks.clone())?;
        record.set_item("elapsed", self.elapsed)?;
        restored::<Self>(py, (record,))
    }

    fn __len__(&self) -> usize {
        self.inner.steps.len()
    }

    fn __repr__(&self) -> String {
        format!("<midair.Batch of {} problems of {} points>", self.inner.steps.len(), self.points)
    }
}

getters! {
    Batch:

    /// Drives (B, N), complex64, |q| <= 1; `out` itself if it was given.
    drives(self, py) -> Py<PyArray2<Complex32>> = self.drives.clone_ref(py);

    /// Complex pressures (B, M) in Pa (peak), complex64.
    pressures(self, py) -> PyResult<Array2<'py, Complex32>> =
        give::table(py, self.inner.pressures.clone(), [self.inner.steps.len(), self.points]);

    /// Metrics of each problem: attributes of shape (B,).
    metrics(self) -> BatchMetrics = BatchMetrics { inner: self.inner.metrics.clone() };

    /// Factor of each problem's drive for supply or modulation (B,).
    scale(self, py) -> Array1<'py, f64> = give::list(py, self.inner.scale.clone());

    /// Status of each problem (B,): "done", "missed", "out_of_steps" or "stopped".
    status(self) -> Vec<String> = self.inner.status.iter().map(ToString::to_string).collect();

    /// Whether a requested pressure of each problem exceeds the array's reach at its point (B,), bool.
    beyond(self, py) -> Array1<'py, bool> = give::list(py, self.inner.beyond.clone());

    /// Whether each problem was solved unbalanced with pressures below half the balanced level (B,), bool.
    weak(self, py) -> Array1<'py, bool> = give::list(py, self.inner.weak.clone());

    /// Time in s from the checked arguments to the last solution.
    elapsed(self) -> f64 = self.elapsed;
}

/// Solve B problems at once, each with the same bits as `solve`.
///
/// Parameters
/// ----------
/// scene : midair.Scene, midair.Array or midair.Propagation
///     Array and medium: a scene, or an array with a scene's keywords (frequency, sound_speed, ...). Or a matrix for B
///     targets.
/// points : (B, M, 3) array_like, optional
///     Points in m; none for a matrix.
/// pressures : float, (M,) or (B, M) array_like, optional
///     Peak pressures in Pa; for a matrix (B, M).
/// solver : str or callable, optional
///     A name of `solvers()`, as in `solve`.
/// weights : float, (M,) or (B, M) array_like, optional
///     Weights; a weight of 0 pads problems with fewer points.
/// start : (B, N) or (B, M) array_like, optional
///     Complex drives (B, N), or real point phases (B, M) in rad.
/// out : (B, N) ndarray of complex64, optional
///     C-contiguous array for the drives.
/// threads : int, optional
///     Largest number of threads; the solutions do not depend on it.
/// progress : callable, optional
///     Called with (done, problems, mean residual). False stops the batch: unsolved problems have the status "stopped"
///     and a drive of 0.
/// **options
///     Options of the solver; `balance` and `aim`; `quantization` and `mask`, which replace those of the array.
///
/// Returns
/// -------
/// midair.Batch
///     Drives (B, N), metrics and status of each problem.
///
/// Raises
/// ------
/// SceneError
///     As for `solve`, with the number of the problem, before any solve; also if `out` cannot be written.
///
/// Warns
/// -----
/// SceneWarning
///     As for `solve`, once for each kind, with counts.
///
/// Examples
/// --------
/// >>> import midair, numpy
/// >>> points = numpy.random.default_rng(1).uniform(-0.05, 0.05, (10, 4, 3)) + [0, 0, 0.15]
/// >>> batch = midair.solve_batch(midair.Array.preset("paper20"), points, solver="fast")
/// >>> batch.drives.shape, batch.metrics.accuracy.shape
/// ((10, 400), (10,))
#[pyfunction]
#[pyo3(signature = (
    scene, points=None, pressures=None, solver=None, *, weights=None, start=None, out=None, threads=None,
    progress=None, **options
))]
pub(crate) fn solve_batch(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    points: Argument<'_, '_>,
    pressures: Argument<'_, '_>,
    solver: Argument<'_, '_>,
    weights: Argument<'_, '_>,
    start: Argument<'_, '_>,
    out: Argument<'_, '_>,
    threads: Argument<'_, '_>,
    progress: Option<Py<PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Batch> {
    if let Some(word) = pressures.filter(|given| given.is_instance_of::<PyString>()) {
        return Err(invalid("pressures", &quoted(word), "give numbers in Pa; a solver goes by keyword, solver="));
    }
    let Setting { mut session, chosen, source, raised } = Setting::read(scene, solver, options)?;
    let (points, [count, size]) = if let Some(points) = points_of(&session, points, "(B, M, 3)")? {
        read::batch_of_points("points", points)?
    } else {
        let size = session.given_points().unwrap_or_default();
        (Vec::new(), [read::batch_size("pressures", pressures, size)?, size])
    };
    let targets = pressures.map(|value| read::batch_of_pressures(value, [count, size])).transpose()?;
    let weights = weights.map(|value| read::batch_of_numbers("weights", value, [count, size])).transpose()?;
    let request = Request { weights, ..targets.unwrap_or_default() };
    let request = BatchRequest { source, chosen, points, request };
    let transducers = session.transducers();
    request.chosen.check_start(start.is_some())?;
    let starts = match start {
        None => Starts::None,
        Some(start) => read::batch_of_starts("start", start, [count, transducers], [count, size])?,
    };
    let mut writable = match out {
        None => {
            let bytes = 8 * (count as u64).saturating_mul(transducers as u64);
            let control = Control::none().with_memory(limits::memory()?);
            control.room(&format!("the batch of {count} problems"), [transducers, size], bytes).map_err(refused)?;
            PyArray2::<Complex32>::zeros(py, [count, transducers], false).readwrite()
        }
        Some(out) => out::borrowed(out, &[count, transducers])?,
    };
    read::callback(progress.as_ref().map(|callback| callback.bind(py)), "done, problems, residual")?;
    let threads = limits::at_most(threads)?;
    let clock = Instant::now();
    let write = |k: usize, single: &mut SolveRequest| -> Result<(), midair::Error> {
        request.write(k, size, single);
        single.start = match &starts {
            Starts::None => None,
            Starts::Drives(drives) => Some(Start::Drive(drives[k * transducers..(k + 1) * transducers].to_vec())),
            Starts::Phases(phases) => Some(Start::Phases(phases[k * size..(k + 1) * size].to_vec())),
        };
        Ok(())
    };
    let slice = writable.as_slice_mut()?;
    let inner = attend(py, progress, |control| {
        session.solve_batch(count, size, &write, slice, &mut control.with_threads(threads))
    });
    raised.check()?;
    let inner = inner?;
    let drives = (**writable).clone();
    if out.is_none() {
        writable.make_nonwriteable();
    }
    warn_all(py, session.batch_doubts(&request.points, size))?;
    warn_all(py, &inner.remarks)?;
    let elapsed = clock.elapsed().as_secs_f64();
    Ok(Batch { drives: drives.unbind(), inner, points: size, elapsed, request })
}
