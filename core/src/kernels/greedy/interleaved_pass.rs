//! Greedy pass over an interleaved batch: up to 16 problems of at most 16 points, problem b in lane b.
//!
//! The loop is that of [`crate::kernels::greedy`]. Here a [`PointGroup`] contains one point of all problems.
//!
//! ```text
//! m = moments of every lane, points added in the tree of Simd::reduce_add
//! for each candidate z: f(z), the change of the energy, in every lane; keep the least and the second least
//! lanes where the second least exceeds the least by more than the slack are decided
//! lanes whose moments leave points out: all candidates by eq. (7), if there are many such lanes
//! each other lane: the search of its problem alone
//! ```
//!
//! Each lane repeats the operations of its single problem in their order. An update that the lanes do not decide is
//! left to the search of the single pass. So every result has the same bits as that of a single pass.
//!
//! 1. Nothing is summed across lanes, and 16 problems wait together for one chain of operations. A problem takes a
//!    fifth of the time of its single pass at M = 4 points, and half of it at M = 16.
//! 2. The powers of every candidate are computed once a pass and read as scalars.
//! 3. Eq. (7) in every lane takes as long as a few single updates, and saves 4, 7 and 10 % at M = 4, 8 and 16: in early
//!    updates most lanes have points that the moments leave out.

use crate::kernels::greedy::moments::{ENERGY, FACTORS, PARTS, POWER, POWERS, THIRD, add_parts, change, powers, slack};
use crate::kernels::greedy::search::{EQUAL, Points, largest};
use crate::kernels::greedy::shortlist::few;
use crate::kernels::greedy::{Layout, Pass, PointsInLanes, Search, large_grid, run, shortlist};
use crate::kernels::prelude::*;
use crate::kernels::{Candidates, L2, PointGroup, greedy};

/// Returns whether this pass can search K = `amplitudes` times L = `phases` candidates.
pub(crate) fn fits(phases: usize, amplitudes: usize) -> bool {
    phases < large_grid::LARGE && phases * amplitudes <= shortlist::MOST
}

/// Returns the length of a search's working memory for rows of `lanes` numbers.
pub(crate) fn floats(lanes: usize, candidates: &Candidates) -> usize {
    lanes + 2 * LANES + POWERS * candidates.count() + greedy::floats(candidates.phases)
}

/// Runs [`crate::kernels::greedy::pass`] for one problem in each of the first `problems` lanes. `drive` has two lane
/// groups for each transducer: the real and the imaginary parts. The indices of the search are those for rows of 16.
pub(crate) fn pass(
    set: InstructionSet,
    pass: Pass<'_>,
    search: Search<'_>,
    problems: usize,
    drive: &mut [f32],
    pressures: [&mut [f32]; 2],
) {
    dispatch!(set, s => {
        let Search { candidates, floats, indices } = search;
        let (energies, rest) = floats.split_at_mut(pass.target.len());
        let (row, rest) = rest.split_at_mut(2 * LANES);
        let (table, floats) = rest.split_at_mut(POWERS * candidates.count());
        energies.fill(0.0);
        write_powers(s, candidates, table);
        let single = &mut [Complex32::ZERO];
        let alone = Search { candidates, floats, indices };
        let alone = PointsInLanes::new(s, [&[0.0; LANES]; 2], alone, single);
        let used = 0xffff >> (LANES - problems);
        let layout = ProblemsInLanes { drive, energies, table, used, sounding: 0, alone, row };
        run(s, pass, layout, pressures, |_, _| true);
    });
}

/// The state of up to 16 problems, one in each lane.
struct ProblemsInLanes<'a, V> {
    drive: &'a mut [f32],
    /// The term of the energy of every point and problem.
    energies: &'a mut [f32],
    /// The powers of every candidate, see [`powers`].
    table: &'a [f32],
    /// Bits of the lanes that have a problem, and of those where some pressure is not 0.
    used: u32,
    sounding: u32,
    /// The pass of a single problem, and memory for its row.
    alone: PointsInLanes<'a, V, L2>,
    row: &'a mut [f32],
}

