//! `midair.gorkov`, `midair.rest` and their results.

use midair::{Bead, Particle};

use crate::bead::read_bead;
use crate::give::{rows, threes};
use crate::prelude::*;
use crate::solution::{about, played};

/// Potential, force and stiffness of a small sphere at P points; from `midair.gorkov`.
///
/// Examples
/// --------
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.grid(16, 16, 10.5e-3), [[0, 0, 0.08]], signature="trap")
/// >>> trap = midair.solve(scene).gorkov()
/// >>> trap.force.shape, trap.hessian.shape
/// ((1, 3), (1, 3, 3))
#[pyclass(frozen, eq, module = "midair")]
#[derive(PartialEq)]
pub(crate) struct Gorkov {
    potential: Vec<f64>,
    force: Vec<[f64; 3]>,
    hessian: Vec<[[f64; 3]; 3]>,
    weight: [f64; 3],
    mass: f64,
}

pickled!(Gorkov: potential: Vec<f64>, force: Vec<[f64; 3]>, hessian: Vec<[[f64; 3]; 3]>, weight: [f64; 3], mass: f64);

#[pymethods]
impl Gorkov {
    /// Stiffness -dF_x/dx, -dF_y/dy, -dF_z/dz (P, 3) in N/m: above 0 where the force pulls back.
    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, f64>> {
        let diagonal = |hessian: &[[f64; 3]; 3]| [0, 1, 2].map(|axis| hessian[axis][axis]);
        rows(py, &self.hessian.iter().map(diagonal).collect::<Vec<_>>())
    }

    /// Net force (P, 3) in N: force plus weight minus buoyancy.
    #[getter]
    fn net<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, f64>> {
        let net = |force: &[f64; 3]| [0, 1, 2].map(|axis| force[axis] + self.weight[axis]);
        rows(py, &self.force.iter().map(net).collect::<Vec<_>>())
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

    /// Potential (P,) in J of the force without the push of travelling waves; Gor'kov's for small spheres.
    potential(self, py) -> Array1<'py, f64> = give::list(py, self.potential.clone());

    /// Weight minus buoyancy (3,) in N.
    weight(self, py) -> Array1<'py, f64> = give::list(py, self.weight.to_vec());

    /// Effective mass in kg: the sphere's own mass and half the mass of the air that it displaces.
    mass(self, _py) -> f64 = self.mass;

    /// Force of sound (P, 3) in N, without gravity.
    force(self, py) -> PyResult<Array2<'py, f64>> = rows(py, &self.force);

    /// Symmetric part of -dF_i/dx_a (P, 3, 3) in N/m, whose diagonal is the stiffness.
    hessian(self, py) -> PyResult<Array3<'py, f64>> = threes(py, &self.hessian);
}

/// Places of rest of beads that start at P points, and the forces that restore them; from `midair.rest`.
///
/// A bead that is not trapped has only `place`: its other values are NaN.
///
/// Examples
/// --------
/// >>> import midair
/// >>> boards = midair.Array.preset("openmpd_pair", quantization={})
/// >>> bead = midair.solve(midair.Scene(boards, [[0, 0, 0]], signature="trap")).rest()
/// >>> bead.place.shape, bool((bead.frequencies > 10).all())
/// ((1, 3), True)
#[pyclass(frozen, module = "midair")]
pub(crate) struct Rest {
    place: Vec<[f64; 3]>,
    held: Vec<bool>,
    stiffness: Vec<[f64; 3]>,
    axes: Vec<[[f64; 3]; 3]>,
    basin: Vec<[[f64; 2]; 3]>,
    restoring: Vec<[[f64; 2]; 3]>,
    mass: f64,
}

pickled!(Rest: place: Vec<[f64; 3]>, held: Vec<bool>, stiffness: Vec<[f64; 3]>, axes: Vec<[[f64; 3]; 3]>, basin: Vec<[[f64; 2]; 3]>, restoring: Vec<[[f64; 2]; 3]>, mass: f64);

#[pymethods]
impl Rest {
    /// Natural frequencies (P, 3) in Hz, sqrt(stiffness/mass)/(2 pi), the lowest first.
    #[getter]
    fn frequencies<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, f64>> {
        let frequency = |k: f64| (k / self.mass).sqrt() / std::f64::consts::TAU;
        rows(py, &self.stiffness.iter().map(|stiffness| stiffness.map(frequency)).collect::<Vec<_>>())
    }

