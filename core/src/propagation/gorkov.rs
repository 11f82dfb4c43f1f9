//! Gor'kov potential of a small sphere in the field of a drive, its force and stiffness, by exact derivatives of G.

use alloc::format;
use alloc::vec;
use alloc::vec::Vec;

use num_complex::{Complex32, Complex64};

use crate::control::{Control, bytes};
use crate::error::{Error, real};
use crate::math;
use crate::propagation::jet::Jet;
use crate::propagation::model::Model;
use crate::propagation::sources::Sources;
use crate::scene::{Medium, check_drive, check_places, distance};

/// Points worked on by one thread at once.
const CHUNK: usize = 16;

/// Radii in wavelengths from which on the sphere is no longer small: k a = 0.79.
const LARGEST: f64 = 0.125;

/// A sphere that is to be trapped.
///
/// The default is a bead of expanded polystyrene, 2 mm across and 29 kg/m^3: the density of the beads of A. Marzo et al.,
/// "Holographic acoustic elements for manipulation of levitated objects", Nature Communications 6, 8661 (2015). Its sound
/// speed, 900 m/s, hardly matters: with the 1052 m/s of others a standing wave holds it 0.1 % better.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "three numbers, checked where they are used")]
pub struct Particle {
    /// Radius a in m.
    pub radius: f64,
    /// Density in kg/m^3.
    pub density: f64,
    /// Sound speed in m/s of what it is made of.
    pub sound_speed: f64,
}

impl Default for Particle {
    fn default() -> Self {
        Self { radius: 1e-3, density: 29.0, sound_speed: 900.0 }
    }
}

impl Particle {
    /// The factors of |p|^2 and of -|grad p|^2 in U.
    pub(crate) fn factors(&self, medium: Medium) -> [f64; 2] {
        let speeds = medium.sound_speed / self.sound_speed;
        let ratio = self.density / medium.density;
        let compressibility = medium.density * medium.sound_speed * medium.sound_speed;
        let f1 = 1.0 - speeds * speeds / ratio;
        let f2 = 2.0 * (ratio - 1.0) / (2.0 * ratio + 1.0);
        let volume = 4.0 / 3.0 * core::f64::consts::PI * self.radius * self.radius * self.radius;
        let omega = core::f64::consts::TAU * medium.frequency;
        [volume * f1 / (4.0 * compressibility), volume * 3.0 * f2 / (8.0 * medium.density * omega * omega)]
    }

    /// A remark where the radius is beyond an eighth of the wavelength: the potential is then too simple.
    #[must_use]
    pub fn remark(&self, medium: Medium) -> Option<alloc::string::String> {
        let most = LARGEST * medium.wavelength();
        (self.radius > most).then(|| {
            format!(
                "radius is {} m: Gor'kov's potential is for spheres small beside the wavelength, up to {most:.2e} m",
                self.radius
            )
        })
    }
}

/// What a small sphere feels at some points (P,).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gorkov {
    /// Potential U (P,) in J.
    pub potential: Vec<f64>,
    /// Force -grad U (P, 3) in N.
    pub force: Vec<[f64; 3]>,
    /// Second derivatives of U (P, 3, 3) in N/m. Their diagonal is the stiffness along x, y and z; all eigenvalues are
    /// above 0 where a force of 0 is a trap.
    pub hessian: Vec<[[f64; 3]; 3]>,
}

/// Gor'kov potential, force and stiffness of a `particle` at any `points` (P, 3) in m, in the field of a drive (N,).
///
/// ```text
/// U = V [ f1 <p^2>/(2 rho c^2) - 3/4 f2 rho <v^2> ],   v = grad p/(j omega rho),   V = 4/3 pi a^3
/// f1 = 1 - kappa_p/kappa_0,  f2 = 2 (rho_p/rho - 1)/(2 rho_p/rho + 1),   kappa = 1/(rho c^2)
/// ```
///
/// after H. Bruus, "Acoustofluidics 7", Lab on a Chip 12, 1014 (2012), and L. P. Gor'kov, Sov. Phys. Dokl. 6, 773 (1962):
/// a sphere that is small beside the wavelength, a fluid without viscosity, no gravity, and no scattering force, which
/// waves that run, as those of a single array, add. G is eq. (5) itself, not a scene's signature, in double precision, and its
/// derivatives are exact: Taylor polynomials around each point.
///
/// # Errors
/// A drive that does not fit the array; no points, one that is not finite, too far away, within lambda/100 of a
/// transducer, or in the plane of a transducer whose directivity breaks off there; a particle of no size, density or
/// sound speed; more memory than allowed; a stop.
pub fn gorkov(
    model: &Model,
    drive: &[Complex32],
    points: &[[f64; 3]],
    particle: Particle,
    control: &mut Control,
) -> Result<Gorkov, Error> {
    let (array, medium) = (model.array(), model.medium());
    check_drive(drive, array.len())?;
    if points.is_empty() {
        return Err(Error::invalid("points", "empty", "give at least one point"));
    }
    check_places(array.centre(), medium, "points", "", points)?;
    if let Some(scattering) = &model.scattering {
        scattering.obstacles.check_points(points)?;
        if scattering.bodies.is_some() {
            let cure = "derivatives of the sound that a sphere or mesh sends on are not known here: leave it out";
            return Err(Error::invalid("obstacles", "more than walls", cure));
        }
        scattering.check()?;
    }
    real("radius", particle.radius, 0.0, true)?;
    real("density", particle.density, 0.0, true)?;
    real("sound_speed", particle.sound_speed, 0.0, true)?;
    control.room("the potential", [array.len(), points.len()], bytes(2 * size_of::<Felt>(), &[points.len()]))?;
    let mut felt = vec![Felt::default(); points.len()];
    let parts = felt.chunks_mut(CHUNK).zip(points.chunks(CHUNK)).enumerate().collect();
    let factors = particle.factors(medium);
    control.each(parts, &|(part, (out, points)): (usize, (&mut [Felt], &[[f64; 3]])), control| {
        for (j, (out, point)) in out.iter_mut().zip(points).enumerate() {
            *out = at(model, drive, (part * CHUNK + j, *point), factors, control)?;
        }
        Ok(())
    })?;
    Ok(Gorkov {
        potential: felt.iter().map(|felt| felt.0).collect(),
        force: felt.iter().map(|felt| felt.1).collect(),
        hessian: felt.iter().map(|felt| felt.2).collect(),
    })
}

