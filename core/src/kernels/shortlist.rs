//! Which candidates may be the best, as far as the moments tell.
//!
//! Small grids are met whole. Of a large one every sixteenth of the phases is met first, at all amplitudes; the
//! energy's second derivative is bounded, so between two phases it cannot fall far below both, and only stretches
//! that may hold the best are met in full.

use super::moments::Moments;
use super::search::{self, Candidates, L2, Points};
use super::simd::Simd;
use super::{LANES, Lanes};
use crate::math::sqrtf;

/// What is left to decide between.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shortlist {
    /// The best by the moments.
    pub(crate) best: usize,
    /// How many are as good within the slack; above [`Shortlist::MOST`] they are not listed.
    pub(crate) count: usize,
    /// The largest distance of one of them from the best.
    pub(crate) reach: f32,
}

impl Shortlist {
    /// The longest list kept.
    pub(crate) const MOST: usize = 256;
}

/// Numbers of working memory for [`shortlist`].
pub(crate) fn floats(candidates: &Candidates) -> usize {
    Shortlist::MOST + SEEN * candidates.amplitudes
}

/// Phases met first of a large grid.
const COARSE: usize = LANES;

/// Room for what these give at one amplitude, and for the first of them once more.
const SEEN: usize = 2 * LANES;

/// From this many phases on it is worth looking twice.
const LARGE: usize = 64;

/// Whether every candidate of so many phases is met.
pub(crate) fn met_whole(phases: usize) -> bool {
    phases < LARGE
}

/// The energies' changes by the moments, and by eq. (7) at the points that these leave out.
struct Energies<'a, S: Simd> {
    s: S,
    points: Points<'a>,
    moments: &'a Moments,
    near: &'a [u32],
    candidates: &'a Candidates,
}

impl<S: Simd> Energies<'_, S> {
    /// The changes for 16 candidates.
    #[inline(always)]
    fn meet(&self, amplitude: f32, [cos, sin]: [&Lanes; 2]) -> S::V {
        let s = self.s;
        let a = s.splat(amplitude);
        let (re, im) = (s.mul(a, s.load(cos)), s.mul(a, s.load(sin)));
        let change = self.moments.change(s, re, im);
        if self.near.is_empty() {
            return change;
        }
        let some = self.near.iter().map(|&j| j as usize);
        search::add_changes::<S, L2>(s, self.points, some, [re, im], change)
    }

    /// A bound on the second derivative over the phase. A point left out has the term |P + e|^2 - 2 t |P + e|: the
    /// first part's is at most 2 a |P| |G|; the second is concave in |P + e|, which on an arc of length h is at most
    /// its chord plus a |G| h^2/8.
    fn curvature(&self, a: f32) -> f32 {
        let left_out = |&j: &u32| {
            let (kept, lane) = (&self.points.kept[j as usize / LANES], j as usize % LANES);
            let gain = self.points.gain[0][j as usize].abs() + self.points.gain[1][j as usize].abs();
            2.0 * a * kept.weight[lane] * gain * (kept.modulus[lane] + kept.target[lane])
        };
        self.moments.curvature(a) + self.near.iter().map(left_out).sum::<f32>()
    }
}

/// The candidates met so far that may be the best, in rising order.
struct List<'a> {
    slack: f32,
    least: f32,
    indices: &'a mut [u32],
    values: &'a mut [f32],
    count: usize,
}

impl List<'_> {
    /// Meets 16 candidates, of which the first `used` are listed, as numbers from `index` on.
    #[inline(always)]
    fn meet<S: Simd>(&mut self, s: S, changes: S::V, index: usize, used: usize) {
        // Lanes beyond are copies of a candidate, or candidates of another stretch.
        self.least = self.least.min(-s.greatest(s.sub(s.splat(0.0), changes)));
        let mut bits = !s.less(s.splat(self.least + self.slack), changes) & (0xffff >> (LANES - used));
        if bits == 0 {
            return;
        }
        let mut lanes: Lanes = [0.0; LANES];
        s.store(changes, &mut lanes);
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            if self.count == Shortlist::MOST {
                self.sift();
            }
            if self.count < Shortlist::MOST {
                self.indices[self.count] = (index + lane) as u32;
                self.values[self.count] = lanes[lane];
            }
            // Beyond the list's end they are only counted.
            self.count = (self.count + 1).min(Shortlist::MOST + 1);
        }
    }

    /// Drops what the least found since has ruled out.
    fn sift(&mut self) {
        let mut left = 0;
        for k in 0..self.count.min(Shortlist::MOST) {
            // Whatever cannot be compared stays.
            if self.values[k].partial_cmp(&(self.least + self.slack)) != Some(core::cmp::Ordering::Greater) {
                (self.indices[left], self.values[left]) = (self.indices[k], self.values[k]);
                left += 1;
            }
        }
        self.count = left;
    }
}

