//! Tracks over a whole sequence or the next few frames of it, for `midair.sequence(..., ahead=)`.

use midair::motion::{Ahead, Ends, ahead};
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

/// Codes (T, N) of a whole sequence, uint16: array and air of a scene, points (T, M, 3) in m and targets (T, M) in Pa, 0 where
/// a point is not there. No phase of `phases` changes by more than `change` rad from frame to frame, nor, closed, from the last
/// to the first. With a `start` (T, N) its first frame stays. progress is called with (step, steps, residual).
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
    // Of the windows of one sequence only the first has no start.
    if start.is_none() {
        warn_all(py, Remark::still_on(how.change, how.phases))?;
    }
    let threads = limits::threads(py)?;
    let codes = attend(py, progress, |control| {
        ahead(&model, &points, &targets, frames, &how, start, &mut control.on(threads))
    })?;
    give::table(py, codes, [frames, model.array().len()])
}