/// Potential, force and second derivatives at one point.
type Felt = (f64, [f64; 3], [[f64; 3]; 3]);

fn at(
    model: &Model,
    drive: &[Complex32],
    (j, point): (usize, [f64; 3]),
    factors: [f64; 2],
    control: &mut Control,
) -> Result<Felt, Error> {
    let mut pressure = [Jet::ZERO; 2];
    let images = model.scattering.as_ref().map_or(&[][..], |scattering| &scattering.images);
    for sources in core::iter::once(&*model.sources).chain(images) {
        for (i, q) in drive.iter().enumerate() {
            control.pulse()?;
            sources.check_distance(i, j, point)?;
            let q = Complex64::new(f64::from(q.re), f64::from(q.im)) * sources.array.effect(i);
            add_wave(sources, (i, point), q, &mut pressure);
        }
    }
    let potential = potential(&pressure, factors);
    let felt = (potential.value(), potential.gradient().map(|slope| -slope), potential.hessian());
    if !(felt.0.is_finite() && felt.1.iter().chain(felt.2.as_flattened()).all(|x| x.is_finite())) {
        let cure = "the force has no bound there: move it off the plane of a transducer's face";
        return Err(Error::invalid(format!("points[{j}]"), format!("{point:?}"), cure));
    }
    Ok(felt)
}

/// U of a pressure, real and imaginary part.
pub(crate) fn potential(pressure: &[Jet; 2], [compression, motion]: [f64; 2]) -> Jet {
    let mut potential = Jet::ZERO;
    for part in pressure {
        potential.add(&part.times(part), compression);
        for slope in [0, 1, 2].map(|axis| part.derivative(axis)) {
            potential.add(&slope.times(&slope), -motion);
        }
    }
    potential
}

/// Adds `q` times eq. (5) of transducer i around a point, its response left out, to a pressure.
pub(crate) fn add_wave(sources: &Sources, (i, point): (usize, [f64; 3]), q: Complex64, [re, im]: &mut [Jet; 2]) {
    if q != Complex64::ZERO {
        let [own_re, own_im] = jet(sources, i, point);
        re.add(&own_re, q.re);
        re.add(&own_im, -q.im);
        im.add(&own_im, q.re);
        im.add(&own_re, q.im);
    }
}

/// Eq. (5) of transducer i around a point, its response left out, in Pa: real and imaginary part.
fn jet(sources: &Sources, i: usize, point: [f64; 3]) -> [Jet; 2] {
    let transducer = sources.array.transducer();
    let (from, normal) = (sources.array.positions()[i], sources.array.normals()[i]);
    let ray = [0, 1, 2].map(|axis| point[axis] - from[axis]);
    let r = distance(from, point);
    // r = sqrt(r^2), r^2 a polynomial.
    let square = Jet::quadratic(r * r, ray.map(|x| 2.0 * x), 1.0).powers();
    let root = Jet::series([r, 0.5 / r, -0.125 / (r * r * r), 0.0625 / (r * r * r * r * r)], &square).powers();
    // e^{(jk - alpha) r}/r: the coefficients of e^{u (r + h)} are those of e^{u r} times u^n/n!, those of 1/(r + h) are
    // (-1/r)^n/r.
    let u = Complex64::new(-sources.medium.absorption, sources.medium.wavenumber());
    let wave = math::exp(u.re * r) * transducer.source_pressure / r;
    let wave = Complex64::new(wave * math::cos(u.im * r), wave * math::sin(u.im * r));
    let [a, b] = [u, Complex64::new(-1.0 / r, 0.0)];
    let second = a * a / 2.0 + a * b + b * b;
    let third = a * a * a / 6.0 + a * a * b / 2.0 + a * b * b + b * b * b;
    let series = [wave, wave * (a + b), wave * second, wave * third];
    let parts = [series.map(|c| c.re), series.map(|c| c.im)].map(|part| Jet::series(part, &root));
    // cos(theta) = ray . normal/r.
    let inverse = Jet::series([1.0 / r, -1.0 / (r * r), 1.0 / (r * r * r), -1.0 / (r * r * r * r)], &root);
    let height = (0..3).map(|axis| ray[axis] * normal[axis]).sum::<f64>();
    let cosine = Jet::quadratic(height, normal, 0.0).times(&inverse);
    let slopes = transducer.directivity.taylor(cosine.value(), sources.medium.wavenumber());
    if slopes == [1.0, 0.0, 0.0, 0.0] {
        return parts;
    }
    let directivity = Jet::series(slopes, &cosine.powers());
    parts.map(|part| part.times(&directivity))
}
