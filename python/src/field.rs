//! `midair.Plane`, `midair.field`, `midair.Field` and `midair.judge`.

use std::ops::ControlFlow;
use std::sync::Arc;

use midair::{Complex32, Control, Progress};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;

use crate::array::rows;
use crate::pulse::Pulse;
use crate::scene::Scene;
use crate::solve::Metrics;
use crate::task::Task;
use crate::{invalid, read, refused};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// A square of pixels x pixels samples at height z, side size (all in m), around center (x, y).
///
/// >>> import midair
/// >>> float(midair.Plane(z=0.15, size=0.1, pixels=3).x[0])
/// -0.05
#[pyclass(frozen, eq, module = "midair")]
#[derive(Clone, PartialEq)]
pub(crate) struct Plane {
    pub(crate) inner: midair::Plane,
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
                    center.try_iter().and_then(Iterator::collect).unwrap_or_default();
                let [x, y] = &pair[..] else {
                    return Err(invalid(
                        "plane.center",
                        &center.to_string(),
                        "give two real numbers, x and y",
                    ));
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
    fn x<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.axis(0).into_pyarray(py)
    }

    /// Samples along y (pixels,) in m.
    #[getter]
    fn y<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.axis(1).into_pyarray(py)
    }

    fn __repr__(&self) -> String {
        let midair::Plane { z, size, pixels, center: [x, y] } = self.inner;
        format!("Plane(z={z}, size={size}, pixels={pixels}, center=({x}, {y}))")
    }
}

/// The field of a drive on a plane or at points.
#[pyclass(frozen, module = "midair")]
pub(crate) struct Field {
    scene: Arc<midair::Scene>,
    places: Places,
    pressure: Vec<Complex32>,
}

enum Places {
    Plane(midair::Plane),
    Points(Vec<[f64; 3]>),
}

impl Field {
    fn shape(&self) -> Vec<usize> {
        match &self.places {
            Places::Plane(plane) => vec![plane.pixels, plane.pixels],
            Places::Points(points) => vec![points.len()],
        }
    }
}

#[pymethods]
impl Field {
    /// Complex pressure in Pa (peak): (pixels, pixels), indexed [y, x], or (P,).
    #[getter]
    fn pressure<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<Complex32>>> {
        self.pressure.to_pyarray(py).reshape(self.shape())
    }

    /// Radiation pressure in Pa on a wall at normal incidence, |p|^2/(rho c^2), of the same shape.
    #[getter]
    fn radiation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let medium = self.scene.medium();
        let modulus = |p: &Complex32| f64::from(p.re).hypot(f64::from(p.im));
        let radiation: Vec<f64> = self.pressure.iter().map(|p| medium.radiation(modulus(p))).collect();
        radiation.into_pyarray(py).reshape(self.shape())
    }

    /// Samples along x (pixels,) in m, or None for points.
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.plane().map(|plane| plane.x(py))
    }

    /// Samples along y (pixels,) in m, or None for points.
    #[getter]
    fn y<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.plane().map(|plane| plane.y(py))
    }

    /// The plane, or None for points.
    #[getter]
    fn plane(&self) -> Option<Plane> {
        match self.places {
            Places::Plane(inner) => Some(Plane { inner }),
            Places::Points(_) => None,
        }
    }

    /// The points (P, 3) in m, or None for a plane.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        match &self.places {
            Places::Plane(_) => Ok(None),
            Places::Points(points) => rows(py, points).map(Some),
        }
    }

    /// The scene it belongs to.
    #[getter]
    fn scene(&self) -> Scene {
        Scene { inner: Arc::clone(&self.scene) }
    }

    fn __repr__(&self) -> String {
        format!("<midair.Field of {} samples>", self.pressure.len())
    }
}

/// The field of a drive (N,) on a plane, or at points (P, 3) in m: p = G q.
///
/// Left out, the plane is the scene's own, else one around its points.
#[pyfunction]
#[pyo3(signature = (scene, drive, plane=None))]
pub(crate) fn field(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    drive: &Bound<'_, PyAny>,
    plane: Argument<'_, '_>,
) -> PyResult<Field> {
    let drive = read::drive("drive", drive)?;
    let scene = Arc::clone(&scene.get().inner);
    let places = match plane {
        None => Places::Plane(scene.picture_plane()),
        Some(plane) => match plane.cast::<Plane>() {
            Ok(plane) => Places::Plane(plane.get().inner),
            Err(_) => Places::Points(read::vectors("field points", plane)?),
        },
    };
    let mut pulse = Pulse::new(None);
    let pressure = py.detach(|| {
        let grid;
        let points = match &places {
            Places::Plane(plane) => {
                grid = plane.points();
                &grid
            }
            Places::Points(points) => points,
        };
        let mut observer = |progress: Progress<'_>| -> ControlFlow<()> { pulse.beat(&progress) };
        midair::field(&scene, &drive, points, &mut Control::watched(&mut observer))
    });
    pulse.raised()?;
    let pressure = pressure.map_err(refused)?.unwrap_or_default();
    Ok(Field { scene, places, pressure })
}

/// An upper bound on the level min |p| / target over the points with a pressure: no drive, quantised or not, exceeds it.
///
/// It is the value of a semidefinite relaxation and lies some 8 to 9 % above the best field known. At most 64 points.
/// Pressures and weights go with Propagation only.
///
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
/// >>> level = midair.solve(scene, "wgs").metrics.level
/// >>> level < midair.bound(scene) < 1.12 * level
/// True
#[pyfunction]
#[pyo3(signature = (scene, *, pressures=None, weights=None))]
pub(crate) fn bound(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    pressures: Argument<'_, '_>,
    weights: Argument<'_, '_>,
) -> PyResult<f64> {
    let task = Task::read(scene, pressures, weights)?;
    let level = crate::level::level()?;
    py.detach(|| midair::bound(&task.problem(level)?)).map_err(refused)
}

/// The metrics of a drive (N,), wholly in double precision. Pressures and weights go with Propagation only.
#[pyfunction]
#[pyo3(signature = (scene, drive, *, pressures=None, weights=None))]
pub(crate) fn judge(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    drive: &Bound<'_, PyAny>,
    pressures: Argument<'_, '_>,
    weights: Argument<'_, '_>,
) -> PyResult<Metrics> {
    let task = Task::read(scene, pressures, weights)?;
    let drive = read::drive("drive", drive)?;
    let level = crate::level::level()?;
    let metrics = py.detach(|| task.problem(level)?.judge(&drive)).map_err(refused)?;
    Ok(metrics.into())
}
