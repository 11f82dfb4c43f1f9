//! The greedy pass over up to 16 problems of few points at once: problem b in lane b.
//!
//! A [`PointGroup`] is here one point of all problems. Turns that the moments decide, nearly all of them, are decided
//! with the operations of [`crate::kernels::greedy`] in the same order, and points are added in the tree of [`Simd::reduce_add`]; any
//! other turn of a problem is handed to the lone pass's own functions. So every problem's bits are those of its lone
//! pass.

use crate::kernels::greedy;
use crate::kernels::greedy::large_grid;
use crate::kernels::greedy::moments::{
    ENERGY, FACTORS, Moments, PARTS, Powers, THIRD, add_parts, change, powers, slack,
};
use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::greedy::search::{Candidates, EQUAL, L2, Points, largest};
use crate::kernels::greedy::shortlist::Shortlist;
use crate::kernels::greedy::{choose, few, search_all};
use crate::kernels::lanes::{LANES, Lanes, groups, groups_mut};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::Simd;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};

/// What a pass works on; a list of points has a group of lanes a point.
pub(crate) struct Pass<'a> {
    pub(crate) rows: Rows<'a>,
    pub(crate) target: &'a [f32],
    pub(crate) weight: &'a [f32],
    /// How many problems there are.
    pub(crate) problems: usize,
    /// As [`fits`] wants them.
    pub(crate) candidates: &'a Candidates,
    /// The transducers in the order of their turns.
    pub(crate) order: &'a [u32],
    /// Memory: [`kept`] of these,
    pub(crate) kept: &'a mut [PointGroup],
    /// [`floats`] numbers,
    pub(crate) floats: &'a mut [f32],
    /// and [`crate::kernels::greedy::indices`] indices for a row of 16.
    pub(crate) indices: &'a mut [u32],
}

/// Whether this pass knows how to search K = `amplitudes` times L = `phases` candidates.
pub(crate) fn fits(phases: usize, amplitudes: usize) -> bool {
    phases < large_grid::LARGE && phases * amplitudes <= Shortlist::MOST
}

/// Numbers kept of a candidate: its [`Powers`].
const POWERS: usize = 9;

/// Numbers of working memory for rows of `lanes`.
pub(crate) fn floats(lanes: usize, candidates: &Candidates) -> usize {
    5 * lanes + 2 * LANES + POWERS * candidates.count() + greedy::floats(candidates.phases)
}

/// Points kept for rows of `lanes`: theirs and two of a lone pass.
pub(crate) const fn kept(lanes: usize) -> usize {
    lanes / LANES + 2
}

/// As [`crate::kernels::greedy::pass`] for a problem in each lane; `drive` has two groups of lanes a transducer, re and im.
pub(crate) fn pass(set: InstructionSet, pass: Pass<'_>, drive: &mut [f32], pressures: [&mut [f32]; 2]) {
    dispatch!(set, s => run(s, pass, drive, pressures));
}

#[inline(always)]
fn run<S: Simd>(s: S, pass: Pass<'_>, drive: &mut [f32], [re, im]: [&mut [f32]; 2]) {
    let Pass { rows, target, weight, problems, candidates, order, kept, floats, indices } = pass;
    let lanes = target.len();
    let points = lanes / LANES;
    let (mut row, rest) = floats.split_at_mut(2 * lanes);
    let (mut next, rest) = rest.split_at_mut(2 * lanes);
    let (energies, rest) = rest.split_at_mut(lanes);
    let (table, rest) = rest.split_at_mut(POWERS * candidates.count());
    let (kept, alone) = kept.split_at_mut(points);
    let mut lone = Lone { candidates, kept: alone, floats: rest, indices };
    for (kept, (t, w)) in kept.iter_mut().zip(groups(target).iter().zip(groups(weight))) {
        *kept = PointGroup::silent(s, t, w);
    }
    energies.fill(0.0);
    write_powers(s, candidates, table);
    let used = 0xffff >> (LANES - problems);
    let mut sounding = 0;
    if let Some(&first) = order.first() {
        let (re, im) = row.split_at_mut(lanes);
        rows.write(s, first as usize, re, im);
    }
    for (turn, &i) in order.iter().enumerate() {
        let gain = [&row[..lanes], &row[lanes..]];
        let all = Turn { kept, gain, energies };
        let (m, near) = moments(s, &all);
        // The next row depends on nothing here: it fills the wait for the sums.
        if let Some(&following) = order.get(turn + 1) {
            let (re, im) = next.split_at_mut(lanes);
            rows.write(s, following as usize, re, im);
        }
        let (mut q, clear) = winners(s, &m, table);
        let [_, _, _, _, _, _, _, _, _, power, ..] = m;
        let decided = clear & sounding & !near & s.less(s.splat(0.0), power);
        let mut left = used & !decided;
        let nearby = near & sounding & left;
        // A search in every lane takes as long as some lone turns.
        if few(candidates) && 3 * nearby.count_ones() as usize > points {
            let found = all.search(s, table);
            let lanes = lanes_of(s, nearby);
            for (q, found) in q.iter_mut().zip(found) {
                *q = s.select_less(s.splat(0.0), lanes, found, *q);
            }
            left &= !nearby;
        }
        if left != 0 {
            let mut own: [Lanes; 2] = [[0.0; LANES]; 2];
            s.store(q[0], &mut own[0]);
            s.store(q[1], &mut own[1]);
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                let is = |lanes: u32| lanes >> lane & 1 == 1;
                let [re, im] = lone.drive(s, &all, lane, is(near));
                (own[0][lane], own[1][lane]) = (re, im);
            }
            q = [s.load(&own[0]), s.load(&own[1])];
        }
        let drive = groups_mut(drive);
        s.store(q[0], &mut drive[2 * i as usize]);
        s.store(q[1], &mut drive[2 * i as usize + 1]);
        sounding = 0;
        let rows = groups(gain[0]).iter().zip(groups(gain[1]));
        for ((kept, energy), (gr, gi)) in kept.iter_mut().zip(groups_mut(energies)).zip(rows) {
            let energies = kept.add(s, [gr, gi], q);
            s.store(energies, energy);
            // A point that a problem has not weighs nothing.
            let modulus = s.mul(s.load(&kept.weight), s.load(&kept.modulus));
            sounding |= s.less(s.splat(0.0), modulus);
        }
        core::mem::swap(&mut row, &mut next);
    }
    for (kept, (re, im)) in kept.iter().zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
        (*re, *im) = (kept.re, kept.im);
    }
}

