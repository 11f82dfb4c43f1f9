//! Force of sound on a sphere in the field of a drive, its potential and stiffness, by exact derivatives.

use crate::prelude::*;
use crate::propagation::forces::momentum::Pushed;
use crate::propagation::forces::particle::LARGEST;
use crate::propagation::forces::response::Response;
use crate::propagation::jet::Jet;
use crate::propagation::local::{LEAST_CLEARANCE, Local};
use crate::propagation::scattering::bodies::Bodies;
use crate::propagation::taylor::Taylor;
use crate::propagation::{Model, Sources};
use crate::scene::{Particle, check_drive, check_places, distance};

/// How many points a thread computes together.
const CHUNK: usize = 16;

/// The largest radius of a sphere, in wavelengths.
const MOST: f64 = 3.0;
/// The step of the finite differences for the stiffness of a large sphere, in wavelengths.
const STEP: f64 = 1.0 / 400.0;

/// Force, potential and stiffness of a sphere at P points.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gorkov {
    /// Potential U (P,) in J of the force without the push of travelling waves. For small k a it is Gor'kov's.
    pub potential: Vec<f64>,
    /// Force (P, 3) in N.
    pub force: Vec<[f64; 3]>,
    /// Stiffness (P, 3, 3) in N/m, the symmetric part of -dF_i/dx_a. The diagonal is the stiffness along x, y and z. A point of force 0 is a trap
    /// if all eigenvalues are above 0.
    pub hessian: Vec<[[f64; 3]; 3]>,
}

/// Returns the force of sound on a `particle` at any `points` (P, 3) in m, its potential and stiffness, in the field of a
/// drive (N,).
///
/// The particle is a sphere of fluid. The force is computed from the waves that it scatters, for radii up to an eighth of the
/// wavelength from monopole, dipole and quadrupole:
///
/// ```text
/// F_i = Re[ C_0 p* p_i + C_1 p_j* p_ij + C_2 p_jk* p_ijk ],   p_i = dp/dx_i, summed over j and k
/// U = -1/2 [ Re C_0 |p|^2 + Re C_1 |p_j|^2 + Re C_2 |p_jk|^2 ]
/// ```
///
/// The coefficients follow from the partial waves of the sphere (O. A. Sapozhnikov and M. R. Bailey, J. Acoust. Soc. Am. 133,
/// 661, 2013). For a small sphere U is the potential of L. P. Gor'kov, Sov. Phys. Dokl. 6, 773 (1962). The force includes the
/// push of travelling waves, such as those of a single array. It contains no gravity; the air has no viscosity.
///
/// For a radius from an eighth of the wavelength to three wavelengths, the whole series is computed from the pressure at the
/// surface of the sphere. Then `potential` is NaN, and `hessian` contains finite differences of the force. At the border, both
/// agree to 2e-3.
///
/// The propagation matrix G is computed in double precision, without a scene's signature. Its derivatives are exact, from
/// Taylor polynomials around each point. Those of the sound scattered by spheres and meshes come from its values on a small
/// ball, with an error of 1e-5.
///
/// # Errors
/// A drive that does not fit the array; no points, one that is not finite, too far away, within lambda/100 of a transducer, or
/// in the plane of a transducer whose directivity is discontinuous there; a particle of no size, density or sound speed, or
/// larger than three wavelengths; a point inside an obstacle or within lambda/100 of a sphere or mesh, or a large sphere that
/// extends there; more memory than allowed; a stop by the caller.
pub fn gorkov(
    model: &Model,
    drive: &[Complex32],
    points: &[[f64; 3]],
    particle: Particle,
    control: &mut Control,
) -> Result<Gorkov> {
    let trap = Trap::new(model, drive, points, particle)?;
    let large = trap.large(points, particle)?;
    control.room("the potential", [drive.len(), points.len()], bytes(2 * size_of::<Push>(), &[points.len()]))?;
    let mut pushes = vec![Push::default(); points.len()];
    let parts = pushes.chunks_mut(CHUNK).zip(points.chunks(CHUNK)).enumerate().collect();
    control.each(parts, &|(part, (out, points)): (usize, (&mut [Push], &[[f64; 3]])), control| {
        for (j, (out, point)) in out.iter_mut().zip(points).enumerate() {
            let j = part * CHUNK + j;
            *out = match &large {
                Some(sphere) => trap.on_sphere(sphere, j, *point, control)?,
                None => trap.push(j, *point, control)?,
            };
        }
        Ok(())
    })?;
    Ok(Gorkov {
        potential: pushes.iter().map(|push| push.potential).collect(),
        force: pushes.iter().map(|push| push.force.0).collect(),
        hessian: pushes.iter().map(|push| push.hessian).collect(),
    })
}

/// The force of sound on a particle at one point, its potential and the second derivatives of the potential.
#[derive(Clone, Copy, Default)]
pub(crate) struct Push {
    pub(crate) potential: f64,
    pub(crate) force: Vec3,
    pub(crate) hessian: [[f64; 3]; 3],
}

