//! Rest: the place where a particle rests in the field of a drive, and how stable it is there.

use crate::control::bytes;
use crate::linalg::symmetric::eigen;
use crate::prelude::*;
use crate::propagation::Propagation;
use crate::propagation::forces::gorkov::{Push, Trap};
use crate::propagation::model::Model;
use crate::scene::geometry::vector;
use crate::scene::{Bead, Particle};

/// The longest step along the force, in wavelengths.
const STEP: f64 = 1.0 / 48.0;

/// How many steps a particle is followed, at most.
const STEPS: usize = 300;

/// The place is found when a step is shorter than this, in wavelengths.
const STILL: f64 = 1e-7;

/// A particle that moves farther than this is not trapped, in wavelengths. The force along an axis is sampled up to this
/// distance.
const FAR: f64 = 1.0;

/// Where particles rest, one for each of P starting points. A particle that is not trapped has only `place`; its other values
/// are NaN.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rest {
    /// The place (P, 3) in m where the net force is 0; for a particle that is not trapped, where it was lost.
    pub place: Vec<[f64; 3]>,
    /// Whether the particle is trapped at the place (P,): within a wavelength of the start, the net force pushes it back from
    /// all sides.
    pub held: Vec<bool>,
    /// Eigenvalues of the stiffness at the place (P, 3) in N/m, the smallest first.
    pub stiffness: Vec<[f64; 3]>,
    /// The unit vector of each eigenvalue (P, 3, 3).
    pub axes: Vec<[[f64; 3]; 3]>,
    /// The distance in m over which the net force pushes back, in the negative and the positive direction of each axis (P, 3,
    /// 2).
    pub basin: Vec<[[f64; 2]; 3]>,
    /// The largest force in N that pushes back over that distance (P, 3, 2).
    pub restoring: Vec<[[f64; 2]; 3]>,
}

/// Finds where particles that start at `points` (P, 3) in m come to rest, in the field of a drive (N,) with a `gravity` in
/// m/s^2. The search follows the net force, that of the sound plus weight less buoyancy, to a place where it is 0.
///
/// Each step is the net force times the inverse of |stiffness|, at most 1/48 of a wavelength, and never takes more work than it gives. The
/// basin is measured along straight lines in both directions of each axis, up to a wavelength.
///
/// # Errors
/// The errors of [`crate::gorkov`]; a gravity that is not finite.
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
    let all = settled(model, drive, points, Bead { particle, gravity }, true, control)?;
    Ok(Rest {
        place: all.iter().map(|one| one.place).collect(),
        held: all.iter().map(|one| one.held).collect(),
        stiffness: all.iter().map(|one| one.stiffness).collect(),
        axes: all.iter().map(|one| one.axes).collect(),
        basin: all.iter().map(|one| one.basin).collect(),
        restoring: all.iter().map(|one| one.restoring).collect(),
    })
}

/// Returns whether each bead is trapped, as [`rest`] judges it, in a tenth of the time.
///
/// # Errors
/// The errors of [`rest`].
pub(crate) fn trapped(
    model: &Model,
    drive: &[Complex32],
    points: &[[f64; 3]],
    bead: Bead,
    control: &mut Control,
) -> Result<Vec<bool>, Error> {
    Ok(settled(model, drive, points, bead, false, control)?.iter().map(|one| one.held).collect())
}

/// Returns the least force in N that pushes back a bead at rest, of those in the traps `chosen`, for a drive of the columns; 0
/// for an array on two sides, without obstacles, if a bead is lost, and where the force is unknown.
pub(crate) fn firmness(propagation: &Propagation, bead: Bead, chosen: &[usize], drive: &[Complex32]) -> f64 {
    let Some((array, points, Some(kept))) = propagation.origin() else { return 0.0 };
    let normals = array.normals();
    if kept.scattering.is_none() || normals.iter().any(|&normal| Vec3(normals[0]).dot(normal) < 0.0) {
        return 0.0;
    }
    let spread = kept.channels.as_ref().map(|channels| channels.spread(drive));
    let places: Vec<[f64; 3]> = chosen.iter().map(|&j| points[j]).collect();
    let drive = spread.as_deref().unwrap_or(drive);
    let resting = settled(&Model::of_recipe(kept), drive, &places, bead, true, &mut Control::none());
    resting
        .ok()
        .filter(|all| all.iter().all(|one| one.held))
        .map_or(0.0, |all| all.iter().flat_map(|one| one.restoring).flatten().fold(f64::INFINITY, f64::min))
}

/// Returns where the beads come to rest, and how stable they are there if that is `measured`.
fn settled(
    model: &Model,
    drive: &[Complex32],
    points: &[[f64; 3]],
    Bead { particle, gravity }: Bead,
    measured: bool,
    control: &mut Control,
) -> Result<Vec<One>, Error> {
    let trap = Trap::new(model, drive, points, particle)?;
    vector("gravity", &gravity)?;
    control.room("the resting places", [drive.len(), points.len()], bytes(2 * size_of::<One>(), &[points.len()]))?;
    let weight = Vec3(particle.weight(model.medium(), gravity));
    let follow = Follow { trap: &trap, weight, wavelength: model.medium().wavelength(), measured };
    let mut all: Vec<Option<One>> = vec![None; points.len()];
    let parts = all.iter_mut().zip(points).enumerate().collect();
    control.each(parts, &|(j, (out, point)): (usize, (&mut Option<One>, &[f64; 3])), control| {
        // It is an error if the force at a start is unknown. A particle that moves to such a place is lost.
        trap.push(j, *point, control)?;
        *out = Some(follow.from(j, *point, control)?);
        Ok(())
    })?;
    Ok(all.into_iter().flatten().collect())
}