impl<S: Simd> Layout<S> for ProblemsInLanes<'_, S::V> {
    type Drive = [S::V; 2];

    #[inline(always)]
    fn update(&mut self, s: S, points: Points<'_>, i: usize, meanwhile: impl FnOnce()) -> Option<[S::V; 2]> {
        let (m, near) = moments(s, points, self.energies);
        meanwhile();
        let (mut q, clear) = winners(s, &m, self.table);
        let decided = clear & self.sounding & !near & s.less(s.splat(0.0), m[POWER]);
        let mut left = self.used & !decided;
        let nearby = near & self.sounding & left;
        if few(self.alone.candidates) && 3 * nearby.count_ones() as usize > points.groups.len() {
            let best = search(s, points, self.table);
            let lanes = lanes_of(s, nearby);
            for (q, new) in q.iter_mut().zip(best) {
                *q = s.select_less(s.splat(0.0), lanes, new, *q);
            }
            left &= !nearby;
        }
        let pair = &mut groups_mut(self.drive)[2 * i..2 * i + 2];
        s.store(q[0], &mut pair[0]);
        s.store(q[1], &mut pair[1]);
        if left == 0 {
            return Some(q);
        }
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            self.update_alone(s, points, lane);
            let q = self.alone.drive[0];
            let pair = &mut groups_mut(self.drive)[2 * i..2 * i + 2];
            (pair[0][lane], pair[1][lane]) = (q.re, q.im);
        }
        let pair = &groups(self.drive)[2 * i..2 * i + 2];
        Some([s.load(&pair[0]), s.load(&pair[1])])
    }

    #[inline(always)]
    fn add(&mut self, s: S, points: &mut [PointGroup], _: usize, row: [&[f32]; 2], q: [S::V; 2]) {
        self.sounding = 0;
        let rows = groups(row[0]).iter().zip(groups(row[1]));
        for ((group, energy), (gr, gi)) in points.iter_mut().zip(groups_mut(self.energies)).zip(rows) {
            let energies = group.add(s, [gr, gi], q);
            s.store(energies, energy);
            // A point that a problem lacks has weight 0.
            let modulus = s.mul(s.load(&group.weight), s.load(&group.modulus));
            self.sounding |= s.less(s.splat(0.0), modulus);
        }
    }
}

impl<V: Copy> ProblemsInLanes<'_, V> {
    /// Writes to `self.alone.drive` the drive that the problem of a lane chooses in a single pass; 0 if it chooses
    /// none.
    #[inline(always)]
    fn update_alone<S: Simd<V = V>>(&mut self, s: S, all: Points<'_>, lane: usize) {
        let count = all.groups.iter().rposition(|group| group.weight[lane] > 0.0).map_or(0, |last| last + 1);
        let group = PointGroup::of_lane(s, &all.groups[..count], lane);
        let mut energy: Lanes = [0.0; LANES];
        self.row.fill(0.0);
        for j in 0..count {
            self.row[j] = all.row[0][j * LANES + lane];
            self.row[LANES + j] = all.row[1][j * LANES + lane];
            energy[j] = self.energies[j * LANES + lane];
        }
        let (re, im) = self.row.split_at(LANES);
        self.alone.drive[0] = Complex32::ZERO;
        self.alone.energy = s.load(&energy);
        self.alone.silent = group.modulus == [0.0; LANES];
        if S::SHORT {
            // The previous lane's problem may have had more points.
            self.alone.parts = [[0.0; LANES]; PARTS];
        }
        let groups = core::slice::from_ref(&group);
        self.alone.update(s, Points { groups, row: [re, im], count }, 0, || ());
    }
}

/// Returns the moments of each problem, and the bits of the lanes whose moments leave points out. Points are added in
/// the tree of [`Simd::reduce_add`], as if missing points had the term +0.
#[inline(always)]
fn moments<S: Simd>(s: S, points: Points<'_>, energies: &[f32]) -> ([S::V; THIRD], u32) {
    const HALF: usize = LANES / 2;
    let zero = s.splat(0.0);
    let count = points.groups.len();
    let mut sums = [[zero; THIRD]; HALF];
    let mut near = 0;
    for (j, sum) in sums.iter_mut().enumerate().take(count) {
        *sum = parts(s, points, energies, j, &mut near);
        if j + HALF < count {
            add(s, sum, &parts(s, points, energies, j + HALF, &mut near));
        }
    }
    let mut left = count.min(HALF);
    for half in [4, 2, 1] {
        let (low, high) = sums[..left].split_at_mut(half.min(left));
        for (low, high) in low.iter_mut().zip(high) {
            add(s, low, high);
        }
        left = left.min(half);
    }
    let mut m = sums[0];
    if count < LANES {
        // With +0 among the terms, the sum is never -0.
        add(s, &mut m, &[zero; THIRD]);
    }
    for (m, factor) in m.iter_mut().zip(FACTORS) {
        *m = s.mul(*m, s.splat(factor));
    }
    (m, near)
}