/// The field of a drive, prepared to compute the force on a particle at any point.
pub(crate) struct Trap<'a> {
    model: &'a Model,
    waves: Vec<(&'a Sources, Taylor)>,
    /// Spheres and meshes, and the amplitudes of their waves in the field of the drive.
    bodies: Option<(&'a Bodies, Vec<Complex64>)>,
    particle: Particle,
    response: Response,
}

impl<'a> Trap<'a> {
    /// Checks the drive, the points and the particle, and prepares the field.
    ///
    /// # Errors
    /// The errors of [`gorkov`].
    pub(crate) fn new(model: &'a Model, drive: &[Complex32], points: &[[f64; 3]], particle: Particle) -> Result<Self> {
        let (array, medium) = (model.array(), model.medium());
        check_drive(drive, array.len())?;
        if points.is_empty() {
            return Err(Error::missing("points", "empty", "give at least one point"));
        }
        check_places(array.centre(), medium, "points", "", points)?;
        particle.in_range()?;
        let (mut images, mut bodies) = (&[][..], None);
        if let Some(scattering) = &model.scattering {
            scattering.obstacles.check_points(points)?;
            scattering.check()?;
            images = &scattering.images;
            bodies = scattering.bodies.as_deref().map(|bodies| (bodies, bodies.driven(&model.sources, drive)));
        }
        let played = |sources: &Sources, i: usize| {
            sources.array.effect(i) * Complex64::new(f64::from(drive[i].re), f64::from(drive[i].im))
        };
        let all = core::iter::once(&*model.sources).chain(images);
        let waves = all.map(|sources| (sources, Taylor::new(model.set, sources, |i| played(sources, i)))).collect();
        Ok(Self { model, waves, bodies, particle, response: Response::new(particle, medium) })
    }

    /// Returns the wave series of a large particle, `None` for a small one. Checks that the sphere touches nothing at any
    /// point.
    fn large(&self, points: &[[f64; 3]], Particle { radius, .. }: Particle) -> Result<Option<Pushed>> {
        let (medium, array) = (self.model.medium(), self.model.array());
        let wavelength = medium.wavelength();
        if radius <= LARGEST * wavelength {
            return Ok(None);
        }
        if radius > MOST * wavelength {
            let cure = format!("give at most {:.2e}, three wavelengths", MOST * wavelength);
            return Err(Error::out_of_range("bead.radius", radius, cure));
        }
        for (j, &point) in points.iter().enumerate() {
            let nearest = array.positions().iter().map(|&place| distance(place, point)).fold(f64::INFINITY, f64::min);
            let clear = self.model.scattering.as_ref().map_or(f64::INFINITY, |all| all.obstacles.clearance(point));
            let (room, least) = (nearest.min(clear), radius + LEAST_CLEARANCE * wavelength);
            if room < least {
                let cure = format!("{room:.1e} m from a transducer or an obstacle: leave {least:.1e} m for the sphere");
                return Err(Error::invalid(format!("points[{j}]"), format!("{point:?}"), cure));
            }
        }
        Ok(Some(Pushed::new(self.particle, medium)))
    }

    /// Force and stiffness of a large sphere, which has no potential.
    fn on_sphere(&self, sphere: &Pushed, j: usize, point: [f64; 3], control: &mut Control) -> Result<Push> {
        let mut force =
            |center: [f64; 3]| sphere.force(center, |place| self.pressure(j, place, &mut Control::none()), control);
        let step = STEP * self.model.medium().wavelength();
        let mut hessian = [[0.0; 3]; 3];
        for axis in 0..3 {
            let [before, after] = [-step, step].map(|step| {
                let mut center = point;
                center[axis] += step;
                force(center)
            });
            let (before, after) = (before?, after?);
            for row in 0..3 {
                let half = (before[row] - after[row]) / (4.0 * step);
                hessian[row][axis] += half;
                hessian[axis][row] += half;
            }
        }
        Ok(Push { potential: f64::NAN, force: Vec3(force(point)?), hessian })
    }

    /// Potential, force and second derivatives at `point`, which errors name as point `j`.
    pub(crate) fn push(&self, j: usize, point: [f64; 3], control: &mut Control) -> Result<Push> {
        let pressure = self.pressure(j, point, control)?;
        let field = pressure.each_ref().map(Jet::coefficients);
        let value = self.response.potential.value(field);
        let force = Vec3(self.response.force.each_ref().map(|form| form.value(field)));
        let hessian = self.response.hessian.each_ref().map(|row| row.each_ref().map(|form| form.value(field)));
        if !(value.is_finite() && force.iter().chain(hessian.as_flattened()).all(|x| x.is_finite())) {
            let cure = "the force has no bound there: move it off the plane of a transducer's face";
            return Err(Error::invalid(format!("points[{j}]"), format!("{point:?}"), cure));
        }
        Ok(Push { potential: value, force, hessian })
    }

    /// The Taylor polynomials of the pressure around `point`, real and imaginary part. Errors name it as point `j`.
    fn pressure(&self, j: usize, point: [f64; 3], control: &mut Control) -> Result<[Jet; 2]> {
        let mut pressure = [Jet::ZERO; 2];
        for (sources, taylor) in &self.waves {
            (0..sources.array.len()).try_for_each(|i| sources.check_distance(i, j, point))?;
            taylor.add(point, &mut pressure, control)?;
        }
        if let Some((bodies, driven)) = &self.bodies {
            control.pulse()?;
            let mut row = Vec::new();
            let sent = self.local(j, point)?.expand(point, |place| bodies.pressure(driven, place, &mut row));
            pressure.iter_mut().zip(&sent).for_each(|(sum, sent)| sum.add(sent, 1.0));
        }
        Ok(pressure)
    }

    /// The ball around a point on which the sound of bodies is sampled for its derivatives.
    fn local(&self, j: usize, point: [f64; 3]) -> Result<Local> {
        let medium = self.model.medium();
        let clear = self.model.scattering.as_ref().map_or(f64::INFINITY, |all| all.obstacles.clearance(point));
        Local::beside(medium, clear).ok_or_else(|| {
            let least = LEAST_CLEARANCE * medium.wavelength();
            let cure = format!("{clear:.1e} m from an obstacle's surface: leave {least:.1e} m");
            Error::invalid(format!("points[{j}]"), format!("{point:?}"), cure)
        })
    }
}
