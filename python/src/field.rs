//! `midair.field` and `midair.Field`.

use midair::Axis;
use numpy::PyArrayDyn;

use crate::error::warn;
use crate::give::rows;
use crate::plane::{self, Plane};
use crate::prelude::*;
use crate::scene::Scene;
use crate::solution::{Solution, about, played};

/// Field of a drive on a plane or at points; from `midair.field`.
///
/// Examples
/// --------
/// >>> import midair
/// >>> solution = midair.solve(midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]]))
/// >>> field = midair.field(solution, midair.Plane(z=0.15, size=0.1, pixels=11))
/// >>> field.pressure.shape, bool(abs(field.pressure).argmax() == 60)
/// ((11, 11), True)
#[pyclass(frozen, eq, module = "midair")]
pub(crate) struct Field {
    scene: Scene,
    solution: Option<Py<Solution>>,
    picture: Picture,
    /// Further planes, if one plane does not contain all points.
    others: Vec<Picture>,
}

impl PartialEq for Field {
    fn eq(&self, other: &Self) -> bool {
        let solutions = [self, other].map(|field| field.solution.as_ref().map(Py::get));
        let pictures = self.picture == other.picture && self.others == other.others;
        pictures && self.scene == other.scene && solutions[0] == solutions[1]
    }
}

/// Pressures and the places where they were computed.
#[derive(Clone, PartialEq)]
struct Picture {
    places: Places,
    pressure: Arc<[Complex32]>,
}

#[derive(Clone, PartialEq)]
enum Places {
    Plane(midair::Plane),
    Points(Arc<[[f64; 3]]>),
}

impl Field {
    fn shape(&self) -> Vec<usize> {
        match &self.picture.places {
            Places::Plane(plane) => vec![plane.pixels, plane.pixels],
            Places::Points(points) => vec![points.len()],
        }
    }

    fn samples<'py>(&self, py: Python<'py>, axis: Axis) -> plane::Samples<'py> {
        self.plane().and_then(|plane| plane.samples(py, axis))
    }
}

#[pymethods]
impl Field {
    /// Radiation pressure in Pa on a wall at normal incidence, |p|^2/(rho c^2), of the same shape.
    #[getter]
    fn radiation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let medium = self.scene.inner.medium();
        let modulus = |p: &Complex32| f64::from(p.re).hypot(f64::from(p.im));
        let radiation: Vec<f64> = self.picture.pressure.iter().map(|p| medium.radiation(modulus(p))).collect();
        give::list(py, radiation).reshape(self.shape())
    }

    /// The plane, or None for points.
    #[getter]
    fn plane(&self) -> Option<Plane> {
        match self.picture.places {
            Places::Plane(inner) => Some(Plane { inner }),
            Places::Points(_) => None,
        }
    }

    /// The points (P, 3) in m, or None for a plane.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Option<Array2<'py, f64>>> {
        match &self.picture.places {
            Places::Plane(_) => Ok(None),
            Places::Points(points) => rows(py, points).map(Some),
        }
    }

    /// Which of the scene's points (M,) lie in the plane, within a tenth of the wavelength, or None for points.
    #[getter]
    fn shown<'py>(&self, py: Python<'py>) -> Option<Array1<'py, bool>> {
        let Places::Plane(plane) = self.picture.places else { return None };
        let wavelength = self.scene.inner.medium().wavelength();
        let flags: Vec<bool> = self.scene.inner.points().iter().map(|&point| plane.shows(point, wavelength)).collect();
        Some(give::list(py, flags))
    }

    /// Field in each plane that is necessary to show the scene's points, at most four, and its bodies.
    ///
    /// This field comes first, and is the only one if its plane was given. Each trap has two planes.
    #[getter]
    fn panels(&self, py: Python<'_>) -> Vec<Self> {
        let panel = |picture: &Picture| Self {
            scene: self.scene.clone(),
            solution: self.solution.as_ref().map(|solution| solution.clone_ref(py)),
            picture: picture.clone(),
            others: Vec::new(),
        };
        [&self.picture].into_iter().chain(&self.others).map(panel).collect()
    }

    #[staticmethod]
    fn _restore(
        scene: &Bound<'_, Scene>,
        solution: Option<Py<Solution>>,
        pictures: Vec<(Bound<'_, PyAny>, Bound<'_, PyAny>)>,
    ) -> PyResult<Self> {
        let picture = |(places, pressure): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            let places = match places.cast::<Plane>() {
                Ok(plane) => Places::Plane(plane.get().inner),
                Err(_) => Places::Points(read::vectors("field points", &places)?.into()),
            };
            Ok(Picture { places, pressure: read::drive("pressure", &pressure)?.into() })
        };
        let mut others = pictures.into_iter().map(picture).collect::<PyResult<Vec<_>>>()?;
        if others.is_empty() {
            return Err(invalid("pictures", "[]", "give at least one"));
        }
        let picture = others.remove(0);
        Ok(Self { scene: scene.get().clone(), solution, picture, others })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let reported = |picture: &Picture| -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
            let places = match &picture.places {
                Places::Plane(inner) => Bound::new(py, Plane { inner: *inner })?.into_any(),
                Places::Points(points) => rows(py, points)?.into_any(),
            };
            Ok((places, give::list(py, picture.pressure.to_vec()).into_any()))
        };
        let pictures = std::iter::once(&self.picture).chain(&self.others).map(reported);
        restored::<Self>(py, (self.scene(), self.solution(py), pictures.collect::<PyResult<Vec<_>>>()?))
    }

    fn __repr__(&self) -> String {
        format!("<midair.Field of {} samples>", self.picture.pressure.len())
    }
}