    /// The largest acceleration (P, 3, 2) in m/s^2 with which a bead is pulled back: restoring/mass.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> PyResult<Array3<'py, f64>> {
        let over = |forces: &[[f64; 2]; 3]| forces.map(|ends| ends.map(|force| force / self.mass));
        threes(py, &self.restoring.iter().map(over).collect::<Vec<_>>())
    }

    fn __len__(&self) -> usize {
        self.place.len()
    }

    fn __repr__(&self) -> String {
        let count = self.held.iter().filter(|one| **one).count();
        format!("<midair.Rest: {count} of {} beads held>", self.held.len())
    }
}

getters! {
    Rest:

    /// Places (P, 3) in m where the net force is 0; or where an untrapped bead was lost.
    place(self, py) -> PyResult<Array2<'py, f64>> = rows(py, &self.place);

    /// Whether each bead is trapped (P,): the net force pulls it back from all sides, within a wavelength of the start.
    held(self, py) -> Array1<'py, bool> = give::list(py, self.held.clone());

    /// Stiffness (P, 3) in N/m along the axes, the smallest first: the eigenvalues of `hessian`.
    stiffness(self, py) -> PyResult<Array2<'py, f64>> = rows(py, &self.stiffness);

    /// Axes (P, 3, 3): three unit vectors as rows.
    axes(self, py) -> PyResult<Array3<'py, f64>> = threes(py, &self.axes);

    /// Range in m along each axis (P, 3, 2), in the negative and the positive direction, in which the net force pulls back;
    /// at most a wavelength.
    basin(self, py) -> PyResult<Array3<'py, f64>> = threes(py, &self.basin);

    /// Largest restoring force in N along each axis (P, 3, 2), in the negative and the positive direction.
    restoring(self, py) -> PyResult<Array3<'py, f64>> = threes(py, &self.restoring);

    /// Effective mass in kg: the bead's own mass and half the mass of the air that it displaces.
    mass(self, _py) -> f64 = self.mass;
}

/// Checked arguments of `gorkov` and `rest`.
struct Requested {
    model: Model,
    drive: Vec<Complex32>,
    points: Vec<[f64; 3]>,
    particle: Particle,
    gravity: [f64; 3],
    remark: Option<String>,
}

fn requested<'py>(
    scene: &Bound<'py, PyAny>,
    drive: Option<Bound<'py, PyAny>>,
    points: Option<Bound<'py, PyAny>>,
    bead: Argument<'_, 'py>,
) -> PyResult<Requested> {
    let (scene, drive, points) = about(scene, drive, points)?;
    let (inner, model) = (&scene.get().inner, scene.get().model());
    let drive = played(&drive)?;
    let points = points.map(|points| read::vectors("points", &points)).transpose()?;
    let points = points.unwrap_or_else(|| inner.points().to_vec());
    let Bead { particle, gravity } = bead.map_or_else(|| Ok(inner.bead()), read_bead)?;
    let remark = particle.remark(inner.medium());
    Ok(Requested { model, drive, points, particle, gravity, remark })
}

