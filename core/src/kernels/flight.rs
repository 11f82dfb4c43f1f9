//! Flight: motion of eight beads step by step, in forces that are polynomials around moving centres.
//!
//! Adams' method of order 4 for x'' = a(t, x, x'), with one evaluation of the acceleration in each step of length h. It
//! predicts the place x1 and the velocity v1 from the last four accelerations a, a', a'', a''', the newest first. Then
//! it corrects them to x+ and v+ with the acceleration a1 at the predicted place.
//!
//! ```text
//! x1 = x + h v + h^2/360 (323 a - 264 a' + 159 a'' - 38 a''')   v1 = v + h/24 (55 a - 59 a' + 37 a'' - 9 a''')
//! a1 = a(t + h, x1, v1)
//! x+ = x + h v + h^2/360 (38 a1 + 171 a - 36 a' + 7 a'')        v+ = v + h/24 (9 a1 + 19 a - 5 a' + a'')
//! ```
//!
//! The drag on a sphere of radius a has three parts, with u the velocity of the bead:
//!
//! ```text
//! drag = 6 pi eta a (u + 0.15 Re(w)^0.687 w) + 6 a^2 sqrt(pi rho eta) int u'(s)/sqrt(t - s) ds,   w' = |u|/(2 a) (u - w)
//! ```
//!
//! The integral is the history force of the boundary layer (A. B. Basset, A Treatise on Hydrodynamics, 1888). 1/sqrt(t) is a
//! sum of [`MODES`] exponentials, so the integral is a sum of states h_k' = u' - s_k h_k. Within a step u' is constant. w is
//! the velocity to which the wake has adapted: it follows u while the bead moves by its diameter.
//!
//! Near the centre few terms of a force are enough: the terms above some degree are left out where they are small.

use crate::kernels::prelude::*;
use crate::kernels::simd::doubles::{Doubles, EIGHT, Eight, V};

/// Number of monomials x^a y^b z^c of degree up to 6, in the order of [`super::derivatives::TERMS`].
pub(crate) const TERMS: usize = 84;

/// The highest degree of the monomials.
const DEGREE: usize = 6;

/// Degrees at which the polynomial of a force may be cut off; the last one keeps all terms.
const ENDS: [usize; 5] = [2, 3, 4, 5, DEGREE];

/// Largest change of a force by terms that are left out, relative to its linear terms one unit from the centre.
const LEAST: f64 = 1e-5;

/// Number of bisection steps in the search of [`Radii`]: ten steps find a radius within a thousandth of a unit.
const BISECTIONS: usize = 10;

/// Number of exponentials that approximate 1/sqrt(t).
pub(crate) const MODES: usize = 8;

/// Forces on eight beads in N: the coefficients of each monomial along x, y and z.
pub(crate) type Forces = [[Eight; 3]; TERMS];

/// Largest coordinates from the centre, in units, at which the terms up to each degree of [`ENDS`] but the last
/// suffice.
pub(crate) type Radii = [f64; ENDS.len() - 1];

/// Vectors of eight beads: x, y and z.
pub(crate) type Vectors = [Eight; 3];

/// Constants of the motion of a bead, besides the forces of the sound.
#[derive(Clone, Debug)]
pub(crate) struct Laws {
    /// 1/m of the bead's mass m, in 1/kg.
    pub(crate) lightness: f64,
    /// Weight less buoyancy, over the mass, in m/s^2.
    pub(crate) gravity: [f64; 3],
    /// Stokes' friction over mass and speed in 1/s.
    pub(crate) friction: f64,
    /// Drag of the wake over mass and speed in 1/s, at equal steps of speed from 0 on. The last value holds for higher
    /// speeds.
    pub(crate) drag: Vec<f64>,
    /// The exponentials of the boundary layer.
    pub(crate) layers: [Layer; MODES],
    /// The time step over the diameter, in s/m.
    pub(crate) passed: f64,
    /// Number of steps of `drag` in 1 m/s.
    pub(crate) finest: f64,
    /// The unit of length of the monomials, in m.
    pub(crate) unit: f64,
    /// The time step h in s.
    pub(crate) step: f64,
}

/// An exponential e^(-s t) of the boundary layer, for a step of length h.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer {
    /// Its acceleration over its state, in 1/s.
    pub(crate) weight: f64,
    /// e^(-s h).
    pub(crate) left: f64,
    /// The share (1 - e^(-s h))/(s h) of a change of velocity within a step that the state has after it.
    pub(crate) gained: f64,
}

