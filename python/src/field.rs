//! `midair.field` and `midair.Field`.

use std::sync::Arc;

use midair::Complex32;
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;

use crate::ctrl_c::attend;
use crate::give::{self, rows};
use crate::instruction_set::instruction_set;
use crate::limits;
use crate::pickle::{Reduced, restored};
use crate::plane::Plane;
use crate::read;
use crate::scene::Scene;

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// The field of a drive on a plane or at points.
#[pyclass(frozen, eq, module = "midair")]
#[derive(PartialEq)]
pub(crate) struct Field {
    scene: Arc<midair::Scene>,
    places: Places,
    pressure: Vec<Complex32>,
}

#[derive(PartialEq)]
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
        give::list(py, self.pressure.clone()).reshape(self.shape())
    }

    /// Radiation pressure in Pa on a wall at normal incidence, |p|^2/(rho c^2), of the same shape.
    #[getter]
    fn radiation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let medium = self.scene.medium();
        let modulus = |p: &Complex32| f64::from(p.re).hypot(f64::from(p.im));
        let radiation: Vec<f64> = self.pressure.iter().map(|p| medium.radiation(modulus(p))).collect();
        give::list(py, radiation).reshape(self.shape())
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

    #[staticmethod]
    fn _restore(scene: &Bound<'_, Scene>, places: &Bound<'_, PyAny>, pressure: &Bound<'_, PyAny>) -> PyResult<Self> {
        let places = match places.cast::<Plane>() {
            Ok(plane) => Places::Plane(plane.get().inner),
            Err(_) => Places::Points(read::vectors("field points", places)?),
        };
        let pressure = read::drive("pressure", &pressure.call_method0("ravel")?)?;
        Ok(Self { scene: Arc::clone(&scene.get().inner), places, pressure })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let places = match self.plane() {
            Some(plane) => Bound::new(py, plane)?.into_any(),
            None => self.points(py)?.into_pyobject(py)?.into_any(),
        };
        restored::<Self>(py, (self.scene(), places, self.pressure(py)?))
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
    let model = midair::Model::of(&scene, instruction_set()?);
    let threads = limits::threads(py)?;
    let pressure = attend(py, None, |control| {
        let grid;
        let points = match &places {
            Places::Plane(plane) => {
                grid = plane.points();
                &grid
            }
            Places::Points(points) => points,
        };
        midair::field(&model, &drive, points, &mut control.on(threads))
    })?;
    Ok(Field { scene, places, pressure })
}
