//! Flight: the motion of beads in forces that change with time and place.
//!
//! A sequence changes its forces thousands of times a second, and each force takes a pass over all transducers. Around
//! a centre that moves with a trap, the force hardly changes within a millisecond. So the force is a polynomial of the
//! place relative to this centre. Its coefficients are known at knots (interpolation nodes in time), and change
//! linearly from one knot to the next.

use crate::kernels::InstructionSet;
use crate::kernels::flight::{Beads, Laws, Layer, MODES, advance, begin, radii};
use crate::prelude::*;
use crate::scene::geometry::vector;
use crate::scene::{Medium, Particle};

/// Number of speeds in the table of drag: it reaches 8 m/s.
const SPEEDS: usize = 1024;
/// Step of the speeds in the table in m/s. From 0.1 m/s on, the drag is interpolated with a relative error of 2e-4.
/// Below 0.1 m/s the error is less than 1e-4 of the weight of a bead of expanded polystyrene.
const SPACING: f64 = 8e-3;

/// The force on eight beads at a knot, in N: for each x^a y^b z^c up to degree 6, its coefficients along x, y and z.
/// The place (x, y, z) is relative to a centre, in units of [`Flight::unit`]. Monomials are ordered by degree, then by
/// falling exponents.
pub(crate) type Force = [[[f64; 8]; 3]; 84];

/// Of eight beads: places, velocities, velocities of the wakes, the last four accelerations, the newest first, and the states
/// of the boundary layer; in SI units.
pub(crate) type State = [[[f64; 8]; 3]; 7 + MODES];

/// Returns the state of beads with these places and velocities, without a history.
pub(crate) fn begun(places: [[f64; 8]; 3], speeds: [[f64; 8]; 3]) -> State {
    let [none, unknown] = [0.0, f64::NAN].map(|x| [[x; 8]; 3]);
    core::array::from_fn(|part| match part {
        0 => places,
        1 | 2 => speeds,
        3..7 => unknown,
        _ => none,
    })
}

/// Returns a state whose accelerations are unknown, because the time step changes.
pub(crate) fn continued(mut state: State) -> State {
    state[3..7].fill([[f64::NAN; 8]; 3]);
    state
}

/// Slowest and fastest rate s_k in 1/s of the exponentials; the rates are evenly spaced on a logarithmic scale.
const RATES: [f64; 2] = [3.0, 1e5];
/// The sum of `SHARES` s_k^(1/2) e^(-s_k t) approximates 1/sqrt(t). Least squares of its Fourier transform: from 3 Hz to
/// 1.9 kHz the history force has an error below 0.8 % (tests).
const SHARES: [f64; MODES] = [1.8240, 0.7149, 0.8483, 0.8373, 0.8406, 0.8428, 0.7200, 1.8288];

/// Returns the rates s_k in 1/s and the weights in s^(-1/2) of the exponentials that approximate 1/sqrt(t).
fn exponentials() -> [[f64; 2]; MODES] {
    core::array::from_fn(|k| {
        let rate = RATES[0] * math::pow(RATES[1] / RATES[0], k as f64 / (MODES - 1) as f64);
        [rate, SHARES[k] * math::sqrt(rate)]
    })
}

/// Properties of the beads, and the time steps of their motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Flight {
    /// The properties of each bead: all beads are equal.
    pub(crate) particle: Particle,
    /// Gravity in m/s^2.
    pub(crate) gravity: [f64; 3],
    /// The time step in s.
    pub(crate) step: f64,
    /// Number of steps from one knot to the next.
    pub(crate) steps: usize,
    /// The unit of the coordinates in m.
    pub(crate) unit: f64,
}

