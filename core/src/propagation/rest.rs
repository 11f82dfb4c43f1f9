//! Rest: the resting place of a particle in the field of a drive, and the stability there.

use alloc::vec;
use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::{Control, bytes};
use crate::error::Error;
use crate::linalg::symmetric::eigen;
use crate::math;
use crate::propagation::gorkov::{Felt, Trap};
use crate::propagation::model::Model;
use crate::scene::geometry::vector;
use crate::scene::{Particle, distance, dot};

/// The longest step along the force, in wavelengths.
const STEP: f64 = 1.0 / 48.0;

/// Steps that a particle is followed for.
const STEPS: usize = 300;

/// A step so short that the place is found, in wavelengths.
const STILL: f64 = 1e-7;

/// A particle that moves farther than that is not trapped, and the force is sampled so far along an axis, in wavelengths.
const FAR: f64 = 1.0;

/// Where particles rest, one for each point that they start at (P,). One that is not trapped has only `place`, else NaN.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rest {
    /// The place (P, 3) in m where the net force is 0; or where an untrapped particle was lost.
    pub place: Vec<[f64; 3]>,
    /// Whether the place holds it (P,): the net force pulls back from all sides, within a wavelength of the start.
    pub held: Vec<bool>,
    /// Eigenvalues of the stiffness there (P, 3) in N/m, the softest first.
    pub stiffness: Vec<[f64; 3]>,
    /// The direction of each (P, 3, 3), of length 1.
    pub axes: Vec<[[f64; 3]; 3]>,
    /// How far in m the net force pulls back along each direction, against it and along it (P, 3, 2).
    pub basin: Vec<[[f64; 2]; 3]>,
    /// The most in N that it pulls back with there (P, 3, 2).
    pub restoring: Vec<[[f64; 2]; 3]>,
}

/// Where particles that start at some points (P, 3) in m come to rest in the field of a drive (N,) under a `gravity` in m/s^2:
/// the net force, Gor'kov's and weight less buoyancy, is followed downhill to the place where it is 0.
///
/// Each step goes by the inverse of |stiffness|, a thirtieth of a wavelength at most, never up in energy. The basin is what
/// the straight line along each axis shows, up to a wavelength.
///
/// # Errors
/// As [`crate::gorkov`]; a gravity that is not finite.
///
/// ```
/// use midair::{Array, Complex32, Control, InstructionSet, Medium, Model, Particle};
///
/// // Two transducers that face each other hold a bead along their axis, below a node by its weight.
/// let normals = Some(vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
/// let array = Array::new(vec![[0.0, 0.0, -0.02], [0.0, 0.0, 0.02]], normals)?;
/// let model = Model::new(&array, Medium::default(), InstructionSet::best())?;
/// let drive = [Complex32::ONE, -Complex32::ONE];
/// let rest = midair::rest(
///     &model, &drive, &[[0.0, 0.0, 0.0]], Particle::default(), [0.0, 0.0, -9.81], &mut Control::none(),
/// )?;
/// assert!(rest.held[0] && rest.place[0][2] < 0.0 && rest.place[0][2] > -1e-3);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn rest(
    model: &Model,
    drive: &[Complex32],
    points: &[[f64; 3]],
    particle: Particle,
    gravity: [f64; 3],
    control: &mut Control,
) -> Result<Rest, Error> {
    let trap = Trap::new(model, drive, points, particle)?;
    vector("gravity", &gravity)?;
    control.room("the resting places", [drive.len(), points.len()], bytes(2 * size_of::<One>(), &[points.len()]))?;
    let weight = particle.weight(model.medium(), gravity);
    let follow = Follow { trap: &trap, weight, wavelength: model.medium().wavelength() };
    let mut all: Vec<Option<One>> = vec![None; points.len()];
    let parts = all.iter_mut().zip(points).enumerate().collect();
    control.each(parts, &|(j, (out, point)): (usize, (&mut Option<One>, &[f64; 3])), control| {
        // A start that has no force is refused; a particle that strays to such a place is lost.
        trap.felt(j, *point, control)?;
        *out = Some(follow.from(j, *point, control)?);
        Ok(())
    })?;
    let all: Vec<One> = all.into_iter().flatten().collect();
    Ok(Rest {
        place: all.iter().map(|one| one.place).collect(),
        held: all.iter().map(|one| one.held).collect(),
        stiffness: all.iter().map(|one| one.stiffness).collect(),
        axes: all.iter().map(|one| one.axes).collect(),
        basin: all.iter().map(|one| one.basin).collect(),
        restoring: all.iter().map(|one| one.restoring).collect(),
    })
}

/// Properties of one particle.
#[derive(Clone, Copy)]
struct One {
    place: [f64; 3],
    held: bool,
    stiffness: [f64; 3],
    axes: [[f64; 3]; 3],
    basin: [[f64; 2]; 3],
    restoring: [[f64; 2]; 3],
}

