//! Curves, and points along curves and contours.

use midair::points;
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::error::refused;
use crate::give::fresh;
use crate::pickle::Reduced;
use crate::read::{place, vectors};

/// A curve parametrised by arc length: a line, a circle, or a polyline.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Curve {
    curve: points::Curve,
    /// The static method that made it, and its arguments, for pickling.
    made: (&'static str, Py<PyTuple>),
}

fn made<'py>(
    py: Python<'py>,
    curve: Result<points::Curve, midair::Error>,
    method: &'static str,
    arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
) -> PyResult<Curve> {
    Ok(Curve { curve: curve.map_err(refused)?, made: (method, arguments.into_pyobject(py)?.unbind()) })
}

#[pymethods]
impl Curve {
    #[staticmethod]
    fn line(start: &Bound<'_, PyAny>, end: &Bound<'_, PyAny>, there_and_back: bool) -> PyResult<Self> {
        let curve = points::Curve::line(place("start", start)?, place("end", end)?, there_and_back);
        made(start.py(), curve, "line", (start, end, there_and_back))
    }

    #[staticmethod]
    fn circle(center: &Bound<'_, PyAny>, radius: f64, normal: &Bound<'_, PyAny>, angle: f64) -> PyResult<Self> {
        let curve = points::Curve::circle(place("center", center)?, radius, place("normal", normal)?, angle);
        made(center.py(), curve, "circle", (center, radius, normal, angle))
    }

    #[staticmethod]
    fn lines(item: &str, corners: &Bound<'_, PyAny>, closed: bool) -> PyResult<Self> {
        let curve = points::Curve::lines(item, &vectors(item, corners)?, closed);
        made(corners.py(), curve, "lines", (item, corners, closed))
    }

    #[getter]
    fn length(&self) -> f64 {
        self.curve.length()
    }

    #[getter]
    fn closed(&self) -> bool {
        self.curve.closed()
    }

    /// Returns points (M, 3), evenly spaced.
    fn points<'py>(&self, py: Python<'py>, step: f64) -> PyResult<Bound<'py, PyArray2<f64>>> {
        fresh(py, &self.curve.points(step).map_err(refused)?)
    }

    /// Returns the places (..., 3) at distances (...) in m along the curve from its start.
    fn after<'py>(&self, py: Python<'py>, ways: PyReadonlyArrayDyn<'_, f64>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let places = ways.as_array().iter().flat_map(|&way| self.curve.after(way)).collect();
        let shape: Vec<usize> = ways.shape().iter().copied().chain([3]).collect();
        PyArray1::from_vec(py, places).reshape(shape)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        Ok((py.get_type::<Self>().getattr(self.made.0)?, self.made.1.bind(py).clone()))
    }
}

/// Returns points (M, 3) along contours with vertices (K, 3).
#[pyfunction]
pub(crate) fn along<'py>(
    py: Python<'py>,
    contours: Vec<Bound<'py, PyAny>>,
    step: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let contours: Vec<_> = contours.iter().map(|contour| vectors("contour", contour)).collect::<PyResult<_>>()?;
    fresh(py, &points::along(&contours, step).map_err(refused)?)
}