/// State of eight beads: places, velocities, velocities of the wakes, the last four accelerations, the newest first, and the
/// states of the boundary layer.
pub(crate) struct Beads<'a> {
    pub(crate) place: &'a mut Vectors,
    pub(crate) speed: &'a mut Vectors,
    pub(crate) wake: &'a mut Vectors,
    pub(crate) layers: &'a mut [Vectors; MODES],
    pub(crate) pulls: &'a mut [Vectors; 4],
    /// Square of each bead's largest distance from its centre, in m^2, up to which the flight continues; NaN in a lane
    /// without a bead.
    pub(crate) reach: Eight,
}

/// A force that changes linearly: the `share` of the way between two forces.
struct Change<'a> {
    from: &'a Forces,
    to: &'a Forces,
    share: f64,
}

/// Moves the beads from step `first` on along the `centres` of the polynomials, one for each step and one for the
/// start. The forces change linearly from the first to the second element of `forces`. Returns the last step: the step
/// of the last centre, or the first step after which a bead is out of reach.
pub(crate) fn advance(
    set: InstructionSet,
    laws: &Laws,
    forces: [&Forces; 2],
    radii: Radii,
    centres: &[Vectors],
    first: usize,
    beads: &mut Beads<'_>,
) -> usize {
    dispatch!(set, s => {
        for i in first + 1..centres.len() {
            let share = i as f64 / (centres.len() - 1) as f64;
            let ahead = predicted(s, laws, beads);
            let force = Change { from: forces[0], to: forces[1], share };
            let apart = beads.apart(&ahead[0], &centres[i], laws.unit);
            match radii.iter().filter(|&&radius| radius < apart).count() {
                0 => correct::<_, 2>(s, laws, &force, &centres[i], &ahead, beads),
                1 => correct::<_, 3>(s, laws, &force, &centres[i], &ahead, beads),
                2 => correct::<_, 4>(s, laws, &force, &centres[i], &ahead, beads),
                3 => correct::<_, 5>(s, laws, &force, &centres[i], &ahead, beads),
                _ => correct::<_, DEGREE>(s, laws, &force, &centres[i], &ahead, beads),
            }
            if beads.far(&centres[i]) {
                return i;
            }
        }
        centres.len() - 1
    })
}

/// Returns, for each force, the coordinates up to which short polynomials are accurate enough.
pub(crate) fn radii(set: InstructionSet, forces: &[Forces]) -> Vec<Radii> {
    dispatch!(set, s => {
        let _ = s;
        forces.iter().map(enough).collect()
    })
}

#[inline(always)]
fn enough(forces: &Forces) -> Radii {
    // For each degree, a bound on the sum of its terms one unit from the centre.
    let mut sums = [0.0_f64; DEGREE + 1];
    let mut first = 0;
    for (degree, sum) in sums.iter_mut().enumerate() {
        let terms = &forces[first..first + count(degree)];
        let mut lanes = [[0.0; EIGHT]; 3];
        for term in terms {
            for axis in 0..3 {
                for lane in 0..EIGHT {
                    lanes[axis][lane] += term[axis][lane].abs();
                }
            }
        }
        *sum = lanes.as_flattened().iter().fold(0.0, |most, lane| lane.max(most));
        first += terms.len();
    }
    core::array::from_fn(|end| {
        let after = |radius: f64| sums[ENDS[end] + 1..].iter().rev().fold(0.0, |all, sum| radius * (all + sum));
        let most = LEAST * sums[1];
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            let all = (0..ENDS[end]).fold(after(middle), |all, _| all * middle);
            if all <= most { low = middle } else { high = middle }
        }
        low
    })
}

/// Returns the number of monomials of a degree.
const fn count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// Sets all stored accelerations of the beads to the acceleration by the first forces, as if it had been constant.
pub(crate) fn begin(set: InstructionSet, laws: &Laws, forces: &Forces, centre: &Vectors, beads: &mut Beads<'_>) {
    dispatch!(set, s => {
        for at in (0..EIGHT).step_by(width(s)) {
            let at = at.min(EIGHT - width(s));
            let of = |all: &Vectors| [V::of(s, &all[0][at..]), V::of(s, &all[1][at..]), V::of(s, &all[2][at..])];
            let (place, speed) = (of(beads.place), of(beads.speed));
            let still = Change { from: forces, to: forces, share: 0.0 };
            let drag = dragged(s, laws, beads, at, speed, speed);
            let pull = pull::<_, DEGREE>(s, laws, &still, centre, at, place, drag);
            for pulls in &mut *beads.pulls {
                for axis in 0..3 {
                    pull[axis].put(&mut pulls[axis][at..]);
                }
            }
        }
    });
}

