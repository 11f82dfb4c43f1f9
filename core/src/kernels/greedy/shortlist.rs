//! Which candidates may be the best, as far as the moments tell.
//!
//! Small grids are met whole; for large ones see [`crate::kernels::greedy::large_grid`].

use crate::kernels::greedy::moments::Moments;
use crate::kernels::greedy::search;
use crate::kernels::greedy::search::{Candidates, L2, Points};
use crate::kernels::lanes::{LANES, Lanes};
use crate::kernels::simd::Simd;
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

/// The energies' changes to the third order by the moments, and by eq. (7) at the points that these leave out.
struct Changes<'a, S: Simd> {
    s: S,
    points: Points<'a>,
    moments: &'a Moments,
    near: &'a [u32],
}

impl<S: Simd> Changes<'_, S> {
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
}

/// The candidates met so far that may be the best, in rising order.
pub(crate) struct List<'a> {
    pub(crate) slack: f32,
    pub(crate) least: f32,
    pub(crate) indices: &'a mut [u32],
    pub(crate) values: &'a mut [f32],
    pub(crate) count: usize,
}

impl List<'_> {
    /// Meets 16 candidates, of which the first `used` are listed, as numbers from `index` on.
    #[inline(always)]
    pub(crate) fn meet<S: Simd>(&mut self, s: S, changes: S::V, index: usize, used: usize) {
        // Lanes beyond are copies of a candidate, or candidates of another stretch.
        self.least = self.least.min(-s.reduce_max(s.sub(s.splat(0.0), changes)));
        let mut bits = !s.less(s.splat(self.least + self.slack), changes) & (0xffff >> (LANES - used));
        if bits == 0 {
            return;
        }
        let mut lanes: Lanes = [0.0; LANES];
        s.store(changes, &mut lanes);
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            if self.count == self.indices.len() {
                self.sift();
            }
            if self.count < self.indices.len() {
                self.indices[self.count] = (index + lane) as u32;
                self.values[self.count] = lanes[lane];
            }
            // Beyond the list's end they are only counted.
            self.count = (self.count + 1).min(self.indices.len() + 1);
        }
    }

    /// Drops what the least found since has ruled out, unless some were only counted.
    pub(crate) fn sift(&mut self) {
        if self.count > self.indices.len() {
            return;
        }
        let mut left = 0;
        for k in 0..self.count {
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
    let limit = s.add(s.reduce_min(changes), s.splat(moments.slack(1.0)));
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
    let energies = Changes { s, points, moments, near };
    let mut list = List { slack, least: f32::INFINITY, indices: close, values: floats, count: 0 };
    let phases = candidates.phases;
    for k in 0..candidates.amplitudes {
        let amplitude = candidates.amplitude(k);
        for first in (0..phases).step_by(LANES) {
            let changes = energies.meet(amplitude, candidates.sixteen(first));
            list.meet(s, changes, k * phases + first, LANES.min(phases - first));
        }
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
