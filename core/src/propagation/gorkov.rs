//! Gor'kov potential of a small sphere in the field of a drive, its force and stiffness, by exact derivatives of G.

use alloc::format;
use alloc::vec;
use alloc::vec::Vec;

use num_complex::{Complex32, Complex64};

use crate::control::{Control, bytes};
use crate::error::{Error, real};
use crate::propagation::jet::Jet;
use crate::propagation::model::Model;
use crate::propagation::particle::{Particle, potential};
use crate::propagation::sources::Sources;
use crate::propagation::taylor::Taylor;
use crate::scene::{check_drive, check_places};

/// Points worked on by one thread at once.
const CHUNK: usize = 16;

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
    let images = model.scattering.as_ref().map_or(&[][..], |scattering| &scattering.images);
    let played = |sources: &Sources, i: usize| {
        sources.array.effect(i) * Complex64::new(f64::from(drive[i].re), f64::from(drive[i].im))
    };
    let all = core::iter::once(&*model.sources).chain(images);
    let waves: Vec<_> = all.map(|sources| (sources, Taylor::new(model.set, sources, |i| played(sources, i)))).collect();
    control.each(parts, &|(part, (out, points)): (usize, (&mut [Felt], &[[f64; 3]])), control| {
        for (j, (out, point)) in out.iter_mut().zip(points).enumerate() {
            *out = at(&waves, (part * CHUNK + j, *point), factors, control)?;
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
    waves: &[(&Sources, Taylor)],
    (j, point): (usize, [f64; 3]),
    factors: [f64; 2],
    control: &mut Control,
) -> Result<Felt, Error> {
    let mut pressure = [Jet::ZERO; 2];
    for (sources, taylor) in waves {
        (0..sources.array.len()).try_for_each(|i| sources.check_distance(i, j, point))?;
        taylor.add(point, &mut pressure, control)?;
    }
    let potential = potential(&pressure, factors);
    let felt = (potential.value(), potential.gradient().map(|slope| -slope), potential.hessian());
    if !(felt.0.is_finite() && felt.1.iter().chain(felt.2.as_flattened()).all(|x| x.is_finite())) {
        let cure = "the force has no bound there: move it off the plane of a transducer's face";
        return Err(Error::invalid(format!("points[{j}]"), format!("{point:?}"), cure));
    }
    Ok(felt)
}