impl Beads<'_> {
    #[inline(always)]
    pub(crate) fn far(&self, centre: &Vectors) -> bool {
        let square = |i: usize| (0..3).map(|axis| self.place[axis][i] - centre[axis][i]).map(|x| x * x).sum::<f64>();
        (0..EIGHT).any(|i| square(i) > self.reach[i])
    }

    /// Returns the largest coordinate of the beads at these places, relative to a centre, in units.
    #[inline(always)]
    fn apart(&self, places: &Vectors, centre: &Vectors, unit: f64) -> f64 {
        let mut most = 0.0_f64;
        for axis in 0..3 {
            for i in 0..EIGHT {
                let apart = (places[axis][i] - centre[axis][i]).abs();
                most = if apart > most && !self.reach[i].is_nan() { apart } else { most };
            }
        }
        most / unit
    }
}

#[inline(always)]
fn width<S: Doubles>(_: S) -> usize {
    S::WIDTH
}

/// Returns the predicted places and velocities of all beads after a step.
#[inline(always)]
fn predicted<S: Doubles>(s: S, laws: &Laws, beads: &Beads<'_>) -> [Vectors; 2] {
    let mut ahead = [[[0.0; EIGHT]; 3]; 2];
    let (h, half) = (laws.step / 24.0, laws.step * laws.step / 360.0);
    for at in (0..EIGHT).step_by(width(s)) {
        // This limit does not change `at`; with it, the compiler omits the bounds checks of the loads.
        let at = at.min(EIGHT - S::WIDTH);
        for i in 0..3 {
            let [place, speed] = [&beads.place, &beads.speed].map(|all| V::of(s, &all[i][at..]));
            let [a, b, c, d] = beads.pulls.each_ref().map(|all| V::of(s, &all[i][at..]));
            let there = (a * 323.0 - b * 264.0 + c * 159.0 - d * 38.0) * half;
            (place + speed * laws.step + there).put(&mut ahead[0][i][at..]);
            (speed + (a * 55.0 - b * 59.0 + c * 37.0 - d * 9.0) * h).put(&mut ahead[1][i][at..]);
        }
    }
    ahead
}

/// Completes a step with the terms up to degree D of the forces, at the predicted places and velocities `ahead`.
#[inline(always)]
fn correct<S: Doubles, const D: usize>(
    s: S,
    laws: &Laws,
    force: &Change<'_>,
    centre: &Vectors,
    ahead: &[Vectors; 2],
    beads: &mut Beads<'_>,
) {
    let (h, half) = (laws.step / 24.0, laws.step * laws.step / 360.0);
    for at in (0..EIGHT).step_by(width(s)) {
        let at = at.min(EIGHT - S::WIDTH);
        let of = |all: &Vectors| [V::of(s, &all[0][at..]), V::of(s, &all[1][at..]), V::of(s, &all[2][at..])];
        let (place, speed) = (of(beads.place), of(beads.speed));
        let drag = dragged(s, laws, beads, at, speed, of(&ahead[1]));
        let new = pull::<_, D>(s, laws, force, centre, at, of(&ahead[0]), drag);
        let [a, b, c, _] = [of(&beads.pulls[0]), of(&beads.pulls[1]), of(&beads.pulls[2]), of(&beads.pulls[3])];
        for i in 0..3 {
            let corrected = (new[i] * 38.0 + a[i] * 171.0 - b[i] * 36.0 + c[i] * 7.0) * half;
            (place[i] + speed[i] * laws.step + corrected).put(&mut beads.place[i][at..]);
            let change = (new[i] * 9.0 + a[i] * 19.0 - b[i] * 5.0 + c[i]) * h;
            (speed[i] + change).put(&mut beads.speed[i][at..]);
            for (layer, state) in laws.layers.iter().zip(&mut *beads.layers) {
                (V::of(s, &state[i][at..]) * layer.left + change * layer.gained).put(&mut state[i][at..]);
            }
            for (pulls, pull) in beads.pulls.iter_mut().zip([new[i], a[i], b[i], c[i]]) {
                pull.put(&mut pulls[i][at..]);
            }
        }
        let wake = adapted(laws, of(beads.wake), of(beads.speed));
        (0..3).for_each(|i| wake[i].put(&mut beads.wake[i][at..]));
    }
}

