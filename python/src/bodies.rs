//! `midair.Wall` and `midair.Sphere`: obstacles of a few numbers.

use std::hash::{Hash, Hasher};

use midair::{OptionValue, Surface, Value};
use pyo3::prelude::*;

use crate::error::refused;
use crate::pickle::{Reduced, restored};
use crate::read;

/// A plane without end that sends waves back, of a scene's `obstacles`: through point (3,) in m, facing along normal (3,).
///
/// Sound is on the array's side, whichever way the normal points; it tells the side only of a wall that the array lies in.
/// kind is "rigid" (a solid: on it |p| doubles) or "soft" (it gives way: on it p = 0). Its name is not Plane, which is the
/// plane of a picture.
///
/// Raises SceneError for a place that is no place or another kind; for a normal of no length when a scene takes it.
///
/// >>> import midair
/// >>> table = midair.Wall([0, 0, 0.2], [0, 0, -1])
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]], obstacles=[table])
/// >>> scene.obstacles
/// [Wall(point=(0.0, 0.0, 0.2), normal=(0.0, 0.0, -1.0), kind="rigid")]
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone, PartialEq)]
pub(crate) struct Wall {
    pub(crate) point: [f64; 3],
    pub(crate) normal: [f64; 3],
    pub(crate) kind: Surface,
}

impl Hash for Wall {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // 0 and -0 are equal.
        [self.point, self.normal].map(|place| place.map(|x| (x + 0.0).to_bits())).hash(state);
    }
}

#[pymethods]
impl Wall {
    #[staticmethod]
    #[pyo3(name = "_new", signature = (point, normal, kind="rigid"))]
    fn new(point: &Bound<'_, PyAny>, normal: &Bound<'_, PyAny>, kind: &str) -> PyResult<Self> {
        let kind = surface("wall.kind", kind)?;
        Ok(Self { point: read::place("wall.point", point)?, normal: read::place("wall.normal", normal)?, kind })
    }

    /// Any point of it (x, y, z) in m.
    #[getter]
    fn point(&self) -> (f64, f64, f64) {
        self.point.into()
    }

    /// The direction that it faces (x, y, z), as given.
    #[getter]
    fn normal(&self) -> (f64, f64, f64) {
        self.normal.into()
    }

    /// "rigid" or "soft".
    #[getter]
    fn kind(&self) -> &'static str {
        self.kind.name()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        restored::<Self>(py, (self.point, self.normal, self.kind.name()))
    }

    #[staticmethod]
    fn _restore(point: [f64; 3], normal: [f64; 3], kind: &str) -> PyResult<Self> {
        Ok(Self { point, normal, kind: surface("kind", kind)? })
    }

    fn __repr__(&self) -> String {
        let [point, normal] = [self.point, self.normal].map(|[x, y, z]| format!("({x:?}, {y:?}, {z:?})"));
        format!("Wall(point={point}, normal={normal}, kind=\"{}\")", self.kind.name())
    }
}

/// A sphere that waves go around, the only one of a scene's `obstacles`: center (3,) and radius in m, up to 12 wavelengths.
///
/// kind is "rigid" (a solid) or "soft" (it gives way, p = 0). What it sends on is exact, by its series.
///
/// Raises SceneError for a center that is no place or another kind; for its size, and points inside, when a scene takes
/// it.
///
/// >>> import midair
/// >>> ball = midair.Sphere([0, 0, 0.1], 0.02)
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]], obstacles=[ball])
/// >>> scene.obstacles
/// [Sphere(center=(0.0, 0.0, 0.1), radius=0.02, kind="rigid")]
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone, PartialEq)]
pub(crate) struct Sphere {
    pub(crate) center: [f64; 3],
    pub(crate) radius: f64,
    pub(crate) kind: Surface,
}

impl Hash for Sphere {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // 0 and -0 are equal.
        (self.center.map(|x| (x + 0.0).to_bits()), self.radius.to_bits()).hash(state);
    }
}

#[pymethods]
impl Sphere {
    #[staticmethod]
    #[pyo3(name = "_new", signature = (center, radius, kind="rigid"))]
    fn new(center: &Bound<'_, PyAny>, radius: &Bound<'_, PyAny>, kind: &str) -> PyResult<Self> {
        let kind = surface("sphere.kind", kind)?;
        Ok(Self { center: read::place("sphere.center", center)?, radius: read::real("sphere.radius", radius)?, kind })
    }

    /// Its middle (x, y, z) in m.
    #[getter]
    fn center(&self) -> (f64, f64, f64) {
        self.center.into()
    }

    /// Its radius in m.
    #[getter]
    fn radius(&self) -> f64 {
        self.radius
    }

    /// "rigid" or "soft".
    #[getter]
    fn kind(&self) -> &'static str {
        self.kind.name()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        restored::<Self>(py, (self.center, self.radius, self.kind.name()))
    }

    #[staticmethod]
    fn _restore(center: [f64; 3], radius: f64, kind: &str) -> PyResult<Self> {
        Ok(Self { center, radius, kind: surface("kind", kind)? })
    }

    fn __repr__(&self) -> String {
        let [x, y, z] = self.center;
        format!("Sphere(center=({x:?}, {y:?}, {z:?}), radius={:?}, kind=\"{}\")", self.radius, self.kind.name())
    }
}

/// What a surface does, by its name.
pub(crate) fn surface(item: &str, kind: &str) -> PyResult<Surface> {
    Surface::read(item, &Value::Text(kind.into())).map_err(refused)
}