/// The best of up to 16 phases, if the moments leave no point out and no other phase is as good within their slack.
#[inline(always)]
pub(crate) fn clear_winner<S: Simd>(s: S, moments: &Moments, candidates: &Candidates) -> Option<usize> {
    let [cos, sin] = candidates.sixteen(0);
    let changes = moments.change(s, s.load(cos), s.load(sin));
    let limit = s.add(s.least(changes), s.splat(moments.slack(1.0)));
    let bits = !s.less(limit, changes) & (0xffff >> (LANES - candidates.phases));
    bits.is_power_of_two().then(|| bits.trailing_zeros() as usize)
}

/// The candidates within `slack` of the best, by the moments and by eq. (7) itself at the points `near`; their
/// indices are written into `close` in rising order.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "the state of one turn")]
pub(crate) fn shortlist<S: Simd>(
    s: S,
    points: Points<'_>,
    moments: &Moments,
    near: &[u32],
    candidates: &Candidates,
    slack: f32,
    floats: &mut [f32],
    close: &mut [u32],
) -> Shortlist {
    let energies = Energies { s, points, moments, near, candidates };
    let (values, seen) = floats.split_at_mut(Shortlist::MOST);
    let mut list = List { slack, least: f32::INFINITY, indices: close, values, count: 0 };
    let phases = candidates.phases;
    if met_whole(phases) {
        for k in 0..candidates.amplitudes {
            let amplitude = candidates.amplitude(k);
            for first in (0..phases).step_by(LANES) {
                let changes = energies.meet(amplitude, candidates.sixteen(first));
                list.meet(s, changes, k * phases + first, LANES.min(phases - first));
            }
        }
    } else {
        twice(&energies, &mut list, seen);
    }
    if list.count > 1 {
        list.sift();
    }
    if list.count > Shortlist::MOST {
        return Shortlist { best: 0, count: list.count, reach: 1.0 };
    }
    let (indices, values) = (&list.indices[..list.count], &list.values[..list.count]);
    let at = (0..list.count).reduce(|a, b| if values[b] < values[a] { b } else { a }).unwrap_or(0);
    let best = indices.get(at).map_or(0, |&index| index as usize);
    let [qr, qi] = candidates.drive(best);
    let distance = |&index: &u32| {
        let [zr, zi] = candidates.drive(index as usize);
        sqrtf((zr - qr) * (zr - qr) + (zi - qi) * (zi - qi))
    };
    let reach = if list.count > 1 { indices.iter().map(distance).fold(0.0, f32::max) } else { 0.0 };
    Shortlist { best, count: list.count, reach }
}

/// A large grid: coarse, and then fine where it matters.
#[inline(always)]
fn twice<S: Simd>(energies: &Energies<'_, S>, list: &mut List<'_>, seen: &mut [f32]) {
    let (s, candidates) = (energies.s, energies.candidates);
    let phases = candidates.phases;
    let start = |c: usize| c * phases / COARSE;
    let (mut cos, mut sin): (Lanes, Lanes) = ([0.0; LANES], [0.0; LANES]);
    for c in 0..COARSE {
        [cos[c], sin[c]] = candidates.phasor(start(c));
    }
    let mut lowest = s.splat(f32::INFINITY);
    for (k, seen) in seen.chunks_exact_mut(SEEN).enumerate() {
        let changes = energies.meet(candidates.amplitude(k), [&cos, &sin]);
        lowest = s.min(changes, lowest);
        let [first, again] = seen.as_chunks_mut().0 else { continue };
        s.store(changes, first);
        s.store(changes, again);
    }
    list.least = -s.greatest(s.sub(s.splat(0.0), lowest));
    // The best of all is near the best of these: met first, it rules out most others.
    let least = s.splat(list.least);
    let best = seen.chunks_exact(SEEN).enumerate().find_map(|(k, seen)| {
        let here = !s.less(least, s.load(window(seen, 0))) & 0xffff;
        (here != 0).then(|| (k, here.trailing_zeros() as usize))
    });
    if let Some((k, c)) = best {
        let around = (start(c) + phases - LANES / 2) % phases;
        let changes = energies.meet(candidates.amplitude(k), candidates.sixteen(around));
        list.least = list.least.min(-s.greatest(s.sub(s.splat(0.0), changes)));
    }
    let width = core::f32::consts::TAU * phases.div_ceil(COARSE) as f32 / phases as f32;
    let bend = energies.curvature(1.0) * width * width / 8.0;
    for (k, seen) in seen.chunks_exact(SEEN).enumerate() {
        let amplitude = candidates.amplitude(k);
        let lower = s.min(s.load(window(seen, 0)), s.load(window(seen, 1)));
        let limit = s.splat(list.least + list.slack + amplitude * bend);
        let mut stretches = !s.less(limit, lower) & 0xffff;
        while stretches != 0 {
            let c = stretches.trailing_zeros() as usize;
            stretches &= stretches - 1;
            let (first, end) = (start(c), start(c + 1));
            for l in (first..end).step_by(LANES) {
                let changes = energies.meet(amplitude, candidates.sixteen(l));
                list.meet(s, changes, k * phases + l, LANES.min(end - l));
            }
        }
    }
}

/// Sixteen numbers from a place on.
#[inline(always)]
fn window(list: &[f32], at: usize) -> &Lanes {
    list[at..].first_chunk().unwrap_or(&[0.0; LANES])
}
