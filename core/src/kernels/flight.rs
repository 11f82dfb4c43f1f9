//! Flight: eight beads step by step, in forces that are polynomials around places that move.
//!
//! Adams' method of order 4 for x'' = a(t, x, x'), with one acceleration a step of length h: places and speeds are
//! predicted from the last four accelerations, and corrected by the one that the bead then has.
//!
//! ```text
//! x1 = x + h v + h^2/360 (323 a - 264 a' + 159 a'' - 38 a''')   v1 = v + h/24 (55 a - 59 a' + 37 a'' - 9 a''')
//! x+ = x + h v + h^2/360 (38 a1 + 171 a - 36 a' + 7 a'')        v+ = v + h/24 (9 a1 + 19 a - 5 a' + a''),   a1 = a(t + h, x1, v1)
//! ```
#![allow(clippy::needless_range_loop, reason = "counted loops keep their values in registers")]

use alloc::vec::Vec;

use crate::kernels::simd::doubles::{Doubles, EIGHT, Eight, V};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};

/// Monomials x^a y^b z^c of degree up to 6, in the order of [`super::derivatives::TERMS`].
pub(crate) const TERMS: usize = 84;

/// Forces on eight beads in N: of each monomial its coefficient along x, y and z.
pub(crate) type Forces = [[Eight; 3]; TERMS];

/// Vectors of eight beads.
pub(crate) type Vectors = [Eight; 3];

/// The other accelerations of beads: all but the forces.
#[derive(Clone, Debug)]
pub(crate) struct Laws {
    /// 1/m in 1/kg.
    pub(crate) lightness: f64,
    /// Weight less buoyancy, over the mass, in m/s^2.
    pub(crate) gravity: [f64; 3],
    /// Drag over mass and speed in 1/s, by speed; above the last it stays.
    pub(crate) drag: Vec<f64>,
    /// Number of steps in 1 m/s.
    pub(crate) finest: f64,
    /// The length that monomials are counted in, in m.
    pub(crate) unit: f64,
    /// h in s.
    pub(crate) step: f64,
}

/// Eight beads: `place`, `speed` and the last four accelerations, the newest first.
pub(crate) struct Beads<'a> {
    pub(crate) place: &'a mut Vectors,
    pub(crate) speed: &'a mut Vectors,
    pub(crate) pulls: &'a mut [Vectors; 4],
    /// Squares of the distances in m^2 from the centres at which a step is the last.
    pub(crate) reach: Eight,
}

/// Goes from step `first` on over the `centres` of polynomials, one a step and one to begin with, while forces go straight from
/// the first ones to the others. Returns the step that was the last: all, or the first after which a bead is out of reach.
pub(crate) fn advance(
    set: InstructionSet,
    laws: &Laws,
    forces: [&Forces; 2],
    centres: &[Vectors],
    first: usize,
    beads: &mut Beads<'_>,
) -> usize {
    dispatch!(set, s => {
        for i in first + 1..centres.len() {
            let share = i as f64 / (centres.len() - 1) as f64;
            for at in (0..EIGHT).step_by(width(s)) {
                step(s, laws, (forces, share), &centres[i], at, beads);
            }
            if beads.far(&centres[i]) {
                return i;
            }
        }
        centres.len() - 1
    })
}

/// Sets all accelerations to those of the first step's forces: before it, beads moved as they do then.
pub(crate) fn begin(set: InstructionSet, laws: &Laws, forces: &Forces, centre: &Vectors, beads: &mut Beads<'_>) {
    dispatch!(set, s => {
        for at in (0..EIGHT).step_by(width(s)) {
            let at = at.min(EIGHT - width(s));
            let of = |all: &Vectors| [V::of(s, &all[0][at..]), V::of(s, &all[1][at..]), V::of(s, &all[2][at..])];
            let (place, speed) = (of(beads.place), of(beads.speed));
            let pull = pull(s, laws, ([forces, forces], 0.0), (centre, at), place, speed);
            for pulls in &mut *beads.pulls {
                for axis in 0..3 {
                    pull[axis].put(&mut pulls[axis][at..]);
                }
            }
        }
    });
}

impl Beads<'_> {
    pub(crate) fn far(&self, centre: &Vectors) -> bool {
        let square = |i: usize| (0..3).map(|axis| self.place[axis][i] - centre[axis][i]).map(|x| x * x).sum::<f64>();
        (0..EIGHT).any(|i| square(i) > self.reach[i])
    }
}

