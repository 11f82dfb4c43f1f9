//! Points of lines, circles and contours, evenly spaced by the core.

use midair::points;
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::error::refused;
use crate::give::fresh;
use crate::read::{place, vectors};

type Points<'py> = PyResult<Bound<'py, PyArray2<f64>>>;

/// Points (M, 3) of a line.
#[pyfunction]
pub(crate) fn line<'py>(start: &Bound<'py, PyAny>, end: &Bound<'py, PyAny>, step: f64) -> Points<'py> {
    let points = points::line(place("start", start)?, place("end", end)?, step);
    fresh(start.py(), &points.map_err(refused)?)
}

/// Points (M, 3) of a circle.
#[pyfunction]
pub(crate) fn circle<'py>(
    center: &Bound<'py, PyAny>,
    radius: f64,
    normal: &Bound<'py, PyAny>,
    step: f64,
) -> Points<'py> {
    let points = points::circle(place("center", center)?, radius, place("normal", normal)?, step);
    fresh(center.py(), &points.map_err(refused)?)
}

/// Points (M, 3) of a polyline.
#[pyfunction]
pub(crate) fn polyline<'py>(points: &Bound<'py, PyAny>, closed: bool, step: f64) -> Points<'py> {
    let found = points::polyline(&vectors("points", points)?, closed, step);
    fresh(points.py(), &found.map_err(refused)?)
}

/// Points (M, 3) along contours of vertices (K, 3).
#[pyfunction]
pub(crate) fn along<'py>(py: Python<'py>, contours: Vec<Bound<'py, PyAny>>, step: f64) -> Points<'py> {
    let contours: Vec<_> = contours.iter().map(|contour| vectors("contour", contour)).collect::<PyResult<_>>()?;
    fresh(py, &points::along(&contours, step).map_err(refused)?)
}
