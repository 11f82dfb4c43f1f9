//! `midair.judge`: metrics of a drive. `midair.bound`: an upper bound of the level that any drive can reach.

use midair::{Precision, SolveRequest};
use numpy::PyUntypedArray;

use crate::metrics::{BatchMetrics, Metrics};
use crate::numbers::refuse_hidden;
use crate::prelude::*;
use crate::propagation::Propagation;
use crate::scene::Scene;
use crate::setting::{Setting, points_of};
use crate::solution::{Solution, played};
use crate::subject::{Beside, Subject};

/// Compute an upper bound on the level min |p| / target over the points with a pressure.
///
/// Parameters
/// ----------
/// scene : midair.Scene or midair.Propagation
///     The request.
/// pressures : float or (M,) array_like, optional
///     Peak pressures in Pa for a matrix; or in place of those of a scene.
/// weights : (M,) array_like, optional
///     Weights for a matrix; or in place of those of a scene.
/// mask : (N,) array_like of bool, optional
///     Transducers that are on, for a matrix; or in place of the mask of a scene.
///
/// Returns
/// -------
/// float
///     No drive, quantised or not, exceeds it.
///
/// Raises
/// ------
/// SceneError
///     For no pressure above 0.
/// TypeError
///     If `scene` has another type.
///
/// Notes
/// -----
/// Up to three points it is the highest level itself, to 1e-4. For more it is the value of a semidefinite relaxation,
/// some 8 to 9 % above the best known field; above 64 points it is looser.
///
/// Examples
/// --------
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
/// >>> level = midair.solve(scene, "best").metrics.level
/// >>> level < midair.bound(scene) < 1.0002 * level
/// True
#[pyfunction]
#[pyo3(signature = (scene, *, pressures=None, weights=None, mask=None))]
pub(crate) fn bound(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    pressures: Argument<'_, '_>,
    weights: Argument<'_, '_>,
    mask: Argument<'_, '_>,
) -> PyResult<f64> {
    let subject = Subject::read(scene, Beside { pressures, weights, mask, ..Beside::default() })?;
    attend(py, None, |mut control| midair::bound(&subject.problem(false, &mut control)?, &mut control))
}

/// Compute the metrics of a drive, or of many drives as a table.
///
/// Parameters
/// ----------
/// scene : midair.Scene, midair.Propagation, midair.Solution or midair.Array
///     A solution alone gives its scene and its drive; an array goes with `points`.
/// drive : (N,) or (B, N) array_like, or midair.Solution, optional
///     A drive, or a solution, whose scale is applied. B drives are judged at a scene's own points, at `points`, or for
///     a matrix's B targets.
/// points : (B, M, 3) array_like, optional
///     Points in m of many drives.
/// pressures, weights, mask : array_like, optional
///     For a matrix or `points`; or in place of a scene's own. For many drives as in `solve_batch`.
/// precision : {"single", "double"}, optional
///     "single" is exact to 1e-4 of the array's reach at a point, "double" to 1e-9.
/// threads, progress
///     For many drives, as in `solve_batch`; if progress returns False the rest of the table is NaN.
///
/// Returns
/// -------
/// midair.Metrics or midair.BatchMetrics
///     Metrics of one drive, or of B drives.
///
/// Raises
/// ------
/// SceneError
///     For a drive of another shape or not finite.
/// TypeError
///     If `scene` has another type.
///
/// Notes
/// -----
/// accuracy is eq. (12), sigma eq. (13) of Suzuki et al., IEEE Trans. Haptics 14, 914 (2021).
///
/// Examples
/// --------
/// >>> import midair, numpy
/// >>> array = midair.Array.preset("paper20")
/// >>> points = numpy.random.default_rng(1).uniform(-0.05, 0.05, (10, 4, 3)) + [0, 0, 0.15]
/// >>> batch = midair.solve_batch(array, points, solver="fast")
/// >>> judged = midair.judge(array, batch.drives, points=points)
/// >>> bool(abs(judged.accuracy - batch.metrics.accuracy).max() < 1e-4)
/// True
#[pyfunction]
#[pyo3(signature = (
    scene, drive=None, *, points=None, pressures=None, weights=None, mask=None, precision=None, threads=None, progress=None
))]
pub(crate) fn judge<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    drive: Argument<'_, 'py>,
    points: Argument<'_, 'py>,
    pressures: Argument<'_, 'py>,
    weights: Argument<'_, 'py>,
    mask: Argument<'_, 'py>,
    precision: Argument<'_, 'py>,
    threads: Argument<'_, 'py>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let precision = precision
        .map_or(Ok(Precision::default()), |value| read::word("precision", value, "give \"single\" or \"double\""))?;
    let beside = Beside { pressures, weights, mask, ..Beside::default() };
    if let Some(drives) = drive.filter(|drive| points.is_some() || is_table(drive)) {
        let work = Work { precision, threads: limits::at_most(threads)?, progress };
        return Ok(Bound::new(py, judge_many(scene, drives, points, beside, work)?)?.into_any());
    }
    if points.is_some() || threads.is_some() || progress.is_some() {
        return Err(invalid("drive", "one", "points, threads and progress go with drives (B, N)"));
    }
    let (subject, drive) = match (scene.cast::<Solution>(), drive) {
        (Ok(_), Some(_)) => {
            return Err(PyTypeError::new_err("drive is given, but the Solution has its own: leave it out"));
        }
        (Ok(solution), None) => (answered(solution, beside)?, played(solution)?),
        (Err(_), Some(drive)) => (Subject::read(scene, beside)?, played(drive)?),
        (Err(_), None) => return Err(invalid("drive", "None", "give one (N,), or a Solution alone")),
    };
    let judge = |mut control: Control<'_>| subject.problem(false, &mut control)?.judge(&drive, precision, &mut control);
    Ok(Bound::new(py, Metrics::from(attend(py, None, judge)?))?.into_any())
}

