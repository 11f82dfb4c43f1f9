//! The closed-form greedy pass over up to 16 problems of few points at once: problem b in lane b.
//!
//! A list of points has a group of lanes a point, a lane a problem. What [`super::fast`] does to the lanes of one
//! problem's points is done here in the same order, and points are added in the tree of [`Simd::sum`], so that every
//! problem's bits are those of its lone pass. Points that a problem has not have target and weight 0 and so add +0.

use super::fast::{Block, MOST, Sweep, add_block, shortfall};
use super::level::{Level, dispatch};
use super::simd::{Simd, TINY};
use super::{LANES, Lanes, groups, groups_mut};

/// As [`super::fast::sweep`] for up to 16 points in each lane; `drive` has two groups of lanes a transducer, re and im.
pub(crate) fn sweep(
    level: Level,
    sweep: Sweep<'_>,
    order: impl Iterator<Item = usize>,
    drive: &mut [f32],
    pressures: [&mut [f32]; 2],
) {
    dispatch!(level, s => run(s, sweep, order, drive, pressures));
}

#[inline(always)]
fn run<S: Simd>(
    s: S,
    sweep: Sweep<'_>,
    mut order: impl Iterator<Item = usize>,
    drive: &mut [f32],
    [re, im]: [&mut [f32]; 2],
) {
    let Sweep { rows, target, weight, block: most, own, memory } = sweep;
    let lanes = target.len();
    let (short, kept) = memory.split_at_mut(2 * lanes);
    let (short_re, short_im) = short.split_at_mut(lanes);
    let mut block = Block::new(kept, lanes);
    let mut parts = [[s.splat(0.0); LANES]; 2];
    block.take(most, &mut order);
    while block.count > 0 {
        block.write(s, rows, 0..MOST);
        shortfall(s, target, weight, [&*re, &*im], [&mut *short_re, &mut *short_im]);
        let mut sums = [[s.splat(0.0); 2]; MOST];
        for (k, row) in block.rows.chunks_exact(2 * lanes).enumerate().take(block.count) {
            correlations(s, row, [&*short_re, &*short_im], &mut parts);
            if own > 0.0 {
                let old = drive_of(s, drive, block.members[k]);
                add_own(s, row, weight, old.map(|q| s.mul(s.splat(own), q)), &mut parts);
            }
            sums[k] = [0, 1].map(|part| tree(s, &mut parts[part], lanes / LANES));
        }
        let mut moved = [[s.splat(0.0); 2]; MOST];
        for ((k, q), moved) in units(s, &sums).into_iter().enumerate().zip(&mut moved).take(block.count) {
            let old = drive_of(s, drive, block.members[k]);
            *moved = [s.sub(q[0], old[0]), s.sub(q[1], old[1])];
            let place = 2 * block.members[k];
            s.store(q[0], &mut groups_mut(drive)[place]);
            s.store(q[1], &mut groups_mut(drive)[place + 1]);
        }
        add_block(s, block.rows, &moved[..block.count], [&mut *re, &mut *im]);
        block.take(most, &mut order);
    }
}

#[inline(always)]
fn drive_of<S: Simd>(s: S, drive: &[f32], i: usize) -> [S::V; 2] {
    let drive = groups(drive);
    [s.load(&drive[2 * i]), s.load(&drive[2 * i + 1])]
}

/// conj(G) d, points apart: re and im.
#[inline(always)]
fn correlations<S: Simd>(s: S, row: &[f32], short: [&[f32]; 2], parts: &mut [[S::V; LANES]; 2]) {
    let (re, im) = row.split_at(short[0].len());
    let [parts_re, parts_im] = parts;
    let zero = s.splat(0.0);
    let lists = groups(re).iter().zip(groups(im)).zip(groups(short[0]).iter().zip(groups(short[1])));
    for (((gr, gi), (dr, di)), (re, im)) in lists.zip(parts_re.iter_mut().zip(parts_im)) {
        let (gr, gi, dr, di) = (s.load(gr), s.load(gi), s.load(dr), s.load(di));
        *re = s.fma(gr, dr, s.fma(gi, di, zero));
        *im = s.fma(gr, di, s.fnma(gi, dr, zero));
    }
}

/// w |G|^2 q, points apart.
#[inline(always)]
fn add_own<S: Simd>(s: S, row: &[f32], weight: &[f32], q: [S::V; 2], parts: &mut [[S::V; LANES]; 2]) {
    let (re, im) = row.split_at(weight.len());
    let [parts_re, parts_im] = parts;
    let lists = groups(re).iter().zip(groups(im)).zip(groups(weight));
    for (((gr, gi), w), (re, im)) in lists.zip(parts_re.iter_mut().zip(parts_im)) {
        let (gr, gi) = (s.load(gr), s.load(gi));
        let power = s.fma(s.load(w), s.fma(gr, gr, s.mul(gi, gi)), s.splat(0.0));
        *re = s.fma(power, q[0], *re);
        *im = s.fma(power, q[1], *im);
    }
}

/// The sum of the first `count` vectors in the tree of [`Simd::sum`], as if +0 stood in the others' places.
#[inline(always)]
pub(super) fn tree<S: Simd>(s: S, vectors: &mut [S::V; LANES], count: usize) -> S::V {
    let mut left = count;
    for half in [8, 4, 2, 1] {
        for l in half..left {
            vectors[l - half] = s.add(vectors[l - half], vectors[l]);
        }
        left = left.min(half);
    }
    // One +0 among the summands and the sum is not -0.
    if count < LANES { s.add(vectors[0], s.splat(0.0)) } else { vectors[0] }
}

/// z/|z| of 8 complex sums in each lane; 0 for what is far below the lane's largest.
#[inline(always)]
fn units<S: Simd>(s: S, sums: &[[S::V; 2]; MOST]) -> [[S::V; 2]; MOST] {
    let mut largest = s.splat(f32::MIN_POSITIVE);
    for &[re, im] in sums {
        largest = s.max(largest, s.max(s.abs(re), s.abs(im)));
    }
    let mut lanes: Lanes = [0.0; LANES];
    s.store(largest, &mut lanes);
    let (unit, least, zero) = (s.load(&lanes.map(|x| 1.0 / x)), s.splat(TINY), s.splat(0.0));
    let mut out = *sums;
    for z in &mut out {
        let [re, im] = [s.mul(z[0], unit), s.mul(z[1], unit)];
        let square = s.add(s.mul(re, re), s.mul(im, im));
        let inverse = s.inverse_root(s.max(square, least));
        *z = [s.mul(re, inverse), s.mul(im, inverse)].map(|q| s.select_less(square, least, zero, q));
    }
    out
}
