//! The closed-form greedy pass, in blocks of transducers.

pub(crate) mod interleaved;

use num_complex::Complex32;

use crate::kernels::lanes::{LANES, Lanes, groups, groups_mut};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::simd::{Simd, TINY};
use crate::kernels::vector::correlation;

/// The largest block: two sums a transducer fill a register.
pub(crate) const MOST: usize = LANES / 2;

/// What a sweep works on; all lists of points are padded alike.
pub(crate) struct Sweep<'a> {
    pub(crate) rows: Rows<'a>,
    pub(crate) target: &'a [f32],
    pub(crate) weight: &'a [f32],
    /// Transducers that share one (t - P), 1 to [`MOST`].
    pub(crate) block: usize,
    /// The part of its own wave that a transducer leaves in P while it is chosen anew.
    pub(crate) own: f32,
    /// Memory: [`floats`] numbers.
    pub(crate) memory: &'a mut [f32],
}

/// Numbers of working memory for rows of `lanes`.
pub(crate) const fn floats(lanes: usize) -> usize {
    lanes * (2 + 2 * 2 * MOST)
}

/// Gives every transducer in turn the phase arg sum w conj(G) (t P/|P| - P + `own` G q). `step` is told the
/// pressures after each block and answers whether to go on; so is the caller.
pub(crate) fn sweep(
    set: InstructionSet,
    sweep: Sweep<'_>,
    order: impl Iterator<Item = usize>,
    drive: &mut [Complex32],
    pressures: [&mut [f32]; 2],
    mut step: impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
    dispatch!(set, s => run(s, sweep, order, drive, pressures, &mut step))
}

/// Some transducers and their rows, one after the other.
pub(crate) struct Block<'a> {
    pub(crate) members: [usize; MOST],
    pub(crate) count: usize,
    pub(crate) rows: &'a mut [f32],
    lanes: usize,
}

impl<'a> Block<'a> {
    pub(crate) fn new(rows: &'a mut [f32], lanes: usize) -> Self {
        Self { members: [0; MOST], count: 0, rows, lanes }
    }

    /// Takes the next members.
    pub(crate) fn take(&mut self, most: usize, order: &mut impl Iterator<Item = usize>) {
        self.count = 0;
        while self.count < most
            && let Some(i) = order.next()
        {
            self.members[self.count] = i;
            self.count += 1;
        }
    }

    /// Writes the rows of some members.
    #[inline(always)]
    pub(crate) fn write<S: Simd>(&mut self, s: S, rows: Rows<'_>, range: core::ops::Range<usize>) {
        let lists = self.rows.chunks_exact_mut(2 * self.lanes).zip(&self.members[..self.count]);
        for (row, &i) in lists.take(range.end).skip(range.start) {
            let (re, im) = row.split_at_mut(self.lanes);
            rows.write(s, i, re, im);
        }
    }
}

#[inline(always)]
fn run<S: Simd>(
    s: S,
    sweep: Sweep<'_>,
    mut order: impl Iterator<Item = usize>,
    drive: &mut [Complex32],
    [re, im]: [&mut [f32]; 2],
    step: &mut impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
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
        let mut parts = [s.splat(0.0); LANES];
        for (k, row) in block.rows.chunks_exact(2 * lanes).enumerate().take(block.count) {
            let row = [&row[..lanes], &row[lanes..]];
            let [mut sum_re, mut sum_im] = correlation(s, row, [&*short_re, &*short_im]);
            if own > 0.0 {
                let power = own_power(s, row, weight);
                let q = drive[block.members[k]];
                sum_re = s.fma(power, s.splat(own * q.re), sum_re);
                sum_im = s.fma(power, s.splat(own * q.im), sum_im);
            }
            parts[k] = sum_re;
            parts[k + MOST] = sum_im;
        }
        let q = units(s, &parts);
        // The next rows depend on nothing here: written in two halves they fill the wait for the sums before and
        // for the pressures after.
        next.take(most, &mut order);
        next.write(s, rows, 0..MOST / 2);
        let mut moved = [[s.splat(0.0); 2]; MOST];
        for (k, moved) in moved.iter_mut().enumerate().take(block.count) {
            let old = &mut drive[block.members[k]];
            *moved = [s.splat(q[k] - old.re), s.splat(q[k + MOST] - old.im)];
            *old = Complex32::new(q[k], q[k + MOST]);
        }
        add_block(s, block.rows, &moved[..block.count], [&mut *re, &mut *im]);
        shortfall(s, target, weight, [&*re, &*im], [&mut *short_re, &mut *short_im]);
        next.write(s, rows, MOST / 2..MOST);
        if !step([&*re, &*im]) {
            return false;
        }
        core::mem::swap(&mut block, &mut next);
    }
    true
}