/// Returns whether `drive` has several drives, as rows.
fn is_table(drive: &Bound<'_, PyAny>) -> bool {
    match drive.cast::<PyUntypedArray>() {
        Ok(array) => array.ndim() > 1,
        Err(_) => !drive.is_instance_of::<PyString>() && drive.get_item(0).is_ok_and(|first| first.len().is_ok()),
    }
}

/// Settings of the evaluation of many drives.
struct Work {
    precision: Precision,
    threads: usize,
    progress: Option<Py<PyAny>>,
}

fn judge_many(
    scene: &Bound<'_, PyAny>,
    drives: &Bound<'_, PyAny>,
    points: Argument<'_, '_>,
    Beside { pressures, weights, mask, .. }: Beside<'_, '_>,
    Work { precision, threads, progress }: Work,
) -> PyResult<BatchMetrics> {
    let py = scene.py();
    let keywords = PyDict::new(py);
    mask.map_or(Ok(()), |mask| keywords.set_item("mask", mask))?;
    let Setting { mut session, .. } = Setting::read(scene, None, Some(&keywords))?;
    let drives = Drives::read(drives, session.transducers())?;
    let count = drives.count;
    // Without `points`, all drives are evaluated at the scene's own points and request.
    let base = scene.cast::<Scene>().ok().filter(|_| points.is_none()).map(|scene| &*scene.get().inner);
    let (points, size) = match (base, points_of(&session, points, "(B, M, 3)")) {
        (Some(base), _) => (Vec::new(), base.points().len()),
        (None, list) => match list? {
            None => (Vec::new(), session.given_points().unwrap_or_default()),
            Some(points) => match read::batch_of_points("points", points)? {
                (points, [rows, size]) if rows == count => (points, size),
                (_, [rows, _]) => {
                    let cure = format!("give {count}, one row a drive");
                    return Err(invalid("points", &format!("for {rows} drives"), &cure));
                }
            },
        },
    };
    let batch = pressures.map(|value| read::batch_of_pressures(value, [count, size])).transpose()?.unwrap_or_default();
    let weights = weights.map(|value| read::batch_of_numbers("weights", value, [count, size])).transpose()?;
    let request = base.map(midair::Scene::request);
    let requested = request.filter(|_| batch.pressures.is_none());
    let requested = [
        (&batch.pressures, requested.and_then(|r| r.pressures.as_deref())),
        (&batch.phases, requested.and_then(|r| r.phases.as_deref())),
        (&weights, request.and_then(|r| r.weights.as_deref())),
    ];
    read::callback(progress.as_ref().map(|callback| callback.bind(py)), "done, problems, residual")?;
    let write = |k: usize, ask: &mut SolveRequest| -> Result<(), midair::Error> {
        let range = k * size..(k + 1) * size;
        let lists = requested.map(|(values, default)| values.as_ref().map(|list| &list[range.clone()]).or(default));
        let default = base.map_or(&[][..], midair::Scene::points);
        ask.write(points.get(range.clone()).unwrap_or(default), lists);
        Ok(())
    };
    let drives = drives.slice()?;
    let inner = attend(py, progress, |control| {
        session.judge_batch(count, size, &write, drives, precision, &mut control.with_threads(threads))
    })?;
    Ok(BatchMetrics { inner })
}

/// Drives (B, N): a complex64 array is used without a copy, other values are rounded to complex64.
struct Drives<'py> {
    count: usize,
    array: Option<PyReadonlyArray2<'py, Complex32>>,
    rounded: Vec<Complex32>,
}

impl<'py> Drives<'py> {
    fn read(value: &Bound<'py, PyAny>, transducers: usize) -> PyResult<Self> {
        if let Ok(array) = value.cast::<PyArray2<Complex32>>()
            && array.is_c_contiguous()
            && array.is_aligned()
            && array.shape()[1] == transducers
        {
            refuse_hidden("drives", value)?;
            let used = |_| invalid("drives", "in use by another call", "wait for that one");
            let array = array.try_readonly().map_err(used)?;
            return Ok(Self { count: array.shape()[0], array: Some(array), rounded: Vec::new() });
        }
        let (rounded, count) = read::batch_of_drives("drives", value, transducers)?;
        Ok(Self { count, array: None, rounded })
    }

    fn slice(&self) -> PyResult<&[Complex32]> {
        self.array.as_ref().map_or(Ok(&self.rounded[..]), |array| Ok(array.as_slice()?))
    }
}

/// Returns the scene of a solution, with the values in `beside` instead of its own.
fn answered(solution: &Bound<'_, Solution>, beside: Beside<'_, '_>) -> PyResult<Subject> {
    let py = solution.py();
    if let Some(scene) = solution.get().scene()? {
        return Subject::read(Bound::new(py, scene)?.as_any(), beside);
    }
    let (matrix, request) = solution.get().matrix();
    if [beside.pressures, beside.weights, beside.mask].iter().all(Option::is_none) {
        return Ok(Subject::Given(matrix, request));
    }
    Subject::read(Bound::new(py, Propagation { inner: matrix.propagation })?.as_any(), beside)
}
