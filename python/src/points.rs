//! Points along curves and contours.

use midair::{files, points};

use crate::give::fresh;
use crate::node;
use crate::prelude::*;
use crate::read::{pose, vectors};

/// Returns the points (M, 3) of a line, circle or polyline, as `[[shape]]` in a scene file describes it.
#[pyfunction]
pub(crate) fn shape_points<'py>(table: &Bound<'py, PyDict>) -> PyResult<Array2<'py, f64>> {
    fresh(table.py(), &files::read_shape(&node::table(table)?).map_err(refused)?)
}

/// Returns points (M, 3) along contours with vertices (K, 3).
#[pyfunction]
pub(crate) fn along<'py>(py: Python<'py>, contours: Vec<Bound<'py, PyAny>>, step: f64) -> PyResult<Array2<'py, f64>> {
    let contours: Vec<_> = contours.iter().map(|contour| vectors("contour", contour)).collect::<PyResult<_>>()?;
    fresh(py, &points::along(&contours, step).map_err(refused)?)
}

/// Returns the matrix (3, 3) of a rotation: axis times angle in rad (3,), quaternion w, x, y, z (4,), matrix, or None.
#[pyfunction]
pub(crate) fn rotation<'py>(py: Python<'py>, rotation: Option<&Bound<'py, PyAny>>) -> PyResult<Array2<'py, f64>> {
    fresh(py, &pose(rotation, None)?.rows())
}
