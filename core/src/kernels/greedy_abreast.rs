//! The greedy pass over up to 16 problems of few points at once: problem b in lane b.
//!
//! A [`Sixteen`] is here one point of all problems. Turns that the moments decide, nearly all of them, are decided
//! with the operations of [`super::greedy`] in the same order, and points are added in the tree of [`Simd::sum`]; any
//! other turn of a problem is handed to the lone pass's own functions. So every problem's bits are those of its lone
//! pass.

use super::abreast::tree;
use super::greedy::{choose, search_all};
use super::level::{Level, dispatch};
use super::moments::{FACTORS, Moments, PARTS, Powers, Sixteen, add_parts, change, powers};
use super::rows::Rows;
use super::search::{Candidates, L2, Points};
use super::shortlist::{self, Shortlist};
use super::simd::Simd;
use super::{LANES, Lanes, groups, groups_mut};

/// What a pass works on; a list of points has a group of lanes a point.
pub(crate) struct Pass<'a> {
    pub(crate) rows: Rows<'a>,
    pub(crate) target: &'a [f32],
    pub(crate) weight: &'a [f32],
    /// How many points each problem has.
    pub(crate) counts: &'a [usize],
    /// As [`fits`] wants them.
    pub(crate) candidates: &'a Candidates,
    /// The transducers in the order of their turns.
    pub(crate) order: &'a [u32],
    /// Memory: one for each point and two more,
    pub(crate) kept: &'a mut [Sixteen],
    /// [`floats`] numbers,
    pub(crate) floats: &'a mut [f32],
    /// and [`super::greedy::indices`] indices for a row of 16.
    pub(crate) indices: &'a mut [u32],
}

/// Numbers kept of a candidate: its [`Powers`].
const POWERS: usize = 7;

/// Numbers of working memory for rows of `lanes`.
pub(crate) fn floats(lanes: usize, candidates: &Candidates) -> usize {
    3 * lanes + 2 * LANES + POWERS * candidates.count() + shortlist::floats(candidates)
}

/// As [`super::greedy::pass`] for a problem in each lane; `drive` has two groups of lanes a transducer, re and im.
pub(crate) fn pass(level: Level, pass: Pass<'_>, drive: &mut [f32], pressures: [&mut [f32]; 2]) {
    dispatch!(level, s => run(s, pass, drive, pressures));
}

#[inline(always)]
fn run<S: Simd>(s: S, pass: Pass<'_>, drive: &mut [f32], [re, im]: [&mut [f32]; 2]) {
    let Pass { rows, target, weight, counts, candidates, order, kept, floats, indices } = pass;
    let lanes = target.len();
    let points = lanes / LANES;
    let (row_re, rest) = floats.split_at_mut(lanes);
    let (row_im, rest) = rest.split_at_mut(lanes);
    let (energies, rest) = rest.split_at_mut(lanes);
    let (table, rest) = rest.split_at_mut(POWERS * candidates.count());
    let (kept, alone) = kept.split_at_mut(points);
    let mut lone = Lone { candidates, counts, kept: alone, floats: rest, indices };
    for (kept, (t, w)) in kept.iter_mut().zip(groups(target).iter().zip(groups(weight))) {
        *kept = Sixteen::silent(s, t, w);
    }
    energies.fill(0.0);
    write_powers(s, candidates, table);
    let used = 0xffff >> (LANES - counts.len());
    let mut sounding = 0;
    for &i in order {
        rows.write(s, i as usize, row_re, row_im);
        let (m, near) = moments(s, kept, [&*row_re, &*row_im], energies);
        let (mut q, clear) = winners(s, &m, table);
        let [_, _, _, _, _, _, _, _, _, power, ..] = m;
        let decided = clear & sounding & !near & s.less(s.splat(0.0), power);
        let mut left = used & !decided;
        if left != 0 {
            let mut own: [Lanes; 2] = [[0.0; LANES]; 2];
            s.store(q[0], &mut own[0]);
            s.store(q[1], &mut own[1]);
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                let silent = sounding >> lane & 1 == 0;
                [own[0][lane], own[1][lane]] =
                    lone.drive(s, lane, kept, [&*row_re, &*row_im], energies, silent);
            }
            q = [s.load(&own[0]), s.load(&own[1])];
        }
        let drive = groups_mut(drive);
        s.store(q[0], &mut drive[2 * i as usize]);
        s.store(q[1], &mut drive[2 * i as usize + 1]);
        sounding = 0;
        let rows = groups(row_re).iter().zip(groups(row_im));
        for ((kept, energy), (gr, gi)) in kept.iter_mut().zip(groups_mut(energies)).zip(rows) {
            let energies = kept.add(s, [gr, gi], q);
            s.store(energies, energy);
            // A point that a problem has not weighs nothing.
            let modulus = s.mul(s.load(&kept.weight), s.load(&kept.modulus));
            sounding |= s.less(s.splat(0.0), modulus);
        }
    }
    for (kept, (re, im)) in kept.iter().zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
        (*re, *im) = (kept.re, kept.im);
    }
}

