//! Methods of `midair.Solution` that compute something of its scene and drive. Each calls a function of the package.

use pyo3::prelude::*;

use crate::field::{Field, field};
use crate::gorkov::{Gorkov, Rest, gorkov, rest};
use crate::judge::judge;
use crate::solution::Solution;

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

#[pymethods]
impl Solution {
    /// Compute the solution's field: `midair.field` of its scene and drive, times its scale.
    ///
    /// Parameters
    /// ----------
    /// plane : midair.Plane or (P, 3) array_like, optional
    ///     Plane or points, as for `midair.field`.
    ///
    /// Returns
    /// -------
    /// midair.Field
    ///     The field.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For wrong points, and for a solution without a scene.
    #[pyo3(signature = (plane=None))]
    fn field<'py>(slf: &Bound<'py, Self>, plane: Option<Bound<'py, PyAny>>) -> PyResult<Field> {
        field(slf.py(), slf, None, plane)
    }

    /// Compute potential, force and stiffness of a small sphere: `midair.gorkov` of the solution's scene and drive.
    ///
    /// Parameters
    /// ----------
    /// points, bead
    ///     As for `midair.gorkov`.
    ///
    /// Returns
    /// -------
    /// midair.Gorkov
    ///     Results at each point.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     As for `midair.gorkov`, and if the solution has no scene.
    #[pyo3(signature = (points=None, *, bead=None))]
    fn gorkov<'py>(
        slf: &Bound<'py, Self>,
        points: Option<Bound<'py, PyAny>>,
        bead: Argument<'_, 'py>,
    ) -> PyResult<Gorkov> {
        gorkov(slf.py(), slf, None, points, bead)
    }

    /// Find where small spheres come to rest in the solution's field: `midair.rest` of its scene and drive.
    ///
    /// Parameters
    /// ----------
    /// points, bead
    ///     As for `midair.rest`.
    ///
    /// Returns
    /// -------
    /// midair.Rest
    ///     Results for each sphere.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     As for `midair.rest`, and if the solution has no scene.
    #[pyo3(signature = (points=None, *, bead=None))]
    fn rest<'py>(slf: &Bound<'py, Self>, points: Option<Bound<'py, PyAny>>, bead: Argument<'_, 'py>) -> PyResult<Rest> {
        rest(slf.py(), slf, None, points, bead)
    }

    /// Compute the solution's metrics: `midair.judge` of its scene and of its drive times its scale.
    ///
    /// Parameters
    /// ----------
    /// pressures, weights, mask, precision
    ///     As for `midair.judge`.
    ///
    /// Returns
    /// -------
    /// midair.Metrics
    ///     The metrics.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For wrong pressures, weights, mask or precision.
    #[pyo3(signature = (*, pressures=None, weights=None, mask=None, precision=None))]
    fn judge<'py>(
        slf: &Bound<'py, Self>,
        pressures: Argument<'_, 'py>,
        weights: Argument<'_, 'py>,
        mask: Argument<'_, 'py>,
        precision: Argument<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        judge(slf.py(), slf, None, None, pressures, weights, mask, precision, None, None)
    }
}
