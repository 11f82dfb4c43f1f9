//! Exact search: compares all candidates, or some, by the change of eq. (7); the first best one is chosen.
//!
//! The lanes contain sixteen candidates, and the loop goes over the points. So no point is padding and no sum runs
//! across lanes.

use core::marker::PhantomData;

use crate::kernels::greedy::candidates::{Candidates, PhaseRange, Sixteen, Term, rise};
use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::prelude::*;

/// The values at the points that the search needs: groups of pressures and targets, and the transducer's row of G.
#[derive(Clone, Copy)]
pub(crate) struct Points<'a> {
    pub(crate) groups: &'a [PointGroup],
    pub(crate) row: [&'a [f32]; 2],
    /// The number of points; the other lanes are padding.
    pub(crate) count: usize,
}

/// Returns the difference below which two energies count as equal; 0 if the transducer cannot change any term.
#[inline(always)]
pub(crate) fn tolerance<S: Simd, T: Term>(s: S, points: Points<'_>) -> f32 {
    EQUAL * s.reduce_max(largest::<S, T>(s, points, points.count))
}

/// Difference below which two energies count as equal, relative to the largest term: the rounding of f32.
pub(crate) const EQUAL: f32 = 1e-7;

/// Returns a bound of the largest term in each of the first `used` lanes. The other lanes contain 0 or a bound, too.
#[inline(always)]
pub(crate) fn largest<S: Simd, T: Term>(s: S, points: Points<'_>, used: usize) -> S::V {
    let mut bound = Bound::<T> { points, most: [0.0; LANES], term: PhantomData };
    s.apart(used, &mut bound);
    s.load(&bound.most)
}

struct Bound<'a, T> {
    points: Points<'a>,
    most: Lanes,
    term: PhantomData<T>,
}

impl<T: Term> Apart for Bound<'_, T> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let row = groups(self.points.row[0]).iter().zip(groups(self.points.row[1]));
        let mut most = s.splat(0.0);
        for ((re, im), group) in row.zip(self.points.groups) {
            let gain = s.add(s.abs(s.load(re)), s.abs(s.load(im)));
            let gap = s.sub(s.load(&group.target), s.load(&group.modulus));
            most = s.max(most, s.mul(s.load(&group.weight), T::bound(s, gain, gap)));
        }
        s.store(most, &mut self.most);
    }
}

/// Returns the change of all points' terms by each of 16 candidates.
#[inline(always)]
pub(crate) fn changes<S: Simd, T: Term>(s: S, points: Points<'_>, z: Sixteen<'_>) -> S::V {
    let mut changes = Changes::<T> { points, z, out: [0.0; LANES], term: PhantomData };
    s.apart(LANES, &mut changes);
    s.load(&changes.out)
}

struct Changes<'a, T> {
    points: Points<'a>,
    z: Sixteen<'a>,
    out: Lanes,
    term: PhantomData<T>,
}

impl<T: Term> Apart for Changes<'_, T> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let Points { groups, row, count } = self.points;
        let ([re, im], mut total) = (self.z.load(s), s.splat(0.0));
        for j in 0..count {
            let (gr, gi) = (s.splat(row[0][j]), s.splat(row[1][j]));
            let (group, lane) = (&groups[j / LANES], j % LANES);
            let old = [s.splat(group.re[lane]), s.splat(group.im[lane]), s.splat(group.modulus[lane])];
            let e = [s.fnma(gi, im, s.mul(gr, re)), s.fma(gi, re, s.mul(gr, im))];
            let gap = s.splat(group.target[lane] - group.modulus[lane]);
            total = s.fma(s.splat(group.weight[lane]), T::change(s, rise(s, old, e), gap), total);
        }
        s.store(total, &mut self.out);
    }
}

/// The best candidate so far.
#[derive(Clone, Copy)]
pub(crate) struct Winner {
    pub(crate) index: usize,
    change: f32,
}

impl Winner {
    /// The start, before any candidate is known.
    pub(crate) const NONE: Self = Self { index: 0, change: f32::INFINITY };

    /// Returns this candidate or the best of 16 further ones: the first that no other beats by more than `tolerance`.
    #[inline(always)]
    pub(crate) fn or<S: Simd>(self, s: S, changes: S::V, index: impl Fn(usize) -> usize, tolerance: f32) -> Self {
        let least = s.least(changes);
        // The comparison is written so that an infinite change does not replace the first candidate.
        if self.change - least <= tolerance {
            return self;
        }
        let beyond = s.less(s.splat(least + tolerance), changes);
        let lane = (!beyond & 0xffff).trailing_zeros().min(15) as usize;
        let mut lanes: Lanes = [0.0; LANES];
        s.store(changes, &mut lanes);
        Self { index: index(lane), change: lanes[lane] }
    }
}

