//! `midair.Plane`.

use std::hash::{Hash, Hasher};

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::error::{invalid, refused};
use crate::give;
use crate::numbers::quoted;
use crate::pickle::Reduced;
use crate::read;

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// A square of pixels x pixels samples at height z, side size (all in m), around center (x, y).
///
/// >>> import midair
/// >>> float(midair.Plane(z=0.15, size=0.1, pixels=3).x[0])
/// -0.05
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone, PartialEq)]
pub(crate) struct Plane {
    pub(crate) inner: midair::Plane,
}

impl Hash for Plane {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // 0 and -0 are equal.
        let bits = |x: f64| (x + 0.0).to_bits();
        (bits(self.inner.z), bits(self.inner.size), self.inner.pixels).hash(state);
    }
}

#[pymethods]
impl Plane {
    #[new]
    #[pyo3(signature = (z, size, pixels=None, center=None), text_signature = "(z, size, pixels=200, center=(0, 0))")]
    fn new(
        z: &Bound<'_, PyAny>,
        size: &Bound<'_, PyAny>,
        pixels: Argument<'_, '_>,
        center: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let pixels = pixels.map_or(Ok(200), |pixels| read::count("plane.pixels", pixels))?;
        let center = match center {
            None => [0.0, 0.0],
            Some(center) => {
                let pair: Vec<Bound<'_, PyAny>> =
                    center.try_iter().and_then(|few| few.take(3).collect()).unwrap_or_default();
                let [x, y] = &pair[..] else {
                    return Err(invalid("plane.center", &quoted(center), "give two real numbers, x and y"));
                };
                [read::real("plane.center[0]", x)?, read::real("plane.center[1]", y)?]
            }
        };
        let (z, size) = (read::real("plane.z", z)?, read::real("plane.size", size)?);
        Ok(Self { inner: midair::Plane::new(z, size, pixels, center).map_err(refused)? })
    }

    /// Height in m.
    #[getter]
    fn z(&self) -> f64 {
        self.inner.z
    }

    /// Side in m.
    #[getter]
    fn size(&self) -> f64 {
        self.inner.size
    }

    /// Samples along each side.
    #[getter]
    fn pixels(&self) -> usize {
        self.inner.pixels
    }

    /// Middle (x, y) in m.
    #[getter]
    fn center(&self) -> (f64, f64) {
        (self.inner.center[0], self.inner.center[1])
    }

    /// Samples along x (pixels,) in m.
    #[getter]
    pub(crate) fn x<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.inner.axis(0))
    }

    /// Samples along y (pixels,) in m.
    #[getter]
    pub(crate) fn y<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.inner.axis(1))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let midair::Plane { z, size, pixels, center: [x, y] } = slf.get().inner;
        Ok((slf.get_type().into_any(), (z, size, pixels, (x, y)).into_pyobject(slf.py())?))
    }

    fn __repr__(&self) -> String {
        let midair::Plane { z, size, pixels, center: [x, y] } = self.inner;
        format!("Plane(z={z}, size={size}, pixels={pixels}, center=({x}, {y}))")
    }
}