/// Returns the place near a point where a trap exerts a `force` in N on a bead in addition to the one against its
/// weight. This is the place where the bead rests under a gravity that is changed by this force. Returns `None` if
/// there is none.
///
/// # Errors
/// The errors of [`rest`].
pub fn poised(
    model: &Model,
    drive: &[Complex32],
    point: [f64; 3],
    Bead { particle, gravity }: Bead,
    force: [f64; 3],
    control: &mut Control,
) -> Result<Option<[f64; 3]>, Error> {
    let heft = particle.weight(model.medium(), [1.0; 3])[0];
    let gravity = (Vec3(gravity) - Vec3(force) / heft).0;
    let rest = rest(model, drive, &[point], particle, gravity, control)?;
    let near = Vec3(rest.place[0]).distance(point) < 0.5 * model.medium().wavelength();
    Ok((rest.held[0] && near).then_some(rest.place[0]))
}

/// The results for one particle.
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
    fn lost(Vec3(place): Vec3) -> Self {
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

/// Follows a particle in a field, with its weight.
struct Follow<'a> {
    trap: &'a Trap<'a>,
    weight: Vec3,
    wavelength: f64,
    measured: bool,
}

impl Follow<'_> {
    /// Net force and stiffness at a place; `None` if the force there is unknown.
    fn net(&self, j: usize, place: Vec3, control: &mut Control) -> Result<Option<Push>, Error> {
        match self.trap.push(j, place.0, control) {
            Ok(push) => Ok(Some(Push { force: push.force + self.weight, ..push })),
            Err(error) if error.is_stop() => Err(error),
            Err(_) => Ok(None),
        }
    }

    fn from(&self, j: usize, start: [f64; 3], control: &mut Control) -> Result<One, Error> {
        let (mut place, mut most) = (Vec3(start), STEP * self.wavelength);
        let Some(mut here) = self.net(j, place, control)? else { return Ok(One::lost(place)) };
        for _ in 0..STEPS {
            let (stiffness, axes) = eigen(here.hessian);
            let step = step(here.force, stiffness, axes, most);
            let length = step.norm();
            let next = place + step;
            if length < STILL * self.wavelength {
                let stable = stiffness.iter().all(|&k| k > 0.0);
                let unmeasured = One { held: stable, ..One::lost(next) };
                return if stable && self.measured {
                    self.held(j, next, stiffness, axes, control)
                } else {
                    Ok(unmeasured)
                };
            }
            if next.distance(start) > FAR * self.wavelength {
                return Ok(One::lost(next));
            }
            let Some(there) = self.net(j, next, control)? else { return Ok(One::lost(next)) };
            // The work along the step, by the mean of both forces.
            if (here.force + there.force).dot(step.0) < 0.0 && length > 1e3 * STILL * self.wavelength {
                most = 0.5 * length;
                continue;
            }
            (place, here) = (next, there);
        }
        Ok(One::lost(place))
    }

    /// Measures the stability at a place, in both directions along each axis.
    fn held(
        &self,
        j: usize,
        place: Vec3,
        stiffness: [f64; 3],
        axes: [[f64; 3]; 3],
        control: &mut Control,
    ) -> Result<One, Error> {
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| stiffness[a].total_cmp(&stiffness[b]));
        let axes = order.map(|k| axes[k]);
        let (mut basin, mut restoring) = ([[0.0; 2]; 3], [[0.0; 2]; 3]);
        for (k, axis) in axes.iter().enumerate() {
            for (way, sign) in [-1.0, 1.0].into_iter().enumerate() {
                [basin[k][way], restoring[k][way]] = self.along(j, place, sign * Vec3(*axis), control)?;
            }
        }
        Ok(One { place: place.0, held: true, stiffness: order.map(|k| stiffness[k]), axes, basin, restoring })
    }

    /// Returns the distance over which the net force pushes back along a direction, and the largest such force.
    fn along(&self, j: usize, place: Vec3, way: Vec3, control: &mut Control) -> Result<[f64; 2], Error> {
        let h = STEP * self.wavelength;
        let (mut last, mut before, mut most) = (0.0, 0.0, 0.0_f64);
        for n in 1..=(FAR / STEP) as usize {
            let at = place + n as f64 * h * way;
            let Some(push) = self.net(j, at, control)? else { return Ok([(n - 1) as f64 * h, most]) };
            let back = -push.force.dot(way);
            // The maximum of the parabola through three neighbouring samples.
            if last > before && last >= back {
                let bend = before - 2.0 * last + back;
                most = most.max(last - (back - before) * (back - before) / (8.0 * bend));
            }
            most = most.max(back);
            if back <= 0.0 {
                return Ok([h * ((n - 1) as f64 + last / (last - back)), most]);
            }
            (before, last) = (last, back);
        }
        Ok([FAR * self.wavelength, most])
    }
}

/// Returns the step |H|^-1 net, shortened to at most `most`. With |H| instead of H, the step follows the force also along axes
/// of negative stiffness.
fn step(net: Vec3, stiffness: [f64; 3], axes: [[f64; 3]; 3], most: f64) -> Vec3 {
    let mut step = Vec3::default();
    for (k, axis) in stiffness.iter().zip(&axes) {
        let share = net.dot(*axis) / k.abs().max(f64::MIN_POSITIVE);
        step = step + share.clamp(-1.0, 1.0) * Vec3(*axis);
    }
    let length = step.norm();
    if length > most { most * step / length } else { step }
}

#[cfg(test)]
#[path = "tests/rest.rs"]
mod tests;