/// Returns the index of the first candidate that no other beats by more than `tolerance`. If the field is `silent`,
/// only the amplitudes matter, and phase 0 is taken.
#[inline(always)]
pub(crate) fn best<S: Simd, T: Term>(
    s: S,
    points: Points<'_>,
    candidates: &Candidates,
    silent: bool,
    tolerance: f32,
) -> usize {
    let (phases, amplitudes) = (candidates.phases, candidates.amplitudes);
    let mut winner = Winner::NONE;
    if silent {
        for first in (0..amplitudes).step_by(LANES) {
            let at = |lane: usize| (first + lane).min(amplitudes - 1);
            let amplitudes = core::array::from_fn(|lane| candidates.amplitude(at(lane)));
            let z = Sixteen { amplitude: 1.0, phasors: [&amplitudes, &[0.0; LANES]] };
            let changes = changes::<S, T>(s, points, z);
            winner = winner.or(s, changes, |lane| at(lane) * phases, tolerance);
        }
        return winner.index;
    }
    best_within::<S, T>(s, points, candidates, PhaseRange::whole(phases), tolerance)
}

/// Returns the result of [`best`] among the phases of a range, at all amplitudes.
#[inline(always)]
pub(crate) fn best_within<S: Simd, T: Term>(
    s: S,
    points: Points<'_>,
    candidates: &Candidates,
    range: PhaseRange,
    tolerance: f32,
) -> usize {
    let phases = candidates.phases;
    let wrap = |l: usize| if l < phases { l } else { l - phases };
    let parts = [(range.from, range.above + 1), (wrap(range.from + phases - range.below), range.below)];
    let mut winner = Winner::NONE;
    for k in 0..candidates.amplitudes {
        for (start, count) in parts {
            for step in (0..count).step_by(LANES) {
                let first = wrap(start + step);
                let drives = candidates.drives(candidates.amplitude(k), first);
                let mut changes = changes::<S, T>(s, points, drives);
                if count - step < LANES {
                    // The next entries of the table are outside of the range.
                    let used = s.splat((count - step) as f32);
                    changes = s.select_less(s.load(&LANE), used, changes, s.splat(f32::INFINITY));
                }
                winner = winner.or(s, changes, |lane| k * phases + wrap(first + lane), tolerance);
            }
        }
    }
    winner.index
}

/// The index of each lane.
const LANE: Lanes = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Returns the result of [`best`] among candidates given by their indices in ascending order. Here the lanes contain
/// points.
#[inline(always)]
pub(crate) fn best_of<S: Simd>(
    s: S,
    points: Points<'_>,
    candidates: &Candidates,
    some: &[u32],
    tolerance: f32,
) -> usize {
    let mut winner = Winner::NONE;
    for chunk in some.chunks(LANES) {
        let mut changes = Each { points, candidates, chunk, out: [[0.0; LANES]; LANES] };
        s.apart(points.count, &mut changes);
        let mut lanes = [f32::INFINITY; LANES];
        s.store(s.sums(&changes.out, points.count), &mut lanes);
        lanes[chunk.len()..].fill(f32::INFINITY);
        let at = |lane: usize| chunk[lane.min(chunk.len() - 1)] as usize;
        winner = winner.or(s, s.load(&lanes), at, tolerance);
    }
    winner.index
}

/// Kernel of the changes of the points' terms by up to 16 candidates, with points in the lanes.
struct Each<'a> {
    points: Points<'a>,
    candidates: &'a Candidates,
    chunk: &'a [u32],
    out: [Lanes; LANES],
}

impl Apart for Each<'_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        for (&index, out) in self.chunk.iter().zip(&mut self.out) {
            let [re, im] = self.candidates.drive(index as usize);
            let (q, mut change) = ([s.splat(re), s.splat(im)], s.splat(0.0));
            let row = groups(self.points.row[0]).iter().zip(groups(self.points.row[1]));
            for (group, (re, im)) in self.points.groups.iter().zip(row) {
                change = group.add_change(s, [re, im], q, change);
            }
            s.store(change, out);
        }
    }
}