#[inline(always)]
fn width<S: Doubles>(_: S) -> usize {
    S::WIDTH
}

#[inline(always)]
fn step<S: Doubles>(
    s: S,
    laws: &Laws,
    forces: ([&Forces; 2], f64),
    centre: &Vectors,
    at: usize,
    beads: &mut Beads<'_>,
) {
    // Facts that the compiler needs to leave out checks of loads.
    let at = at.min(EIGHT - S::WIDTH);
    let of = |all: &Vectors| [V::of(s, &all[0][at..]), V::of(s, &all[1][at..]), V::of(s, &all[2][at..])];
    let (place, speed) = (of(beads.place), of(beads.speed));
    let [a, b, c, d] = [of(&beads.pulls[0]), of(&beads.pulls[1]), of(&beads.pulls[2]), of(&beads.pulls[3])];
    let (h, half) = (laws.step / 24.0, laws.step * laws.step / 360.0);
    let (mut there, mut then) = (place, speed);
    for i in 0..3 {
        there[i] = place[i] + speed[i] * laws.step + (a[i] * 323.0 - b[i] * 264.0 + c[i] * 159.0 - d[i] * 38.0) * half;
        then[i] = speed[i] + (a[i] * 55.0 - b[i] * 59.0 + c[i] * 37.0 - d[i] * 9.0) * h;
    }
    let new = pull(s, laws, forces, (centre, at), there, then);
    for i in 0..3 {
        let corrected = (new[i] * 38.0 + a[i] * 171.0 - b[i] * 36.0 + c[i] * 7.0) * half;
        (place[i] + speed[i] * laws.step + corrected).put(&mut beads.place[i][at..]);
        (speed[i] + (new[i] * 9.0 + a[i] * 19.0 - b[i] * 5.0 + c[i]) * h).put(&mut beads.speed[i][at..]);
        for (pulls, pull) in beads.pulls.iter_mut().zip([new[i], a[i], b[i], c[i]]) {
            pull.put(&mut pulls[i][at..]);
        }
    }
}

/// The acceleration of beads.
#[inline(always)]
fn pull<S: Doubles>(
    s: S,
    laws: &Laws,
    (forces, share): ([&Forces; 2], f64),
    (centre, at): (&Vectors, usize),
    place: [V<S>; 3],
    speed: [V<S>; 3],
) -> [V<S>; 3] {
    let mut x = place;
    for i in 0..3 {
        x[i] = (place[i] - V::of(s, &centre[i][at..])) * (1.0 / laws.unit);
    }
    let monomials = monomials(V::all(s, 1.0), x);
    let [from, to] = forces;
    // Sums of even and of odd terms, so that they need not wait for one another.
    let mut sums = [[V::all(s, 0.0); 3]; 2];
    for t in (0..TERMS).step_by(2) {
        for (k, sum) in sums.iter_mut().enumerate() {
            for i in 0..3 {
                let before = V::of(s, &from[t + k][i][at..]);
                let own = before + (V::of(s, &to[t + k][i][at..]) - before) * share;
                sum[i] = sum[i] + own * monomials[t + k];
            }
        }
    }
    let [mut sum, odd] = sums;
    let fast = (speed[0] * speed[0] + speed[1] * speed[1] + speed[2] * speed[2]).sqrt();
    let [drag] = fast.each(|fast| [laws.dragged(fast)]);
    for i in 0..3 {
        sum[i] = (sum[i] + odd[i]) * laws.lightness + laws.gravity[i] - drag * speed[i];
    }
    sum
}

/// All monomials: those of a degree are those of the one before times x, the last of these times y, and the very last times z.
#[inline(always)]
fn monomials<S: Doubles>(one: V<S>, [x, y, z]: [V<S>; 3]) -> [V<S>; TERMS] {
    let mut all = [one; TERMS];
    let (mut below, mut next) = (0, 1);
    for degree in 1..7 {
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
    /// Drag over mass and speed at a speed, interpolated linearly between stored values.
    #[inline(always)]
    fn dragged(&self, speed: f64) -> f64 {
        let last = self.drag.len() - 1;
        let steps = speed * self.finest;
        let below = (steps as usize).min(last);
        let above = (below + 1).min(last);
        let share = (steps - below as f64).min(1.0);
        self.drag[below] + (self.drag[above] - self.drag[below]) * share
    }
}
