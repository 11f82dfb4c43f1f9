//! Phase tracks over a whole sequence or a window of frames, for `midair.sequence`; saving and restoring `glide`'s state.

use midair::Complex32;
use midair::sequence::{Ahead, Ends, ahead, stiffen as stiffen_tracks};
use midair::solvers::{Last, Remark};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::ctrl_c::attend;
use crate::error::{invalid, warn_all};
use crate::give;
use crate::limits;
use crate::read;
use crate::scene::Scene;
use crate::solver::Solver;

type Argument<'a, 'py> = &'a Bound<'py, PyAny>;

/// Returns the codes (T, N), uint16, of a whole sequence.
///
/// `scene` gives array and air. `points` (T, M, 3) are in m, `targets` (T, M) in Pa, 0 where a point is absent. A code is one
/// of `phases` phases. No phase changes by more than `change` rad from frame to frame; if `closed`, also from the last frame
/// to the first. The first frame of `start` (T, N) is kept. `progress` is called with (step, steps, residual).
#[pyfunction]
#[pyo3(signature = (scene, points, targets, *, change, phases, closed, rounds, start=None, progress=None))]
#[allow(clippy::too_many_arguments, reason = "Python's keywords")]
pub(crate) fn tracks<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    points: Argument<'_, 'py>,
    targets: Argument<'_, 'py>,
    change: Argument<'_, 'py>,
    phases: Argument<'_, 'py>,
    closed: Argument<'_, 'py>,
    rounds: Argument<'_, 'py>,
    start: Option<PyReadonlyArray2<'py, u16>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyArray2<u16>>> {
    let model = scene.get().model();
    let (points, [frames, count]) = read::batch_of_points("points", points)?;
    let requested = read::batch_of_pressures(targets, [frames, count])?;
    let targets = requested.pressures.ok_or_else(|| invalid("targets", "None", "give (T, M) pressures in Pa"))?;
    let whole = |item: &str, value| Ok::<_, PyErr>(u32::try_from(read::count(item, value)?).unwrap_or(u32::MAX));
    let how = Ahead {
        change: read::real("change", change)?,
        phases: whole("phases", phases)?,
        ends: match read::flag("closed", closed)? {
            _ if start.is_some() => Ends::Held,
            true => Ends::Closed,
            false => Ends::Open,
        },
        rounds: whole("rounds", rounds)?,
    };
    let start = start.as_ref().map(|codes| codes.as_slice()).transpose()?;
    // A sequence is solved in windows; only its first window has no start, so the warning is given once.
    if start.is_none() {
        warn_all(py, Remark::still_on(how.change, how.phases))?;
    }
    let threads = limits::threads(py)?;
    let codes = attend(py, progress, |control| {
        ahead(&model, &points, &targets, frames, &how, start, &mut control.on(threads))
    })?;
    give::table(py, codes, [frames, model.array().len()])
}

/// Codes (T, N) of `tracks` for traps, uint16: as stiff as possible within the bound, each giving the force that its bead needs at
/// `rate` frames a second, by the points `margin` frames before and after. progress is called with (step, steps, 0).
#[pyfunction]
#[pyo3(signature = (scene, points, codes, *, change, phases, closed, rate, margin, progress=None))]
#[allow(clippy::too_many_arguments, reason = "Python's keywords")]
pub(crate) fn stiffen<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    points: Argument<'_, 'py>,
    codes: PyReadonlyArray2<'py, u16>,
    change: f64,
    phases: u32,
    closed: bool,
    rate: f64,
    margin: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyArray2<u16>>> {
    let model = scene.get().model();
    let (points, [frames, _]) = read::batch_of_points("points", points)?;
    let ends = if closed { Ends::Closed } else { Ends::Open };
    let how = Ahead { change, phases, ends, rounds: 1 };
    let mut codes = codes.as_slice()?.to_vec();
    let threads = limits::threads(py)?;
    let codes = attend(py, progress, |control| {
        stiffen_tracks(&model, &points, &how, (rate, margin), &mut codes, &mut control.on(threads)).map(|()| codes)
    })?;
    give::table(py, codes, [frames, model.array().len()])
}

/// State of `glide` as Python objects.
type Remembered<'py> = (Bound<'py, PyArray2<Complex32>>, Bound<'py, PyArray1<f32>>, f32, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl Solver {
    /// Return the state of `glide` after its last frame, for `restore`; None before the first.
    ///
    /// Returns
    /// -------
    /// tuple of (drives, weights, unevenness, motion), or None
    ///     complex64 (3, N) drives at full amplitude as found and as played, and the envelopes; float32 (M,) weights;
    ///     the unevenness of the points; of traps (K, 3) places in m, velocities and accelerations.
    fn last<'py>(&self, py: Python<'py>) -> PyResult<Option<Remembered<'py>>> {
        let mut state = self.state()?;
        let last = state.session.last();
        if last.is_empty() {
            return Ok(None);
        }
        let (drives, weights, unevenness) = last.parts();
        let table = give::table(py, drives.concat(), [3, drives[0].len()])?;
        Ok(Some((table, give::list(py, weights.to_vec()), unevenness, give::rows(py, last.motion())?)))
    }

    /// Restore the state from `last`.
    ///
    /// Parameters
    /// ----------
    /// drives, weights, unevenness, motion
    ///     (3, N), (M,), a number and (K, 3), as `last` returns them.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For arrays of another shape than in `last`.
    /// TypeError
    ///     For other types.
    fn restore(
        &self,
        drives: PyReadonlyArray2<'_, Complex32>,
        weights: PyReadonlyArray1<'_, f32>,
        unevenness: f32,
        motion: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        let mut state = self.state()?;
        let (shape, transducers) = (drives.shape(), state.session.transducers());
        if shape != [3, transducers] {
            return Err(invalid(
                "drives",
                &format!("of shape {shape:?}"),
                &format!("give (3, {transducers}), of last()"),
            ));
        }
        if motion.shape()[1] != 3 {
            let shape = format!("of shape {:?}", motion.shape());
            return Err(invalid("motion", &shape, "give (K, 3), of last()"));
        }
        let rows = drives.as_array();
        let parts = [0, 1, 2].map(|k| rows.row(k).to_vec());
        let motion = motion.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
        *state.session.last() = Last::restore(parts, weights.as_array().to_vec(), unevenness, motion);
        Ok(())
    }
}
