//! `midair.Wall`, and `obstacles=` as Python gives and shows it.

use std::hash::{Hash, Hasher};

use midair::{Obstacle, OptionValue, Surface, Value};
use pyo3::prelude::*;

use crate::error::{invalid, refused};
use crate::numbers::quoted;
use crate::pickle::{Reduced, restored};
use crate::read;

/// A plane without end that sends waves back, of a scene's `obstacles`: through point (3,) in m, facing along normal (3,).
///
/// Sound is on the array's side, whichever way the normal points; it tells the side only of a wall that the array lies in.
/// kind is "rigid" (a solid: on it |p| doubles) or "soft" (it gives way: on it p = 0). Its name is not Plane, which is the
/// plane of a picture.
///
/// >>> import midair
/// >>> table = midair.Wall([0, 0, 0.2], [0, 0, -1])
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]], obstacles=[table])
/// >>> scene.obstacles
/// [Wall(point=(0.0, 0.0, 0.2), normal=(0.0, 0.0, -1.0), kind="rigid")]
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone, PartialEq)]
pub(crate) struct Wall {
    point: [f64; 3],
    normal: [f64; 3],
    kind: Surface,
}

impl Hash for Wall {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // 0 and -0 are equal.
        [self.point, self.normal].map(|place| place.map(|x| (x + 0.0).to_bits())).hash(state);
    }
}

#[pymethods]
impl Wall {
    #[new]
    #[pyo3(signature = (point, normal, kind="rigid"))]
    fn new(point: &Bound<'_, PyAny>, normal: &Bound<'_, PyAny>, kind: &str) -> PyResult<Self> {
        let kind = Surface::read("wall.kind", &Value::Text(kind.into())).map_err(refused)?;
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
        Ok(Self { point, normal, kind: Surface::read("kind", &Value::Text(kind.into())).map_err(refused)? })
    }

    fn __repr__(&self) -> String {
        let [point, normal] = [self.point, self.normal].map(|[x, y, z]| format!("({x:?}, {y:?}, {z:?})"));
        format!("Wall(point={point}, normal={normal}, kind=\"{}\")", self.kind.name())
    }
}

/// Obstacles (K,), or none.
pub(crate) fn read_obstacles(value: &Bound<'_, PyAny>) -> PyResult<Vec<Obstacle>> {
    let cure = "give a list of midair.Wall";
    if value.is_none() {
        return Ok(Vec::new());
    }
    let all = value.try_iter().map_err(|_| invalid("obstacles", &quoted(value), cure))?;
    let one = |(k, item): (usize, PyResult<Bound<'_, PyAny>>)| {
        let item = item?;
        match item.cast::<Wall>() {
            Ok(wall) => {
                let Wall { point, normal, kind } = *wall.get();
                Ok(Obstacle::Wall { point, normal, kind })
            }
            Err(_) => Err(invalid(&format!("obstacles[{k}]"), &quoted(&item), cure)),
        }
    };
    all.enumerate().map(one).collect()
}

/// Obstacles as they were given.
pub(crate) fn shown_obstacles<'py>(py: Python<'py>, obstacles: &[Obstacle]) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let one = |obstacle: &Obstacle| match *obstacle {
        Obstacle::Wall { point, normal, kind } => Ok(Bound::new(py, Wall { point, normal, kind })?.into_any()),
        _ => Err(invalid("obstacles", "of an unknown kind", "install one version of midair")),
    };
    obstacles.iter().map(one).collect()
}
