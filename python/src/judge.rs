//! `midair.judge` and `midair.bound`: how good a drive is, and how good any drive can be.

use midair::Control;
use pyo3::prelude::*;

use crate::ctrl_c::attend;
use crate::metrics::Metrics;
use crate::solution::played;
use crate::subject::{Beside, Subject};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// An upper bound on the level min |p| / target over the points with a pressure: no drive, quantised or not, exceeds it.
///
/// It is the value of a semidefinite relaxation and lies some 8 to 9 % above the best field known. At most 64 points.
/// pressures in Pa (one number or (M,)), weights (M,) and mask (N,) go with a Propagation, or replace a scene's own.
///
/// Raises SceneError for more points and for no pressure above 0, TypeError where scene is neither.
///
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
/// >>> level = midair.solve(scene, "wgs").metrics.level
/// >>> level < midair.bound(scene) < 1.12 * level
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
/// weights and mask go with a Propagation, or replace a scene's own.
///
/// Raises SceneError for a drive of another shape or not finite, TypeError where scene is neither.
#[pyfunction]
#[pyo3(signature = (scene, drive, *, pressures=None, weights=None, mask=None))]
pub(crate) fn judge(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    drive: &Bound<'_, PyAny>,
    pressures: Argument<'_, '_>,
    weights: Argument<'_, '_>,
    mask: Argument<'_, '_>,
) -> PyResult<Metrics> {
    let subject = Subject::read(scene, Beside { pressures, weights, mask, ..Beside::default() })?;
    let drive = played(drive)?;
    let judge = |mut control: Control<'_>| subject.problem(&mut control)?.judge(&drive, &mut control);
    attend(py, None, judge).map(Metrics::from)
}
