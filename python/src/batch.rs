//! `midair.solve_batch` and `midair.Batch`.

use std::time::Instant;

use midair::{Ask, Complex32, Control, Start, Threads};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::ctrl_c::attend;
use crate::error::{invalid, refused, warn};
use crate::give;
use crate::limits;
use crate::out;
use crate::read::{self, Starts};
use crate::setting::Setting;

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// How good the answers of a batch are: each an array (B,); see `Metrics`.
#[pyclass(frozen, module = "midair")]
pub(crate) struct BatchMetrics {
    inner: Vec<midair::Metrics>,
}

impl BatchMetrics {
    fn each<'py>(&self, py: Python<'py>, part: fn(&midair::Metrics) -> f64) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.inner.iter().map(part).collect())
    }
}

#[pymethods]
impl BatchMetrics {
    /// sum |p| / sum target: eq. (12).
    #[getter]
    fn accuracy<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.accuracy)
    }

    /// Standard deviation of x / max x: eq. (13) for equal targets.
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.sigma)
    }

    /// min x / max x.
    #[getter]
    fn uniformity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.uniformity)
    }

    /// Mean x.
    #[getter]
    fn level<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.level)
    }

    /// sum w (target - |p|)^2 / sum w target^2.
    #[getter]
    fn residual<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.residual)
    }

    /// max |p| over the quiet points over the largest target.
    #[getter]
    fn leak<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.leak)
    }
}

/// The answers to B problems of M points each.
#[pyclass(frozen, module = "midair")]
pub(crate) struct Batch {
    drives: Py<PyArray2<Complex32>>,
    inner: midair::Batch,
    points: usize,
    elapsed: f64,
}

#[pymethods]
impl Batch {
    /// Drives (B, N), complex64, |q| <= 1; `out` itself where that was given.
    #[getter]
    fn drives(&self, py: Python<'_>) -> Py<PyArray2<Complex32>> {
        self.drives.clone_ref(py)
    }

    /// Complex pressures (B, M) in Pa (peak), complex64.
    #[getter]
    fn pressures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<Complex32>>> {
        give::table(py, self.inner.pressures.clone(), [self.inner.steps.len(), self.points])
    }

    /// How good each is: attributes of shape (B,).
    #[getter]
    fn metrics(&self) -> BatchMetrics {
        BatchMetrics { inner: self.inner.metrics.clone() }
    }

    /// What supply or modulation have to multiply each drive by (B,).
    #[getter]
    fn scale<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.inner.scale.clone())
    }

    /// How each ended (B,): "done", "out_of_steps" or "stopped".
    #[getter]
    fn status(&self) -> Vec<String> {
        self.inner.status.iter().map(ToString::to_string).collect()
    }

    /// Steps of each (B,).
    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let steps = self.inner.steps.iter().map(|&steps| i64::try_from(steps).unwrap_or(i64::MAX));
        give::list(py, steps.collect())
    }

    /// Whether a pressure of each is above what the array reaches at its point (B,), bool.
    #[getter]
    fn beyond<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        give::list(py, self.inner.beyond.clone())
    }

    /// Whether the pressures of each are below half the balanced level, solved unbalanced (B,), bool.
    #[getter]
    fn weak<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        give::list(py, self.inner.weak.clone())
    }

    /// Seconds from the checked arguments to the last answer.
    #[getter]
    fn elapsed(&self) -> f64 {
        self.elapsed
    }

    fn __len__(&self) -> usize {
        self.inner.steps.len()
    }

    fn __repr__(&self) -> String {
        format!("<midair.Batch of {} problems of {} points>", self.inner.steps.len(), self.points)
    }
}

/// Solves B problems at once, each bit for bit as `solve` would alone.
///
/// The first argument gives array and medium: a Scene, or an Array with a Scene's keywords (frequency, sound_speed,
/// ...), or a Propagation, a matrix for B targets. quantization and mask replace the array's. points are (B, M, 3) in
/// m, left out for a matrix, whose pressures are then (B, M); else pressures and weights are a number, (M,) or (B, M): a
/// weight of 0 pads problems with fewer points. start is complex drives (B, N) or real point phases (B, M). The drives are written into out
/// (B, N), complex64 and C-contiguous, if that is given. threads is how many at most; the answers do not depend on
/// it. progress(done, problems, mean residual) stops the batch by returning False: what is not yet solved has the
/// status "stopped" and a drive of 0.
///
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
#[allow(clippy::too_many_arguments, reason = "Python's keywords")]
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
    let Setting { mut session, choice, info } = Setting::read(scene, solver, options)?;
    let (points, [count, size]) = match (session.given_points(), points) {
        (None, Some(points)) => read::batch_of_points("points", points)?,
        (Some(size), None) => (Vec::new(), [read::batch_size("pressures", pressures, size)?, size]),
        (Some(_), Some(_)) => {
            return Err(invalid("points", "given", "a matrix has its own points: leave them out"));
        }
        (None, None) => {
            return Err(invalid("points", "left out", "give them, of shape (B, M, 3), in metres"));
        }
    };
    let list = |item, value: Argument<'_, '_>| {
        value.map(|value| read::batch_of_numbers(item, value, [count, size])).transpose()
    };
    let (pressures, weights) = (list("pressures", pressures)?, list("weights", weights)?);
    let transducers = session.transducers();
    if start.is_some() && !info.uses_start {
        return Err(refused(midair::solvers::unused("start", info.name, |info| info.uses_start)));
    }
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
    let threads = match threads {
        None => limits::threads(py)?,
        Some(value) => match read::count("threads", value)? {
            0 => return Err(invalid("threads", "0", "give a whole number, 1 or above")),
            // One works here, and wakes nobody.
            1 => Threads::default().at_most(1),
            most => limits::threads(py)?.at_most(most),
        },
    };
    let clock = Instant::now();
    let ask = |k: usize, ask: &mut Ask| -> Result<(), midair::Error> {
        let own = k * size..(k + 1) * size;
        ask.points.clear();
        ask.points.extend_from_slice(points.get(own.clone()).unwrap_or_default());
        rewrite(&mut ask.request.pressures, pressures.as_ref().map(|list| &list[own.clone()]));
        rewrite(&mut ask.request.weights, weights.as_ref().map(|list| &list[own.clone()]));
        ask.start = match &starts {
            Starts::None => None,
            Starts::Drives(drives) => Some(Start::Drive(drives[k * transducers..(k + 1) * transducers].to_vec())),
            Starts::Phases(phases) => Some(Start::Phases(phases[own].to_vec())),
        };
        ask.aim = choice.aim;
        Ok(())
    };
    let slice = writable.as_slice_mut()?;
    let inner =
        attend(py, progress, |control| session.solve_batch(count, size, &ask, slice, &mut control.on(threads)))?;
    let drives = (**writable).clone();
    if out.is_none() {
        writable.make_nonwriteable();
    }
    for remark in &inner.remarks {
        warn(py, remark)?;
    }
    Ok(Batch { drives: drives.unbind(), inner, points: size, elapsed: clock.elapsed().as_secs_f64() })
}

/// Writes a list over another one, in its memory.
fn rewrite(list: &mut Option<Vec<f64>>, with: Option<&[f64]>) {
    match (list, with) {
        (Some(list), Some(with)) => {
            list.clear();
            list.extend_from_slice(with);
        }
        (list, with) => *list = with.map(<[f64]>::to_vec),
    }
}