/// Returns the terms of point `j` in the moments; sets in `near` the bits of the lanes that leave this point out.
#[inline(always)]
fn parts<S: Simd>(s: S, points: Points<'_>, energies: &[f32], j: usize, near: &mut u32) -> [S::V; THIRD] {
    let gain = [s.load(&groups(points.row[0])[j]), s.load(&groups(points.row[1])[j])];
    let mut all = [s.splat(0.0); PARTS];
    *near |= add_parts::<S, false>(s, &mut all, &points.groups[j], gain);
    let mut parts = [s.splat(0.0); THIRD];
    parts.copy_from_slice(&all[..THIRD]);
    parts[ENERGY] = s.load(&groups(energies)[j]);
    parts
}

#[inline(always)]
fn add<S: Simd>(s: S, sums: &mut [S::V; THIRD], others: &[S::V; THIRD]) {
    for (sum, other) in sums.iter_mut().zip(others) {
        *sum = s.add(*sum, *other);
    }
}

/// Returns each problem's best candidate by the moments, and the bits of the lanes in which no other candidate is as
/// good within the slack.
#[inline(always)]
fn winners<S: Simd>(s: S, m: &[S::V; THIRD], table: &[f32]) -> ([S::V; 2], u32) {
    let mut best = [s.splat(0.0); 2];
    let (mut least, mut second) = (s.splat(f32::INFINITY), s.splat(f32::INFINITY));
    for numbers in table.as_chunks::<POWERS>().0 {
        let change = change(
            s,
            #[inline(always)]
            |k| m[k],
            #[inline(always)]
            |k| s.splat(numbers[k]),
        );
        second = s.min(second, s.max(least, change));
        let z = [s.splat(numbers[0]), s.splat(numbers[1])];
        best = [s.select_less(change, least, z[0], best[0]), s.select_less(change, least, z[1], best[1])];
        least = s.min(change, least);
    }
    let mut lanes: [Lanes; 3] = [[0.0; LANES]; 3];
    for (lanes, &part) in lanes.iter_mut().zip(&m[POWER..]) {
        s.store(part, lanes);
    }
    let slacks: Lanes = core::array::from_fn(|l| slack(lanes[0][l], lanes[1][l], lanes[2][l], 1.0));
    (best, s.less(s.add(least, s.load(&slacks)), second))
}

/// Writes the powers of every candidate to `table`.
#[inline(always)]
fn write_powers<S: Simd>(s: S, candidates: &Candidates, table: &mut [f32]) {
    for (index, numbers) in table.chunks_exact_mut(POWERS).enumerate() {
        let [re, im] = candidates.drive(index);
        for (x, power) in numbers.iter_mut().zip(powers(s, s.splat(re), s.splat(im))) {
            let mut lanes = [0.0; LANES];
            s.store(power, &mut lanes);
            *x = lanes[0];
        }
    }
}

/// Returns each problem's best of up to 16 phases as [`crate::kernels::greedy::search::best`] does; 0 if the transducer
/// has no effect.
#[inline(always)]
fn search<S: Simd>(s: S, points: Points<'_>, table: &[f32]) -> [S::V; 2] {
    let zero = s.splat(0.0);
    let tolerance = s.mul(s.splat(EQUAL), largest::<S, L2>(s, points, LANES));
    let mut changes = [zero; LANES];
    let candidates = table.as_chunks::<POWERS>().0;
    for (four, changes) in candidates.chunks(4).zip(changes.chunks_exact_mut(4)) {
        let row = groups(points.row[0]).iter().zip(groups(points.row[1]));
        for (group, (gr, gi)) in points.groups.iter().zip(row) {
            for (&[re, im, ..], change) in four.iter().zip(&mut *changes) {
                *change = group.add_change(s, [gr, gi], [s.splat(re), s.splat(im)], *change);
            }
        }
    }
    let mut least = s.splat(f32::INFINITY);
    for &change in &changes[..candidates.len()] {
        least = s.min(change, least);
    }
    let limit = s.add(least, tolerance);
    let mut best = [zero; 2];
    for (&[re, im, ..], &change) in candidates.iter().zip(&changes).rev() {
        best = [s.select_less(limit, change, best[0], s.splat(re)), s.select_less(limit, change, best[1], s.splat(im))];
    }
    [s.select_less(zero, tolerance, best[0], zero), s.select_less(zero, tolerance, best[1], zero)]
}

/// Returns 1 in the lanes whose bit is set, 0 in the others.
#[inline(always)]
fn lanes_of<S: Simd>(s: S, bits: u32) -> S::V {
    s.load(&core::array::from_fn(|lane| (bits >> lane & 1) as f32))
}
