//! Rules for frames of moving points: their aim, the bound of phases, and how far a solve looks around.

use midair::{OptionValue, Pace};
use pyo3::prelude::*;

use crate::error::refused;
use crate::read;
use crate::scene::Scene;

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Returns the aim of moving points of a scene, and whether traps among them are solved for the largest stiffness. `plain` says
/// that points are given alone.
#[pyfunction]
pub(crate) fn meant<'py>(
    py: Python<'py>,
    scene: &Scene,
    plain: bool,
    aim: Argument<'_, 'py>,
) -> PyResult<(Bound<'py, PyAny>, bool)> {
    let (aim, stiff) = midair::meant(plain, aim.map(read::aim).transpose()?, scene.inner.signature());
    Ok((read::option_object(py, &aim.show())?, stiff))
}

/// Returns the bound of phases in rad per frame, from `change` in rad per frame or `change_rate` in rad/s.
#[pyfunction]
pub(crate) fn bound_of(rate: f64, change: Argument<'_, '_>, change_rate: Argument<'_, '_>) -> PyResult<f64> {
    let [change, change_rate] = [("change", change), ("change_rate", change_rate)]
        .map(|(item, value)| value.map(|value| read::real(item, value)).transpose());
    Pace { rate, change: change?, change_rate: change_rate?, ..Pace::default() }.bound().map_err(refused)
}

/// Returns the number of later frames that a solve knows, None for all. A closed sequence needs all.
#[pyfunction]
pub(crate) fn sight(ahead: &Bound<'_, PyAny>, closed: bool) -> PyResult<Option<usize>> {
    midair::sight(Some(&read::option("ahead", ahead)?), closed).map_err(refused)
}

/// Returns the number of frames on each side from which the acceleration of points is computed.
#[pyfunction]
pub(crate) fn look(rate: f64) -> usize {
    midair::look(rate)
}
