//! The closed-form greedy pass over up to 16 problems of few points at once: problem b in lane b.
//!
//! A list of points has a group of lanes a point, a lane a problem. What [`super::fast`] does to the lanes of one
//! problem's points is done here in the same order, and points are added in the tree of [`Simd::sum`], so that every
//! problem's bits are those of its lone pass. Points that a problem has not have target and weight 0 and so add +0.

use alloc::vec::Vec;
use core::array;

use num_complex::Complex32;

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

/// Transducers whose drives are dealt out at a time: re and im of them are a group of lanes.
pub(crate) const EIGHT: usize = LANES / 2;

/// Deals drives, two groups of lanes a transducer, out to their problems, to lists of a multiple of [`EIGHT`].
pub(crate) fn deal_out(level: Level, drive: &[f32], out: &mut [Vec<Complex32>; LANES]) {
    dispatch!(level, s => {
        for (at, eight) in groups(drive).as_chunks::<LANES>().0.iter().enumerate() {
            let mut vectors = [s.splat(0.0); LANES];
            for (vector, lanes) in vectors.iter_mut().zip(eight) {
                *vector = s.load(lanes);
            }
            for (vector, out) in s.transpose(vectors).into_iter().zip(&mut *out) {
                let mut lanes: Lanes = [0.0; LANES];
                s.store(vector, &mut lanes);
                if let Some(out) = out.as_chunks_mut::<EIGHT>().0.get_mut(at) {
                    *out = array::from_fn(|k| Complex32::new(lanes[2 * k], lanes[2 * k + 1]));
                }
            }
        }
    });
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
    let (first, second) = kept.split_at_mut(2 * MOST * lanes);
    let mut block = Block::new(first, lanes);
    let mut next = Block::new(second, lanes);
    block.take(most, &mut order);
    block.write(s, rows, 0..MOST);
    shortfall(s, target, weight, [&*re, &*im], [&mut *short_re, &mut *short_im]);
    while block.count > 0 {
        let mut sums = [[s.splat(0.0); 2]; MOST];
        for (k, row) in block.rows.chunks_exact(2 * lanes).enumerate().take(block.count) {
            let terms = Terms::new(s, row, [&*short_re, &*short_im], weight);
            let old = || drive_of(s, drive, block.members[k]).map(|q| s.mul(s.splat(own), q));
            sums[k] = terms.sum((own > 0.0).then(old));
        }
        let q = units(s, &sums);
        // The next rows depend on nothing here, see `fast`.
        next.take(most, &mut order);
        next.write(s, rows, 0..MOST / 2);
        let mut moved = [[s.splat(0.0); 2]; MOST];
        for ((k, q), moved) in q.into_iter().enumerate().zip(&mut moved).take(block.count) {
            let old = drive_of(s, drive, block.members[k]);
            *moved = [s.sub(q[0], old[0]), s.sub(q[1], old[1])];
            let place = 2 * block.members[k];
            s.store(q[0], &mut groups_mut(drive)[place]);
            s.store(q[1], &mut groups_mut(drive)[place + 1]);
        }
        add_block(s, block.rows, &moved[..block.count], [&mut *re, &mut *im]);
        shortfall(s, target, weight, [&*re, &*im], [&mut *short_re, &mut *short_im]);
        next.write(s, rows, MOST / 2..MOST);
        core::mem::swap(&mut block, &mut next);
    }
}

#[inline(always)]
fn drive_of<S: Simd>(s: S, drive: &[f32], i: usize) -> [S::V; 2] {
    let drive = groups(drive);
    [s.load(&drive[2 * i]), s.load(&drive[2 * i + 1])]
}

/// What a transducer's sum is made of, a group of lanes a point.
struct Terms<'a, S> {
    s: S,
    re: &'a [Lanes],
    im: &'a [Lanes],
    short: [&'a [Lanes]; 2],
    weight: &'a [Lanes],
}

impl<'a, S: Simd> Terms<'a, S> {
    #[inline(always)]
    fn new(s: S, row: &'a [f32], short: [&'a [f32]; 2], weight: &'a [f32]) -> Self {
        let (re, im) = row.split_at(weight.len());
        let weight = groups(weight);
        let list = |list| &groups(list)[..weight.len()];
        Self { s, re: list(re), im: list(im), short: [list(short[0]), list(short[1])], weight }
    }

    /// conj(G) d, and w |G|^2 q of the old drive.
    #[inline(always)]
    fn term(&self, l: usize, old: Option<[S::V; 2]>) -> [S::V; 2] {
        let s = self.s;
        let (gr, gi) = (s.load(&self.re[l]), s.load(&self.im[l]));
        let (dr, di) = (s.load(&self.short[0][l]), s.load(&self.short[1][l]));
        let zero = s.splat(0.0);
        let term = [s.fma(gr, dr, s.fma(gi, di, zero)), s.fma(gr, di, s.fnma(gi, dr, zero))];
        let Some(q) = old else { return term };
        let power = s.fma(s.load(&self.weight[l]), s.fma(gr, gr, s.mul(gi, gi)), zero);
        [s.fma(power, q[0], term[0]), s.fma(power, q[1], term[1])]
    }

    /// The sum in the tree of [`Simd::sum`], as if +0 stood in the places of the points that are not there.
    #[inline(always)]
    fn sum(&self, old: Option<[S::V; 2]>) -> [S::V; 2] {
        let (s, count) = (self.s, self.weight.len());
        // Every other point and the rest, and so on down to the term of point l.
        macro_rules! tree {
            ($l:expr;) => {
                self.term($l, old)
            };
            ($l:expr; $step:literal $($finer:literal)*) => {{
                let low = tree!($l; $($finer)*);
                if $l + $step < count {
                    let high = tree!($l + $step; $($finer)*);
                    [s.add(low[0], high[0]), s.add(low[1], high[1])]
                } else {
                    low
                }
            }};
        }
        let sum = tree!(0; 1 2 4 8);
        if count == LANES {
            return sum;
        }
        // One +0 among the summands and the sum is not -0.
        [s.add(sum[0], s.splat(0.0)), s.add(sum[1], s.splat(0.0))]
    }
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