/// The moments of each problem, and in which lanes they leave a point out.
#[inline(always)]
fn moments<S: Simd>(s: S, kept: &[Sixteen], row: [&[f32]; 2], energies: &[f32]) -> ([S::V; PARTS], u32) {
    let zero = s.splat(0.0);
    let mut parts = [[zero; LANES]; PARTS];
    let mut near = 0;
    let rows = groups(row[0]).iter().zip(groups(row[1])).zip(groups(energies));
    for (j, (kept, ((gr, gi), energy))) in kept.iter().zip(rows).enumerate().take(LANES) {
        let mut own = [zero; PARTS];
        near |= add_parts(s, &mut own, kept, [s.load(gr), s.load(gi)]);
        own[PARTS - 1] = s.load(energy);
        for (part, own) in parts.iter_mut().zip(own) {
            part[j] = own;
        }
    }
    let mut m = [zero; PARTS];
    for ((m, part), factor) in m.iter_mut().zip(&mut parts).zip(FACTORS) {
        *m = s.mul(tree(s, part, kept.len()), s.splat(factor));
    }
    (m, near)
}

/// Each problem's best candidate by the moments, and in which lanes no other is as good within their slack.
#[inline(always)]
fn winners<S: Simd>(s: S, m: &[S::V; PARTS], table: &[f32]) -> ([S::V; 2], u32) {
    let &[a, b, c, d, e, f, g, h, bow, power, remainder, energy] = m;
    let m = [a, b, c, d, e, f, g, h, bow];
    let mut best = [s.splat(0.0); 2];
    let (mut least, mut second) = (s.splat(f32::INFINITY), s.splat(f32::INFINITY));
    for &[re, im, square, re2, im2, re3, im3] in table.as_chunks::<POWERS>().0 {
        let z = Powers {
            first: [s.splat(re), s.splat(im)],
            square: s.splat(square),
            second: [s.splat(re2), s.splat(im2)],
            third: [s.splat(re3), s.splat(im3)],
        };
        let change = change(s, &m, &z);
        second = s.min(second, s.max(least, change));
        best = [s.select_less(change, least, z.first[0], best[0]), s.select_less(change, least, z.first[1], best[1])];
        least = s.min(change, least);
    }
    let mut slack: Lanes = [0.0; LANES];
    let mut lanes: [Lanes; 3] = [[0.0; LANES]; 3];
    s.store(power, &mut lanes[0]);
    s.store(remainder, &mut lanes[1]);
    s.store(energy, &mut lanes[2]);
    for lane in 0..LANES {
        let [power, remainder, energy] = [lanes[0][lane], lanes[1][lane], lanes[2][lane]];
        slack[lane] = Moments { power, remainder, energy, ..Moments::default() }.slack(1.0);
    }
    (best, s.less(s.add(least, s.load(&slack)), second))
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
            let list = [z.first[0], z.first[1], z.square, z.second[0], z.second[1], z.third[0], z.third[1]];
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

/// The lone pass's turn, and its memory: two [`Sixteen`], two rows of 16 and what [`choose`] needs.
struct Lone<'a> {
    candidates: &'a Candidates,
    counts: &'a [usize],
    kept: &'a mut [Sixteen],
    floats: &'a mut [f32],
    indices: &'a mut [u32],
}

impl Lone<'_> {
    /// The drive that the problem of a lane chooses when alone, 0 for none.
    #[inline(always)]
    fn drive<S: Simd>(
        &mut self,
        s: S,
        lane: usize,
        kept: &[Sixteen],
        row: [&[f32]; 2],
        energies: &[f32],
        silent: bool,
    ) -> [f32; 2] {
        let count = self.counts[lane];
        let (own, moved) = self.kept.split_at_mut(1);
        let (near, close) = self.indices.split_at_mut(LANES);
        let (rows, floats) = self.floats.split_at_mut(2 * LANES);
        own[0] = Sixteen::of_lane(s, &kept[..count], lane);
        let mut energy: Lanes = [0.0; LANES];
        rows.fill(0.0);
        for j in 0..count {
            rows[j] = row[0][j * LANES + lane];
            rows[LANES + j] = row[1][j * LANES + lane];
            energy[j] = energies[j * LANES + lane];
        }
        let points = Points { kept: own, gain: [&rows[..LANES], &rows[LANES..]], count };
        let choice = if silent {
            search_all::<S, L2>(s, points, self.candidates, true)
        } else {
            let (moments, nearby) = Moments::new(s, own, points.gain, s.load(&energy), near);
            choose(s, points, &moments, nearby, moved, self.candidates, floats, near, close)
        };
        choice.map_or([0.0; 2], |index| self.candidates.drive(index))
    }
}

/// Whether this pass knows how to search these candidates.
pub(crate) fn fits(candidates: &Candidates) -> bool {
    shortlist::met_whole(candidates) && candidates.count() <= Shortlist::MOST
}