/// Compute the force of sound on a sphere in the field of a drive, its potential and stiffness.
///
/// Parameters
/// ----------
/// scene : midair.Scene or midair.Solution
///     A solution alone gives its scene and its drive: `midair.gorkov(solution, points)`, or `solution.gorkov(points)`.
/// drive : (N,) array_like or midair.Solution, optional
///     A complex drive, or a solution, whose scale is applied.
/// points : (P, 3) array_like, optional
///     Points in m; by default the scene's.
/// bead : midair.Bead or mapping, optional
///     The sphere, and gravity for `net` and `weight`; by default the scene's.
///
/// Returns
/// -------
/// midair.Gorkov
///     Potential, force, stiffness and weight at each point.
///
/// Raises
/// ------
/// SceneError
///     For a drive or points of another shape or not finite, a sphere's value that is not above 0 or a radius above
///     three wavelengths. For a point inside an obstacle or within a hundredth of a wavelength of a sphere or mesh. For
///     a large sphere whose surface is that near.
///
/// Notes
/// -----
/// The sphere is a fluid of its density and sound speed. F_i = Re[C0 p* p_i + C1 p_j* p_ij + C2 p_jk* p_ijk] with p_i =
/// dp/dx_i and coefficients from its partial waves up to the quadrupole (Sapozhnikov and Bailey, J. Acoust. Soc. Am. 133,
/// 661, 2013). This includes the push of travelling waves, and neglects viscosity. `potential` is that of the force without
/// this push; for small spheres it is Gor'kov's. The field is the real one, without the scene's signature, in its air and with
/// its obstacles. Derivatives are exact, in double precision; those of waves that spheres and meshes scatter are exact to
/// 1e-5.
///
/// From a radius of an eighth of the wavelength on, up to three, the force is that of all partial waves. Then `potential` is
/// NaN, and `hessian` and `stiffness` are finite differences of the force. At the border both agree to 1.2e-3.
///
/// Examples
/// --------
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.grid(16, 16, 10.5e-3), [[0, 0, 0.08]], signature="trap")
/// >>> trap = midair.gorkov(scene, midair.solve(scene))
/// >>> bool((trap.stiffness > 0).all())
/// True
#[pyfunction]
#[pyo3(signature = (scene, drive=None, points=None, *, bead=None))]
pub(crate) fn gorkov<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    drive: Option<Bound<'py, PyAny>>,
    points: Option<Bound<'py, PyAny>>,
    bead: Argument<'_, 'py>,
) -> PyResult<Gorkov> {
    let Requested { model, drive, points, particle, gravity, .. } = requested(scene, drive, points, bead)?;
    let felt = attend(py, None, |mut control| midair::gorkov(&model, &drive, &points, particle, &mut control))?;
    let midair::Gorkov { potential, force, hessian, .. } = felt;
    let (weight, mass) = (particle.weight(model.medium(), gravity), particle.mass(model.medium()));
    Ok(Gorkov { potential, force, hessian, weight, mass })
}

/// Find where small spheres that start at some points come to rest, and the forces that restore them.
///
/// Parameters
/// ----------
/// scene, drive, points
///     As for `midair.gorkov`; the spheres start at the points.
/// bead : midair.Bead or mapping, optional
///     The spheres, as for `midair.gorkov`.
///
/// Returns
/// -------
/// midair.Rest
///     Places, stiffness and natural frequencies.
///
/// Raises
/// ------
/// SceneError
///     As for `midair.gorkov`.
///
/// Notes
/// -----
/// The net force of sound, weight and buoyancy is followed to the place where it is 0. Along each axis of the
/// stiffness there, `basin` and `restoring` are range and strength of the restoring force. `frequencies` and
/// `acceleration` describe the motion of the bead.
///
/// Examples
/// --------
/// >>> import midair
/// >>> boards = midair.Array.preset("openmpd_pair", quantization={})
/// >>> bead = midair.rest(midair.solve(midair.Scene(boards, [[0, 0, 0]], signature="trap")))
/// >>> bool(bead.held[0]), bool(abs(bead.place).max() < 1e-4)
/// (True, True)
#[pyfunction]
#[pyo3(signature = (scene, drive=None, points=None, *, bead=None))]
pub(crate) fn rest<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    drive: Option<Bound<'py, PyAny>>,
    points: Option<Bound<'py, PyAny>>,
    bead: Argument<'_, 'py>,
) -> PyResult<Rest> {
    let Requested { model, drive, points, particle, gravity, remark } = requested(scene, drive, points, bead)?;
    let midair::Rest { place, held, stiffness, axes, basin, restoring, .. } =
        attend(py, None, |mut control| midair::rest(&model, &drive, &points, particle, gravity, &mut control))?;
    warn_all(py, remark)?;
    Ok(Rest { place, held, stiffness, axes, basin, restoring, mass: particle.mass(model.medium()) })
}