impl Flight {
    /// Moves eight beads from step `from` on. `forces` (K,) are given at each knot, `centres` (steps (K - 1) + 1,) at
    /// each step. Writes the beads' places at the knots that are reached to `places` (P,). If P is larger than K, the
    /// forces and centres repeat: the last ones are the first ones of the next lap.
    ///
    /// Returns the last step: the last of all, or the first step after which a bead is farther from its centre than its
    /// `reach` in m. `reach` is NaN in a lane without a bead. Accelerations that are NaN are computed from the first
    /// forces, as if they had been constant before.
    ///
    /// ```text
    /// m x'' = F(x, t) + weight - buoyancy - drag,   m = mass of the bead + half the mass of the displaced air
    /// ```
    ///
    /// This equation is integrated by Adams' method of order 4, with the drag of `kernels::flight`. The mass of the air is that
    /// of a sphere that is accelerated in a fluid without friction.
    ///
    /// # Errors
    /// Lengths that do not fit; a step, a unit, a number of steps or a particle's value that is not above 0; a stop.
    #[allow(clippy::too_many_arguments, reason = "a slice a thing")]
    pub(crate) fn fly(
        &self,
        set: InstructionSet,
        medium: Medium,
        state: &mut State,
        reach: [f64; 8],
        forces: &[Force],
        centres: &[[[f64; 8]; 3]],
        from: usize,
        places: &mut [[[f64; 8]; 3]],
        control: &mut Control,
    ) -> Result<usize> {
        let laws = self.laws(medium)?;
        let (lap, knots) = (forces.len().saturating_sub(1), places.len());
        if lap == 0 || centres.len() != self.steps * lap + 1 || knots < 2 {
            let lengths = format!("{}, centres {}, places {}", forces.len(), centres.len(), knots);
            return Err(Error::invalid("forces", lengths, "give steps (K - 1) + 1 centres, K and places at least 2"));
        }
        let radii = radii(set, forces);
        let [place, speed, wake, rest @ ..] = state;
        let (pulls, layers) = rest.split_at_mut(4);
        let (Ok(pulls), Ok(layers)) = (pulls.try_into(), layers.try_into()) else { unreachable!("4 and MODES") };
        let mut beads = Beads { place, speed, wake, pulls, layers, reach: reach.map(|x| x * x) };
        if beads.pulls[0].as_flattened().iter().any(|pull| pull.is_nan()) {
            begin(set, &laws, &forces[0], &centres[0], &mut beads);
        }
        if from == 0 {
            places[0] = *beads.place;
        }
        for knot in from / self.steps..knots - 1 {
            control.pulse()?;
            let (first, of_lap) = (knot * self.steps, knot % lap);
            let centres = &centres[of_lap * self.steps..=(of_lap + 1) * self.steps];
            let ends = [&forces[of_lap], &forces[of_lap + 1]];
            let near = core::array::from_fn(|end| radii[of_lap][end].min(radii[of_lap + 1][end]));
            let last = advance(set, &laws, ends, near, centres, from.max(first) - first, &mut beads);
            if last == self.steps {
                places[knot + 1] = *beads.place;
            }
            if last < self.steps || beads.far(&centres[last]) {
                return Ok(first + last);
            }
        }
        Ok(self.steps * (knots - 1))
    }

    fn laws(&self, medium: Medium) -> Result<Laws> {
        real("radius", self.particle.radius, 0.0, true)?;
        real("density", self.particle.density, 0.0, true)?;
        real("step", self.step, 0.0, true)?;
        real("unit", self.unit, 0.0, true)?;
        vector("gravity", &self.gravity)?;
        refuse_if!(self.steps == 0, Error::out_of_range("steps", 0, "give at least 1"));
        let mass = self.particle.mass(medium);
        let friction = self.particle.friction(medium) / mass;
        let drag = |k: usize| {
            let speed = SPACING * (k as f64).max(1e-6);
            self.particle.drag(medium, speed) / (speed * mass) - friction
        };
        let history = self.particle.history(medium) / mass;
        let layers = exponentials().map(|[rate, weight]| {
            let left = math::exp(-rate * self.step);
            Layer { weight: history * weight, left, gained: (1.0 - left) / (rate * self.step) }
        });
        Ok(Laws {
            lightness: 1.0 / mass,
            gravity: self.particle.weight(medium, self.gravity).map(|weight| weight / mass),
            friction,
            layers,
            passed: self.step / (2.0 * self.particle.radius),
            drag: (0..SPEEDS).map(drag).collect::<Vec<_>>(),
            finest: 1.0 / SPACING,
            unit: self.unit,
            step: self.step,
        })
    }
}

#[cfg(test)]
#[path = "tests/dynamics.rs"]
mod tests;
