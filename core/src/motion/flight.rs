//! Flight: how beads move in forces that change with time and place.
//!
//! A sequence changes its forces thousands of times a second, and each costs a pass over all transducers. Around a place
//! that moves with a trap the force hardly changes from one millisecond to the next: it is a polynomial of the place there, and
//! its coefficients go straight from one instant, a knot, to the next.

use alloc::format;
use alloc::vec::Vec;

use crate::control::Control;
use crate::error::{Error, real};
use crate::kernels::InstructionSet;
use crate::kernels::flight::{Beads, Laws, advance, begin, radii};
use crate::scene::Medium;
use crate::scene::Particle;
use crate::scene::geometry::vector;

/// Speeds of the table of drag: up to 8 m/s in steps of 8 mm/s. Between them the drag over the speed is straight to 2e-4 from
/// .1 m/s on; below that the difference is less than 1e-4 of the weight of a bead of expanded polystyrene.
const SPEEDS: usize = 1024;
const SPACING: f64 = 8e-3;

/// The force on eight beads at a knot, in N: of x^a y^b z^c up to degree 6 the coefficients along x, y and z, where x, y, z are
/// the place from a centre in units of [`Flight::unit`]. Monomials stand by degree, and of one by exponents that fall.
pub(crate) type Force = [[[f64; 8]; 3]; 84];

/// Place, speed and the last four accelerations of eight beads, the newest first, in SI units.
pub(crate) type State = [[[f64; 8]; 3]; 6];

/// Properties of beads, and the steps of their time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Flight {
    /// The beads, all alike.
    pub(crate) particle: Particle,
    /// Gravity in m/s^2.
    pub(crate) gravity: [f64; 3],
    /// The time from a step to the next, in s.
    pub(crate) step: f64,
    /// Steps from a knot to the next.
    pub(crate) steps: usize,
    /// The unit of the coordinates in m.
    pub(crate) unit: f64,
}

impl Flight {
    /// Moves eight beads under `forces` (K,), one a knot, around `centres` (steps (K - 1) + 1,), one a step, from step `from`
    /// on, and writes `places` (P,), those at the knots that are reached. Where P is larger than K, forces and centres begin again:
    /// the last are the first of the next lap. Returns the step that was the last: all of them, or the first after which a bead
    /// is farther from its centre than its `reach` in m, which is NaN in a lane without a bead. Accelerations of NaN are those of the first forces:
    /// before them, beads moved as they do then.
    ///
    /// ```text
    /// m x'' = F(x, t) + weight - buoyancy - drag(|x'|) x'/|x'|,   m = own mass + half that of the air in its place
    /// ```
    ///
    /// by Adams' method of order 4. The mass of the air is that of a sphere that is accelerated in a fluid without friction.
    ///
    /// # Errors
    /// Lengths that do not fit; a step, a unit, a number of steps or a particle's value that is not above 0; a stop.
    #[allow(clippy::too_many_arguments, reason = "a slice a thing")]
    pub(crate) fn fly(
        &self,
        (set, medium): (InstructionSet, Medium),
        state: &mut State,
        reach: [f64; 8],
        forces: &[Force],
        centres: &[[[f64; 8]; 3]],
        from: usize,
        places: &mut [[[f64; 8]; 3]],
        control: &mut Control,
    ) -> Result<usize, Error> {
        let laws = self.laws(medium)?;
        let (lap, knots) = (forces.len().saturating_sub(1), places.len());
        if lap == 0 || centres.len() != self.steps * lap + 1 || knots < 2 {
            let given = format!("{}, centres {}, places {}", forces.len(), centres.len(), knots);
            return Err(Error::invalid("forces", given, "give steps (K - 1) + 1 centres, K and places at least 2"));
        }
        let radii = radii(set, forces);
        let [place, speed, pulls @ ..] = state;
        let mut beads = Beads { place, speed, pulls, reach: reach.map(|x| x * x) };
        if beads.pulls[0].as_flattened().iter().any(|pull| pull.is_nan()) {
            begin(set, &laws, &forces[0], &centres[0], &mut beads);
        }
        if from == 0 {
            places[0] = *beads.place;
        }
        for knot in from / self.steps..knots - 1 {
            control.pulse()?;
            let (first, own) = (knot * self.steps, knot % lap);
            let centres = &centres[own * self.steps..=(own + 1) * self.steps];
            let ends = [&forces[own], &forces[own + 1]];
            let near = core::array::from_fn(|end| radii[own][end].min(radii[own + 1][end]));
            let last = advance(set, &laws, (ends, near), centres, from.max(first) - first, &mut beads);
            if last == self.steps {
                places[knot + 1] = *beads.place;
            }
            if last < self.steps || beads.far(&centres[last]) {
                return Ok(first + last);
            }
        }
        Ok(self.steps * (knots - 1))
    }

    fn laws(&self, medium: Medium) -> Result<Laws, Error> {
        real("radius", self.particle.radius, 0.0, true)?;
        real("density", self.particle.density, 0.0, true)?;
        real("step", self.step, 0.0, true)?;
        real("unit", self.unit, 0.0, true)?;
        vector("gravity", &self.gravity)?;
        if self.steps == 0 {
            return Err(Error::invalid("steps", 0, "give at least 1"));
        }
        let mass = self.particle.mass(medium);
        let drag = |k: usize| {
            let speed = SPACING * (k as f64).max(1e-6);
            self.particle.drag(medium, speed) / (speed * mass)
        };
        Ok(Laws {
            lightness: 1.0 / mass,
            gravity: self.particle.weight(medium, self.gravity).map(|weight| weight / mass),
            drag: (0..SPEEDS).map(drag).collect::<Vec<_>>(),
            finest: 1.0 / SPACING,
            unit: self.unit,
            step: self.step,
        })
    }
}

#[cfg(test)]
#[path = "tests/flight.rs"]
mod tests;
