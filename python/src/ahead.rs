//! Phase tracks over a whole sequence or a window of frames, for `midair.sequence`.

use midair::sequence::{Ahead, Ends, ahead, stiffen as stiffen_tracks};
use midair::solvers::Remark;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::ctrl_c::attend;
use crate::error::{invalid, warn_all};
use crate::give;
use crate::limits;
use crate::read;
use crate::scene::Scene;

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
        stiffen_tracks(&model, &points, &how, rate, margin, &mut codes, &mut control.on(threads)).map(|()| codes)
    })?;
    give::table(py, codes, [frames, model.array().len()])
}