impl One {
    fn lost(place: [f64; 3]) -> Self {
        let [stiffness, none] = [[f64::NAN; 3]; 2];
        Self {
            place,
            held: false,
            stiffness,
            axes: [none; 3],
            basin: [[f64::NAN; 2]; 3],
            restoring: [[f64::NAN; 2]; 3],
        }
    }
}

/// A particle in a field, under its weight.
struct Follow<'a> {
    trap: &'a Trap<'a>,
    weight: [f64; 3],
    wavelength: f64,
}

impl Follow<'_> {
    /// Energy, net force and second derivatives; none where there is no force.
    fn felt(&self, j: usize, place: [f64; 3], control: &mut Control) -> Result<Option<Felt>, Error> {
        match self.trap.felt(j, place, control) {
            Ok((potential, force, hessian)) => {
                let net = [0, 1, 2].map(|axis| force[axis] + self.weight[axis]);
                Ok(Some((potential - dot(self.weight, place), net, hessian)))
            }
            Err(Error::Stopped) => Err(Error::Stopped),
            Err(_) => Ok(None),
        }
    }

    fn from(&self, j: usize, start: [f64; 3], control: &mut Control) -> Result<One, Error> {
        let (mut place, mut most) = (start, STEP * self.wavelength);
        let Some(mut here) = self.felt(j, place, control)? else { return Ok(One::lost(place)) };
        for _ in 0..STEPS {
            let (stiffness, axes) = eigen(here.2);
            let step = step(here.1, stiffness, axes, most);
            let length = math::sqrt(dot(step, step));
            let next = [0, 1, 2].map(|axis| place[axis] + step[axis]);
            if length < STILL * self.wavelength {
                let found = stiffness.iter().all(|&k| k > 0.0);
                return if found { self.held(j, next, (stiffness, axes), control) } else { Ok(One::lost(next)) };
            }
            if distance(next, start) > FAR * self.wavelength {
                return Ok(One::lost(next));
            }
            let Some(there) = self.felt(j, next, control)? else { return Ok(One::lost(next)) };
            if there.0 > here.0 && length > 1e3 * STILL * self.wavelength {
                most = 0.5 * length;
                continue;
            }
            (place, here) = (next, there);
        }
        Ok(One::lost(place))
    }

    /// The stability at a place: along each axis, both ways.
    fn held(
        &self,
        j: usize,
        place: [f64; 3],
        (stiffness, axes): ([f64; 3], [[f64; 3]; 3]),
        control: &mut Control,
    ) -> Result<One, Error> {
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| stiffness[a].total_cmp(&stiffness[b]));
        let axes = order.map(|k| axes[k]);
        let (mut basin, mut restoring) = ([[0.0; 2]; 3], [[0.0; 2]; 3]);
        for (k, axis) in axes.iter().enumerate() {
            for (way, sign) in [-1.0, 1.0].into_iter().enumerate() {
                [basin[k][way], restoring[k][way]] = self.along(j, place, axis.map(|x| sign * x), control)?;
            }
        }
        Ok(One { place, held: true, stiffness: order.map(|k| stiffness[k]), axes, basin, restoring })
    }

    /// The distance over which the net force pulls back along a direction, and its largest value.
    fn along(&self, j: usize, place: [f64; 3], way: [f64; 3], control: &mut Control) -> Result<[f64; 2], Error> {
        let h = STEP * self.wavelength;
        let (mut last, mut before, mut most) = (0.0, 0.0, 0.0_f64);
        for n in 1..=(FAR / STEP) as usize {
            let at = [0, 1, 2].map(|axis| place[axis] + n as f64 * h * way[axis]);
            let Some((_, net, _)) = self.felt(j, at, control)? else { return Ok([(n - 1) as f64 * h, most]) };
            let own = -dot(net, way);
            // The top of the parabola through three neighbours.
            if last > before && last >= own {
                let bend = before - 2.0 * last + own;
                most = most.max(last - (own - before) * (own - before) / (8.0 * bend));
            }
            most = most.max(own);
            if own <= 0.0 {
                return Ok([h * ((n - 1) as f64 + last / (last - own)), most]);
            }
            (before, last) = (last, own);
        }
        Ok([FAR * self.wavelength, most])
    }
}

/// The step |H|^-1 net, at most so long: along each axis of the stiffness with the force, whatever its sign.
fn step(net: [f64; 3], stiffness: [f64; 3], axes: [[f64; 3]; 3], most: f64) -> [f64; 3] {
    let mut step = [0.0; 3];
    for (k, axis) in stiffness.iter().zip(&axes) {
        let share = dot(net, *axis) / k.abs().max(f64::MIN_POSITIVE);
        step.iter_mut().zip(axis).for_each(|(step, x)| *step += share.clamp(-1.0, 1.0) * x);
    }
    let length = math::sqrt(dot(step, step));
    if length > most { step.map(|x| x * most / length) } else { step }
}

#[cfg(test)]
#[path = "tests/rest.rs"]
mod tests;