/// z/|z| of 8 complex sums over lanes, re before im; 0 for what is far below the largest.
#[inline(always)]
fn units<S: Simd>(s: S, parts: &[S::V; LANES]) -> Lanes {
    let sums = s.reduce_add_each(parts);
    // Only directions matter; relative to the largest no square under- or overflows.
    let largest = s.reduce_max(s.abs(sums)).max(f32::MIN_POSITIVE);
    let sums = s.mul(sums, s.splat(1.0 / largest));
    let square = s.mul(sums, sums);
    let square = s.add(square, s.swap_halves(square));
    let least = s.splat(TINY);
    let unit = s.mul(sums, s.rsqrt(s.max(square, least)));
    let mut q: Lanes = [0.0; LANES];
    s.store(s.select_less(square, least, s.splat(0.0), unit), &mut q);
    q
}

/// P += `sum_k G_k q_k` for a block, each q_k in all lanes or a lane its own.
#[inline(always)]
pub(crate) fn add_block<S: Simd>(s: S, rows: &[f32], drives: &[[S::V; 2]], [re, im]: [&mut [f32]; 2]) {
    let lanes = re.len();
    for (group, (re, im)) in groups_mut(re).iter_mut().zip(groups_mut(im)).enumerate() {
        let (mut pr, mut pi) = (s.load(re), s.load(im));
        let (mut also_re, mut also_im) = (s.splat(0.0), s.splat(0.0));
        for (row, &[qr, qi]) in rows.chunks_exact(2 * lanes).zip(drives) {
            let at = |part: usize| &groups(&row[part * lanes..])[group];
            let (gr, gi) = (s.load(at(0)), s.load(at(1)));
            pr = s.fma(gr, qr, pr);
            also_re = s.fnma(gi, qi, also_re);
            pi = s.fma(gr, qi, pi);
            also_im = s.fma(gi, qr, also_im);
        }
        s.store(s.add(pr, also_re), re);
        s.store(s.add(pi, also_im), im);
    }
}

/// w (t P/|P| - P); the phase of a silent point is 0.
#[inline(always)]
pub(crate) fn shortfall<S: Simd>(s: S, target: &[f32], weight: &[f32], pressure: [&[f32]; 2], out: [&mut [f32]; 2]) {
    let [out_re, out_im] = out;
    let (zero, least) = (s.splat(0.0), s.splat(TINY));
    let asked = groups(target).iter().zip(groups(weight));
    let pressures = groups(pressure[0]).iter().zip(groups(pressure[1]));
    let out = groups_mut(out_re).iter_mut().zip(groups_mut(out_im));
    for (((t, w), (re, im)), (out_re, out_im)) in asked.zip(pressures).zip(out) {
        let (t, w, re, im) = (s.load(t), s.load(w), s.load(re), s.load(im));
        let square = s.fma(re, re, s.mul(im, im));
        let inverse = s.rsqrt(s.max(square, least));
        let silent = s.mul(w, t);
        let factor = s.sub(s.mul(silent, inverse), w);
        s.store(s.select_less(square, least, silent, s.mul(re, factor)), out_re);
        s.store(s.select_less(square, least, zero, s.mul(im, factor)), out_im);
    }
}

/// sum w |G|^2, lanes apart.
#[inline(always)]
fn own_power<S: Simd>(s: S, row: [&[f32]; 2], weight: &[f32]) -> S::V {
    let mut sum = s.splat(0.0);
    for ((re, im), weight) in groups(row[0]).iter().zip(groups(row[1])).zip(groups(weight)) {
        let (re, im) = (s.load(re), s.load(im));
        sum = s.fma(s.load(weight), s.fma(re, re, s.mul(im, im)), sum);
    }
    sum
}