/// The moments of each problem, and in which lanes they leave a point out: points added in the tree of [`Simd::reduce_add`], as
/// if +0 stood in the places of those that are not there.
#[inline(always)]
fn moments<S: Simd>(s: S, turn: &Turn<'_>) -> ([S::V; THIRD], u32) {
    const HALF: usize = LANES / 2;
    let zero = s.splat(0.0);
    let count = turn.kept.len();
    let mut sums = [[zero; THIRD]; HALF];
    let mut near = 0;
    for (j, sum) in sums.iter_mut().enumerate().take(count) {
        *sum = turn.parts(s, j, &mut near);
        if j + HALF < count {
            add(s, sum, &turn.parts(s, j + HALF, &mut near));
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
        // One +0 among the summands and the sum is not -0.
        add(s, &mut m, &[zero; THIRD]);
    }
    for (m, factor) in m.iter_mut().zip(FACTORS) {
        *m = s.mul(*m, s.splat(factor));
    }
    (m, near)
}

#[inline(always)]
fn add<S: Simd>(s: S, sums: &mut [S::V; THIRD], others: &[S::V; THIRD]) {
    for (sum, other) in sums.iter_mut().zip(others) {
        *sum = s.add(*sum, *other);
    }
}

/// Each problem's best candidate by the moments, and in which lanes no other is as good within their slack.
#[inline(always)]
fn winners<S: Simd>(s: S, m: &[S::V; THIRD], table: &[f32]) -> ([S::V; 2], u32) {
    let &[a, b, c, d, e, f, g, h, bow, power, remainder, energy] = m;
    let m = [a, b, c, d, e, f, g, h, bow];
    let mut best = [s.splat(0.0); 2];
    let (mut least, mut second) = (s.splat(f32::INFINITY), s.splat(f32::INFINITY));
    for &[re, im, square, re2, im2, re3, im3, re_crossed, im_crossed] in table.as_chunks::<POWERS>().0 {
        let z = Powers {
            first: [s.splat(re), s.splat(im)],
            square: s.splat(square),
            second: [s.splat(re2), s.splat(im2)],
            third: [s.splat(re3), s.splat(im3)],
            crossed: [s.splat(re_crossed), s.splat(im_crossed)],
        };
        let change = change(s, &m, &z);
        second = s.min(second, s.max(least, change));
        best = [s.select_less(change, least, z.first[0], best[0]), s.select_less(change, least, z.first[1], best[1])];
        least = s.min(change, least);
    }
    let mut lanes: [Lanes; 3] = [[0.0; LANES]; 3];
    for (lanes, part) in lanes.iter_mut().zip([power, remainder, energy]) {
        s.store(part, lanes);
    }
    let mut slacks: Lanes = [0.0; LANES];
    for (lane, own) in slacks.iter_mut().enumerate() {
        *own = slack(lanes[0][lane], lanes[1][lane], lanes[2][lane], 1.0);
    }
    (best, s.less(s.add(least, s.load(&slacks)), second))
}

/// Writes what the polynomial takes of every candidate.
#[inline(always)]
fn write_powers<S: Simd>(s: S, candidates: &Candidates, table: &mut [f32]) {
    let phases = candidates.phases;
    for (k, table) in table.chunks_exact_mut(POWERS * phases).enumerate() {
        let a = s.splat(candidates.amplitude(k));
        for (chunk, table) in table.chunks_mut(POWERS * LANES).enumerate() {
            let [cos, sin] = candidates.sixteen(chunk * LANES);
            let z = powers(s, s.mul(a, s.load(cos)), s.mul(a, s.load(sin)));
            let [first, second, third, crossed] = [z.first, z.second, z.third, z.crossed];
            let list = [first[0], first[1], z.square, second[0], second[1], third[0], third[1], crossed[0], crossed[1]];
            for (n, part) in list.into_iter().enumerate() {
                let mut lanes: Lanes = [0.0; LANES];
                s.store(part, &mut lanes);
                for (own, x) in table.chunks_exact_mut(POWERS).zip(lanes) {
                    own[n] = x;
                }
            }
        }
    }
}

/// All problems before a turn, and the transducer's propagation.
struct Turn<'a> {
    kept: &'a [PointGroup],
    gain: [&'a [f32]; 2],
    energies: &'a [f32],
}

impl Turn<'_> {
    /// What point j adds to the moments, and to `near` the lanes where they leave it out.
    #[inline(always)]
    fn parts<S: Simd>(&self, s: S, j: usize, near: &mut u32) -> [S::V; THIRD] {
        let gain = [s.load(&groups(self.gain[0])[j]), s.load(&groups(self.gain[1])[j])];
        let mut all = [s.splat(0.0); PARTS];
        *near |= add_parts::<S, false>(s, &mut all, &self.kept[j], gain);
        let mut parts = [s.splat(0.0); THIRD];
        parts.copy_from_slice(&all[..THIRD]);
        parts[ENERGY] = s.load(&groups(self.energies)[j]);
        parts
    }

    /// What [`search_all`] finds for each problem among up to 16 phases.
    #[inline(always)]
    fn search<S: Simd>(&self, s: S, table: &[f32]) -> [S::V; 2] {
        let zero = s.splat(0.0);
        let tolerance = s.mul(s.splat(EQUAL), largest::<S, L2>(s, self.kept, self.gain));
        let mut changes = [zero; LANES];
        let candidates = table.as_chunks::<POWERS>().0;
        for (four, changes) in candidates.chunks(4).zip(changes.chunks_exact_mut(4)) {
            for (kept, (gr, gi)) in self.kept.iter().zip(groups(self.gain[0]).iter().zip(groups(self.gain[1]))) {
                for (&[re, im, ..], change) in four.iter().zip(&mut *changes) {
                    *change = kept.add_change(s, [gr, gi], [s.splat(re), s.splat(im)], *change);
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
            best = [
                s.select_less(limit, change, best[0], s.splat(re)),
                s.select_less(limit, change, best[1], s.splat(im)),
            ];
        }
        [s.select_less(zero, tolerance, best[0], zero), s.select_less(zero, tolerance, best[1], zero)]
    }
}

/// 1 in the lanes of some bits, 0 in the others.
#[inline(always)]
fn lanes_of<S: Simd>(s: S, bits: u32) -> S::V {
    let mut lanes: Lanes = [0.0; LANES];
    for (lane, x) in lanes.iter_mut().enumerate() {
        *x = (bits >> lane & 1) as f32;
    }
    s.load(&lanes)
}

/// The lone pass's turn, and its memory: two [`PointGroup`], two rows of 16 and what [`choose`] needs.
struct Lone<'a> {
    candidates: &'a Candidates,
    kept: &'a mut [PointGroup],
    floats: &'a mut [f32],
    indices: &'a mut [u32],
}

impl Lone<'_> {
    /// The drive that the problem of a lane chooses when alone, 0 for none. `nearby` if the moments leave points out.
    #[inline(always)]
    fn drive<S: Simd>(&mut self, s: S, all: &Turn<'_>, lane: usize, nearby: bool) -> [f32; 2] {
        let count = all.kept.iter().rposition(|kept| kept.weight[lane] > 0.0).map_or(0, |last| last + 1);
        let (own, moved) = self.kept.split_at_mut(1);
        let (near, close) = self.indices.split_at_mut(LANES);
        let (rows, floats) = self.floats.split_at_mut(2 * LANES);
        own[0] = PointGroup::of_lane(s, &all.kept[..count], lane);
        let mut energy: Lanes = [0.0; LANES];
        rows.fill(0.0);
        for j in 0..count {
            rows[j] = all.gain[0][j * LANES + lane];
            rows[LANES + j] = all.gain[1][j * LANES + lane];
            energy[j] = all.energies[j * LANES + lane];
        }
        let points = Points { kept: own, gain: [&rows[..LANES], &rows[LANES..]], count };
        let silent = own[0].modulus == [0.0; LANES];
        let choice = if silent || nearby && few(self.candidates) {
            search_all::<S, L2>(s, points, self.candidates, silent)
        } else {
            let (moments, nearby) = Moments::new::<S, false>(s, own, points.gain, s.load(&energy), near);
            choose(s, points, &moments, nearby, moved, self.candidates, floats, near, close)
        };
        choice.map_or([0.0; 2], |index| self.candidates.drive(index))
    }
}