getters! {
    Field:

    /// Complex pressure in Pa (peak): (P,) at points; in a plane (pixels, pixels), indexed [up, across], such as [y, x].
    pressure(self, py) -> PyResult<Bound<'py, PyArrayDyn<Complex32>>> =
        give::list(py, self.picture.pressure.to_vec()).reshape(self.shape());

    /// Samples along x (pixels,) in m, or None for points and for a plane normal to x.
    x(self, py) -> plane::Samples<'py> = self.samples(py, Axis::X);

    /// Samples along y (pixels,) in m, or None for points and for a plane normal to y.
    y(self, py) -> plane::Samples<'py> = self.samples(py, Axis::Y);

    /// Samples along z (pixels,) in m of a plane normal to x or y, else None.
    z(self, py) -> plane::Samples<'py> = self.samples(py, Axis::Z);

    /// The scene.
    scene(self) -> Scene = self.scene.clone();

    /// The solution, or None for a drive that was given alone.
    solution(self, py) -> Option<Py<Solution>> = self.solution.as_ref().map(|solution| solution.clone_ref(py));

    /// Factor for supply or modulation, already applied: the solution's scale, or 1 for a drive that was given alone.
    scale(self) -> f64 = self.solution.as_ref().map_or(1.0, |solution| solution.get().inner.scale);
}

/// Compute the field p = G q of a drive on a plane or at points; inside an obstacle it is 0.
///
/// Parameters
/// ----------
/// scene : midair.Scene or midair.Solution
///     A solution alone gives its scene and its drive: `midair.field(solution, plane)`, or `solution.field(plane)`.
/// drive : (N,) array_like or midair.Solution, optional
///     A complex drive, or a solution, whose scale is applied.
/// plane : midair.Plane or (P, 3) array_like, optional
///     A plane, or points in m. By default the scene's own plane, else one through its points: normal to z, y or x, and
///     several if they do not lie in one (`panels`).
///
/// Returns
/// -------
/// midair.Field
///     Complex pressure in Pa and radiation pressure.
///
/// Raises
/// ------
/// SceneError
///     For a drive or points of another shape or not finite.
/// TypeError
///     If `scene` has another type.
/// MemoryError
///     For more than MIDAIR_MEMORY allows.
///
/// Warns
/// -----
/// SceneWarning
///     For a given plane that contains no point, and for points that are far from the array.
///
/// Notes
/// -----
/// Eq. (5) of Suzuki et al., IEEE Trans. Haptics 14, 914 (2021). Traps have two upright planes each, because a trap is
/// a node; a body that no plane cuts has one more.
///
/// Examples
/// --------
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]])
/// >>> solution = midair.solve(scene)
/// >>> pressure = midair.field(scene, solution.drive, [[0, 0, 0.15]]).pressure
/// >>> bool(abs(pressure - solution.pressures).max() < 1e-3)
/// True
#[pyfunction]
#[pyo3(signature = (scene, drive=None, plane=None))]
pub(crate) fn field<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    drive: Option<Bound<'py, PyAny>>,
    plane: Option<Bound<'py, PyAny>>,
) -> PyResult<Field> {
    let (scene, drive, plane) = about(scene, drive, plane)?;
    let solution = drive.cast::<Solution>().ok().map(|solution| solution.clone().unbind());
    let drive = played(&drive)?;
    let (inner, model) = (&scene.get().inner, scene.get().model());
    let places: Vec<Places> = match plane {
        None => inner.picture_planes().into_iter().map(Places::Plane).collect(),
        Some(plane) => match plane.cast::<Plane>() {
            Ok(plane) => vec![Places::Plane(plane.get().inner)],
            Err(_) => vec![Places::Points(read::vectors("field points", &plane)?.into())],
        },
    };
    if let Some(Places::Plane(plane)) = places.first()
        && !inner.is_shown(plane)
    {
        let better = inner.planes_around()[0].rounded();
        warn(py, format!("no point lies in {plane}: leave it out, or give one through the points, {better}"))?;
    }
    let doubt = match places.first() {
        Some(Places::Points(points)) => inner.doubt_places(points, |k| format!("field points[{k}]")),
        _ => None,
    };
    let mut others = attend(py, None, |mut control| {
        let mut sample = |places: Places| {
            let pressure = match &places {
                Places::Plane(plane) => midair::field(&model, &drive, &plane.points(), &mut control),
                Places::Points(points) => midair::field(&model, &drive, points, &mut control),
            };
            Ok(Picture { places, pressure: pressure?.into() })
        };
        places.into_iter().map(&mut sample).collect::<Result<Vec<_>, _>>()
    })?;
    warn_all(py, doubt)?;
    let picture = others.remove(0);
    Ok(Field { scene: scene.get().clone(), solution, picture, others })
}
