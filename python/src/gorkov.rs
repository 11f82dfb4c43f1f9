//! `midair.gorkov` and `midair.Gorkov`.

use midair::Particle;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use crate::ctrl_c::attend;
use crate::error::warn_all;
use crate::getters::getters;
use crate::give::{self, rows};
use crate::limits;
use crate::pickle::{Reduced, restored};
use crate::read;
use crate::solution::{Solution, about, played};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// What a small sphere feels at some points (P,).
#[pyclass(frozen, eq, module = "midair")]
#[derive(PartialEq)]
pub(crate) struct Gorkov {
    potential: Vec<f64>,
    force: Vec<[f64; 3]>,
    hessian: Vec<[[f64; 3]; 3]>,
}

#[pymethods]
impl Gorkov {
    /// Stiffness -dF_x/dx, -dF_y/dy, -dF_z/dz (P, 3) in N/m: above 0 where the force pulls back.
    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let diagonal = |hessian: &[[f64; 3]; 3]| [0, 1, 2].map(|axis| hessian[axis][axis]);
        rows(py, &self.hessian.iter().map(diagonal).collect::<Vec<_>>())
    }

    #[staticmethod]
    fn _restore(potential: Vec<f64>, force: Vec<[f64; 3]>, hessian: Vec<[[f64; 3]; 3]>) -> Self {
        Self { potential, force, hessian }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        restored::<Self>(py, (&self.potential, &self.force, &self.hessian))
    }

    fn __len__(&self) -> usize {
        self.potential.len()
    }

    fn __repr__(&self) -> String {
        let least = self.hessian.iter().flat_map(|h| [h[0][0], h[1][1], h[2][2]]).fold(f64::INFINITY, f64::min);
        format!("<midair.Gorkov at {} points: stiffness at least {least:.4} N/m>", self.potential.len())
    }
}

getters! {
    Gorkov:

    /// Gor'kov potential U (P,) in J.
    potential(self, py) -> Bound<'py, PyArray1<f64>> = give::list(py, self.potential.clone());

    /// Force -grad U (P, 3) in N, without gravity.
    force(self, py) -> PyResult<Bound<'py, PyArray2<f64>>> = rows(py, &self.force);

    /// All second derivatives of U (P, 3, 3) in N/m, whose diagonal is the stiffness.
    hessian(self, py) -> PyResult<Bound<'py, PyArray3<f64>>> =
        give::list(py, self.hessian.as_flattened().as_flattened().to_vec()).reshape([self.hessian.len(), 3, 3]);
}

/// Gor'kov potential, force and stiffness of a small sphere in the field of a drive (N,), or of a Solution with its scale
/// counted in, at points (P, 3) in m; left out they are the scene's.
///
/// A Solution alone stands for its scene and its drive: `midair.gorkov(solution, points)`, or `solution.gorkov(points)`.
///
/// radius in m, density in kg/m^3 and sound_speed in m/s are the sphere's; left out it is a bead of expanded polystyrene,
/// 1e-3, 29 (Marzo et al., Nature Communications 6, 8661, 2015) and 900. The field is the real one, without the scene's
/// signature, in its air. U = V [f1 <p^2>/(2 rho c^2) - 3/4 f2 rho <v^2>] after Bruus, Lab on a Chip 12, 1014 (2012), which
/// is for spheres small beside the wavelength, without viscosity, gravity and the push of waves that run. Derivatives are
/// exact, in double precision.
///
/// Raises SceneError for a drive or points of another shape or not finite, a sphere's value that is not above 0, and a
/// scene with obstacles other than walls.
///
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.grid(16, 16, 10.5e-3), [[0, 0, 0.08]], signature="trap")
/// >>> trap = midair.gorkov(scene, midair.solve(scene))
/// >>> bool((trap.stiffness > 0).all())
/// True
#[pyfunction]
#[pyo3(signature = (scene, drive=None, points=None, *, radius=None, density=None, sound_speed=None))]
pub(crate) fn gorkov<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    drive: Option<Bound<'py, PyAny>>,
    points: Option<Bound<'py, PyAny>>,
    radius: Argument<'_, '_>,
    density: Argument<'_, '_>,
    sound_speed: Argument<'_, '_>,
) -> PyResult<Gorkov> {
    let (scene, drive, points) = about(scene, drive, points)?;
    let (inner, model) = (&scene.get().inner, scene.get().model());
    let drive = played(&drive)?;
    let points = points.map(|points| read::vectors("points", &points)).transpose()?;
    let points = points.as_deref().unwrap_or(inner.points());
    let default = Particle::default();
    let particle = Particle {
        radius: read::real_or("radius", radius, default.radius)?,
        density: read::real_or("density", density, default.density)?,
        sound_speed: read::real_or("sound_speed", sound_speed, default.sound_speed)?,
    };
    let threads = limits::threads(py)?;
    let felt = attend(py, None, |control| midair::gorkov(&model, &drive, points, particle, &mut control.on(threads)))?;
    warn_all(py, particle.remark(inner.medium()))?;
    let midair::Gorkov { potential, force, hessian, .. } = felt;
    Ok(Gorkov { potential, force, hessian })
}

#[pymethods]
impl Solution {
    /// Potential, force and stiffness of a small sphere in its field: `midair.gorkov` of its scene and drive.
    ///
    /// Raises SceneError as `midair.gorkov`, and where it has no scene.
    #[pyo3(signature = (points=None, *, radius=None, density=None, sound_speed=None))]
    fn gorkov<'py>(
        slf: &Bound<'py, Self>,
        points: Option<Bound<'py, PyAny>>,
        radius: Argument<'_, 'py>,
        density: Argument<'_, 'py>,
        sound_speed: Argument<'_, 'py>,
    ) -> PyResult<Gorkov> {
        gorkov(slf.py(), slf, None, points, radius, density, sound_speed)
    }
}
