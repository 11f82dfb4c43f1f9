//! `midair.judge` and `midair.bound`: how good a drive is, and how good any drive can be.

use std::sync::Arc;

use midair::Control;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::ctrl_c::attend;
use crate::error::invalid;
use crate::metrics::Metrics;
use crate::propagation::Propagation;
use crate::solution::{Solution, played};
use crate::subject::{Beside, Subject};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// An upper bound on the level min |p| / target over the points with a pressure: no drive, quantised or not, exceeds it.
///
/// Up to three points it is the highest level itself, to 1e-4. Of more it is the value of a semidefinite relaxation, some 8 to
/// 9 % above the best field known; above 64 points it is looser.
/// pressures in Pa (one number or (M,)), weights (M,) and mask (N,) go with a Propagation, or replace a scene's own.
///
/// Raises SceneError for no pressure above 0, TypeError where scene is neither.
///
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
    attend(py, None, |mut control| midair::bound(&subject.problem(&mut control)?, &mut control))
}

/// The metrics of a drive (N,), or of a Solution with its scale counted in, wholly in double precision. Pressures,
/// weights and mask go with a Propagation, or replace a scene's own. A Solution alone stands for what it answers and its
/// drive: `midair.judge(solution)`, or `solution.judge()`.
///
/// Raises SceneError for a drive of another shape or not finite, TypeError where scene is neither.
#[pyfunction]
#[pyo3(signature = (scene, drive=None, *, pressures=None, weights=None, mask=None))]
pub(crate) fn judge(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    drive: Argument<'_, '_>,
    pressures: Argument<'_, '_>,
    weights: Argument<'_, '_>,
    mask: Argument<'_, '_>,
) -> PyResult<Metrics> {
    let beside = Beside { pressures, weights, mask, ..Beside::default() };
    let (subject, drive) = match (scene.cast::<Solution>(), drive) {
        (Ok(_), Some(_)) => {
            return Err(PyTypeError::new_err("drive is given, but the Solution has its own: leave it out"));
        }
        (Ok(solution), None) => (answered(solution, beside)?, played(solution)?),
        (Err(_), Some(drive)) => (Subject::read(scene, beside)?, played(drive)?),
        (Err(_), None) => return Err(invalid("drive", "None", "give one (N,), or a Solution alone")),
    };
    let judge = |mut control: Control<'_>| subject.problem(&mut control)?.judge(&drive, &mut control);
    attend(py, None, judge).map(Metrics::from)
}

/// What a solution answers, with what is given beside it.
fn answered(solution: &Bound<'_, Solution>, beside: Beside<'_, '_>) -> PyResult<Subject> {
    let py = solution.py();
    if let Some(scene) = solution.get().scene()? {
        return Subject::read(Bound::new(py, scene)?.as_any(), beside);
    }
    let (propagation, setup, request) = solution.get().inner.requested();
    if [beside.pressures, beside.weights, beside.mask].iter().all(Option::is_none) {
        return Ok(Subject::Given(propagation.clone(), Arc::new(setup.clone()), request));
    }
    Subject::read(Bound::new(py, Propagation { inner: propagation.clone() })?.as_any(), beside)
}

#[pymethods]
impl Solution {
    /// Its metrics in double precision, scale counted in: `midair.judge` of what it answers and its drive.
    ///
    /// Raises SceneError for pressures, weights or a mask that are not in order.
    #[pyo3(signature = (*, pressures=None, weights=None, mask=None))]
    fn judge(
        slf: &Bound<'_, Self>,
        pressures: Argument<'_, '_>,
        weights: Argument<'_, '_>,
        mask: Argument<'_, '_>,
    ) -> PyResult<Metrics> {
        judge(slf.py(), slf, None, pressures, weights, mask)
    }
}