/// Returns the velocity of the wake after a step at whose end the bead has this velocity.
#[inline(always)]
fn adapted<S: Doubles>(laws: &Laws, wake: [V<S>; 3], speed: [V<S>; 3]) -> [V<S>; 3] {
    let passed = length(speed) * laws.passed;
    let share = passed * (passed + 1.0).inverse();
    let mut after = wake;
    for i in 0..3 {
        after[i] = wake[i] + (speed[i] - wake[i]) * share;
    }
    after
}

#[inline(always)]
fn length<S: Doubles>(x: [V<S>; 3]) -> V<S> {
    (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt()
}

/// Returns the deceleration by drag after a step in which the velocity changes from `before` to `speed`.
#[inline(always)]
fn dragged<S: Doubles>(
    s: S,
    laws: &Laws,
    beads: &Beads<'_>,
    at: usize,
    before: [V<S>; 3],
    speed: [V<S>; 3],
) -> [V<S>; 3] {
    let of = |all: &Vectors| [V::of(s, &all[0][at..]), V::of(s, &all[1][at..]), V::of(s, &all[2][at..])];
    let wake = adapted(laws, of(beads.wake), speed);
    let [slow] = length(wake).each(|speed| [laws.of_wake(speed)]);
    let mut drag = speed;
    for i in 0..3 {
        let change = speed[i] - before[i];
        drag[i] = speed[i] * laws.friction + slow * wake[i];
        for (layer, state) in laws.layers.iter().zip(&*beads.layers) {
            let after = V::of(s, &state[i][at..]) * layer.left + change * layer.gained;
            drag[i] = drag[i] + after * layer.weight;
        }
    }
    drag
}

/// Returns the acceleration of beads: the terms of a force up to degree D over the mass, gravity and drag.
#[inline(always)]
fn pull<S: Doubles, const D: usize>(
    s: S,
    laws: &Laws,
    change: &Change<'_>,
    centre: &Vectors,
    at: usize,
    place: [V<S>; 3],
    drag: [V<S>; 3],
) -> [V<S>; 3] {
    let mut x = place;
    for i in 0..3 {
        x[i] = (place[i] - V::of(s, &centre[i][at..])) * (1.0 / laws.unit);
    }
    let monomials = monomials::<_, D>(V::all(s, 1.0), x);
    // Sums of the even and of the odd terms. The two sums are independent, so the processor adds both at once.
    let mut sums = [[V::all(s, 0.0); 3]; 2];
    let terms = (D + 1) * (D + 2) * (D + 3) / 6;
    for t in 0..terms {
        let sum = &mut sums[t % 2];
        for i in 0..3 {
            let before = V::of(s, &change.from[t][i][at..]);
            let force = before + (V::of(s, &change.to[t][i][at..]) - before) * change.share;
            sum[i] = sum[i] + force * monomials[t];
        }
    }
    let [mut sum, odd] = sums;
    for i in 0..3 {
        sum[i] = (sum[i] + odd[i]) * laws.lightness + laws.gravity[i] - drag[i];
    }
    sum
}

/// Returns the monomials up to degree D; the later elements are 1. The monomials of a degree follow from those of the
/// degree below: all of them times x, then those without x times y, then the last one times z.
#[inline(always)]
fn monomials<S: Doubles, const D: usize>(one: V<S>, [x, y, z]: [V<S>; 3]) -> [V<S>; TERMS] {
    let mut all = [one; TERMS];
    let (mut below, mut next) = (0, 1);
    for degree in 1..=D {
        let count = degree * (degree + 1) / 2;
        for k in 0..count {
            all[next + k] = all[below + k] * x;
        }
        for k in 0..degree {
            all[next + count + k] = all[next - degree + k] * y;
        }
        all[next + count + degree] = all[next - 1] * z;
        below = next;
        next += count + degree + 1;
    }
    all
}

impl Laws {
    /// Returns the drag of the wake over mass and speed at a speed, interpolated linearly between stored values.
    #[inline(always)]
    fn of_wake(&self, speed: f64) -> f64 {
        let last = self.drag.len() - 1;
        let steps = speed * self.finest;
        let below = (steps as usize).min(last);
        let above = (below + 1).min(last);
        let share = (steps - below as f64).min(1.0);
        self.drag[below] + (self.drag[above] - self.drag[below]) * share
    }
}
