//! `midair.Plane`.

use midair::Axis;

use crate::prelude::*;

/// Square of pixels x pixels samples: at height z, or normal to another axis.
///
/// Parameters
/// ----------
/// z : float, optional
///     Height in m of a plane normal to z.
/// size : float
///     Side of the square in m.
/// pixels : int, optional
///     Samples along each side.
/// center : (float, float), optional
///     Middle in m, across and up: (x, y) for axis "z", (x, z) for "y", (y, z) for "x".
/// axis : str, optional
///     Axis that the plane is normal to: "z", "y" or "x".
/// at : float, optional
///     Place along that axis in m.
///
/// Raises
/// ------
/// SceneError
///     For a plane without a place, and a wrong size, pixels, center or axis.
///
/// Examples
/// --------
/// >>> import midair
/// >>> float(midair.Plane(z=0.15, size=0.1, pixels=3).x[0])
/// -0.05
/// >>> upright = midair.Plane(axis="y", at=0, size=0.1, pixels=3, center=(0, 0.1))
/// >>> float(upright.along("z")[0])
/// 0.05
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone, PartialEq)]
pub(crate) struct Plane {
    pub(crate) inner: midair::Plane,
}

hashed!(Plane: self => (bits(self.inner.at), bits(self.inner.size), self.inner.pixels));

#[pymethods]
impl Plane {
    #[staticmethod]
    #[pyo3(
        name = "_new",
        signature = (z=None, size=None, pixels=None, center=None, *, axis=None, at=None),
        text_signature = "(z=None, size=None, pixels=200, center=(0, 0), *, axis='z', at=None)"
    )]
    fn new(
        py: Python<'_>,
        z: Argument<'_, '_>,
        size: Argument<'_, '_>,
        pixels: Argument<'_, '_>,
        center: Argument<'_, '_>,
        axis: Argument<'_, '_>,
        at: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let axis = axis.map_or(Ok(Axis::Z), read_axis)?;
        let pixels = pixels.map_or(Ok(200), |pixels| read::count("plane.pixels", pixels))?;
        let center = match center {
            None => [0.0, 0.0],
            Some(center) => {
                let [across, up] = read::pair("plane.center", center, "give two real numbers, across and up")?;
                [read::real("plane.center[0]", &across)?, read::real("plane.center[1]", &up)?]
            }
        };
        let number = |item: &str, value: Argument<'_, '_>| value.map(|value| read::real(item, value)).transpose();
        let place = midair::Plane::place(axis, number("plane.z", z)?, number("plane.at", at)?).map_err(refused)?;
        let place = match (place, axis) {
            (Some(place), _) => place,
            (None, Axis::Z) => return Err(invalid("plane.z", "left out", "give the plane's height in m")),
            // By default, planes normal to x or y pass through the array's axis.
            (None, _) => 0.0,
        };
        let size = number("plane.size", size)?;
        let size = size.ok_or_else(|| invalid("plane.size", "left out", "give the plane's side in m"))?;
        let inner = midair::Plane::normal_to(axis, place, size, pixels, center).map_err(refused)?;
        warn_all(py, inner.doubt())?;
        Ok(Self { inner })
    }

    /// Return the samples along an axis.
    ///
    /// Parameters
    /// ----------
    /// axis : str
    ///     The axis: "x", "y" or "z".
    ///
    /// Returns
    /// -------
    /// (pixels,) ndarray or None
    ///     The samples in m; None for the normal of the plane.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     If the axis is none of these.
    fn along<'py>(&self, py: Python<'py>, axis: &Bound<'py, PyAny>) -> PyResult<Samples<'py>> {
        Ok(self.samples(py, read_axis(axis)?))
    }

    #[staticmethod]
    fn _restore(axis: &str, at: f64, size: f64, pixels: usize, center: [f64; 2]) -> PyResult<Self> {
        let axis = Axis::named(axis).map_err(refused)?;
        Ok(Self { inner: midair::Plane::normal_to(axis, at, size, pixels, center).map_err(refused)? })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let midair::Plane { axis, at, size, pixels, center } = self.inner;
        restored::<Self>(py, (axis.to_string(), at, size, pixels, center))
    }

    fn __repr__(&self) -> String {
        self.inner.to_string()
    }
}

getters! {
    Plane:

    /// The normal axis: "x", "y" or "z".
    axis(self) -> String = self.inner.axis.to_string();

    /// Place of the plane along its normal axis in m.
    at(self) -> f64 = self.inner.at;

    /// Height in m, or None for a plane normal to x or y.
    z(self) -> Option<f64> = (self.inner.axis == Axis::Z).then_some(self.inner.at);

    /// Side of the square in m.
    size(self) -> f64 = self.inner.size;

    /// Samples along each side.
    pixels(self) -> usize = self.inner.pixels;

    /// Centre in m, across and up: (x, y), (x, z) or (y, z).
    center(self) -> (f64, f64) = (self.inner.center[0], self.inner.center[1]);

    /// Samples along x (pixels,) in m, or None for a plane normal to x.
    x(self, py) -> Samples<'py> = self.samples(py, Axis::X);

    /// Samples along y (pixels,) in m, or None for a plane normal to y.
    y(self, py) -> Samples<'py> = self.samples(py, Axis::Y);
}

pub(crate) type Samples<'py> = Option<Array1<'py, f64>>;

impl Plane {
    pub(crate) fn samples<'py>(&self, py: Python<'py>, axis: Axis) -> Samples<'py> {
        self.inner.along(axis).map(|samples| give::list(py, samples))
    }
}

fn read_axis(axis: &Bound<'_, PyAny>) -> PyResult<Axis> {
    Axis::named(&read::text("axis", axis, "give \"x\", \"y\" or \"z\"")?).map_err(refused)
}
