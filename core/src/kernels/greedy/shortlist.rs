//! Shortlist: the candidates that the moments cannot distinguish from the best one.
//!
//! ```text
//! f(z) = change of the energy under z, third order          16 candidates in the lanes
//! slack = 2 R + rounding                                    uncertainty of the difference of two f
//! list = all z with f(z) <= min f + slack
//! best = the only one in the list, or the first of it by eq. (7)
//! ```
//!
//! 1. Up to 16 phases are one vector: the least lane and a comparison show whether another one is as good
//!    ([`clear_winner`]). This saves 8 to 14 % of a pass up to M = 16 points, and at N = 996 transducers, M = 64.
//! 2. The candidates of a list are evaluated with the points in the lanes ([`search::best_of`]), because most lists are
//!    short. With candidates in the lanes a list of two took as long as one of 16. This saves 5 to 15 % at N = 996, M =
//!    64 and 256, and a third at N = 400, M = 256.

use crate::kernels::greedy::candidates::{Candidates, L2};
use crate::kernels::greedy::energies::Energies;
use crate::kernels::greedy::search;
use crate::kernels::prelude::*;

/// Largest length of a list.
pub(crate) const MOST: usize = 256;

/// Returns whether the candidates are at most 16 phases of one amplitude.
#[inline(always)]
pub(crate) fn few(candidates: &Candidates) -> bool {
    candidates.amplitudes == 1 && candidates.phases <= LANES
}

/// Returns the best candidate, or `None` if the transducer has no effect. `floats` and `indices` have room for
/// [`MOST`].
#[inline(always)]
pub(crate) fn best<S: Simd>(energies: &Energies<'_, S>, floats: &mut [f32], indices: &mut [u32]) -> Option<usize> {
    if energies.moments.power() == 0.0 {
        return None;
    }
    if energies.near.is_empty()
        && few(energies.candidates)
        && let Some(index) = clear_winner(energies)
    {
        return Some(index);
    }
    shortlist(energies, floats, indices).best(energies)
}

/// Returns the best of up to 16 phases if the moments leave no point out and no other phase is as good within their
/// slack.
#[inline(always)]
fn clear_winner<S: Simd>(energies: &Energies<'_, S>) -> Option<usize> {
    let (s, moments, candidates) = (energies.s, energies.moments, energies.candidates);
    let changes = Energies { near: &[], ..*energies }.roughly(candidates.drives(1.0, 0));
    let limit = s.add(s.reduce_min(changes), s.splat(moments.slack(1.0)));
    let bits = !s.less(limit, changes) & (0xffff >> (LANES - candidates.phases));
    bits.is_power_of_two().then(|| bits.trailing_zeros() as usize)
}

/// Lists the candidates that may be the best.
#[inline(always)]
pub(crate) fn shortlist<'a, S: Simd>(
    energies: &Energies<'_, S>,
    floats: &'a mut [f32],
    indices: &'a mut [u32],
) -> List<'a> {
    let (s, candidates) = (energies.s, energies.candidates);
    let slack = 2.0 * energies.moments.remainder() + energies.rounding();
    let mut list = List::new(slack, floats, indices);
    let phases = candidates.phases;
    for k in 0..candidates.amplitudes {
        for first in (0..phases).step_by(LANES) {
            let z = candidates.drives(candidates.amplitude(k), first);
            list.push(s, energies.roughly(z), k * phases + first, LANES.min(phases - first));
        }
    }
    list.sift();
    list
}

/// The candidates evaluated so far that may be the best, in ascending order of their indices.
pub(crate) struct List<'a> {
    /// Largest excess over the least change with which a candidate may still be the best.
    pub(crate) slack: f32,
    pub(crate) least: f32,
    indices: &'a mut [u32],
    values: &'a mut [f32],
    /// The number of candidates. If it is larger than the list by one, candidates were dropped because the list was
    /// full.
    pub(crate) count: usize,
}

impl<'a> List<'a> {
    pub(crate) fn new(slack: f32, values: &'a mut [f32], indices: &'a mut [u32]) -> Self {
        Self { slack, least: f32::INFINITY, indices, values, count: 0 }
    }

    /// Adds those of 16 candidates that may be the best, given their changes. The first `used` of them have the indices
    /// from `index` on. The others are copies of candidates or belong to another arc.
    #[inline(always)]
    pub(crate) fn push<S: Simd>(&mut self, s: S, changes: S::V, index: usize, used: usize) {
        self.least = self.least.min(s.least(changes));
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
            self.count = (self.count + 1).min(self.indices.len() + 1);
        }
    }

    /// Adds a candidate without its change, which is no longer needed.
    #[inline(always)]
    pub(crate) fn add(&mut self, index: usize) {
        self.indices[self.count] = index as u32;
        self.count += 1;
    }

    /// Removes the candidates that the present least change excludes. Does nothing if candidates were dropped because
    /// the list was full.
    pub(crate) fn sift(&mut self) {
        let limit = self.least + self.slack;
        // Values that are not numbers stay.
        self.retain(|_, value| value.partial_cmp(&limit) != Some(core::cmp::Ordering::Greater));
    }

    /// Removes the candidates that `wanted` rejects by their index and change. Does nothing if candidates were dropped
    /// because the list was full.
    #[inline(always)]
    pub(crate) fn retain(&mut self, mut keep: impl FnMut(usize, f32) -> bool) {
        if !self.overflows() {
            let mut left = 0;
            for k in 0..self.count {
                if keep(self.indices[k] as usize, self.values[k]) {
                    (self.indices[left], self.values[left]) = (self.indices[k], self.values[k]);
                    left += 1;
                }
            }
            self.count = left;
        }
    }

    /// Returns whether there were more candidates than room.
    pub(crate) fn overflows(&self) -> bool {
        self.count > self.indices.len()
    }

    /// Returns the only candidate, or the first best one by eq. (7); `None` if the transducer has no effect.
    #[inline(always)]
    pub(crate) fn best<S: Simd>(&mut self, energies: &Energies<'_, S>) -> Option<usize> {
        if self.count == 1 {
            return Some(self.indices[0] as usize);
        }
        let (s, points, candidates) = (energies.s, energies.points, energies.candidates);
        let tolerance = search::tolerance::<S, L2>(s, points);
        if tolerance == 0.0 {
            None
        } else if self.overflows() {
            Some(search::best::<S, L2>(s, points, candidates, false, tolerance))
        } else {
            let best = s.aside(
                #[inline(always)]
                || search::best_of(s, points, candidates, self.indices(), tolerance),
            );
            Some(best)
        }
    }

    /// Returns the first candidate of the list that changes the energy by at most `limit`; `None` if candidates were
    /// dropped because the list was full.
    #[inline(always)]
    pub(crate) fn first_below(&self, limit: f32) -> Option<usize> {
        let at = self.values.get(..self.count)?.iter().position(|&value| value <= limit)?;
        Some(self.indices[at] as usize)
    }

    /// Sorts the indices in ascending order.
    pub(crate) fn sort(&mut self) {
        if !self.overflows() {
            self.indices().sort_unstable();
        }
    }

    /// Returns the indices of the list.
    pub(crate) fn indices(&mut self) -> &mut [u32] {
        &mut self.indices[..self.count]
    }
}
