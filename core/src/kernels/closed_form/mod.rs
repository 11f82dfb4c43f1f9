//! Closed-form greedy sweep: the best phase of one transducer after another, in blocks that share one residual.
//!
//! ```text
//! d = w (t P/|P| - P)                              the residual: P against the nearest pressure of modulus t
//! for each block of up to 8 transducers k:
//!     z_k = sum_j conj(G_kj) d_j                   in a further sweep + own q_k sum_j w_j |G_kj|^2
//!     new_k = z_k/|z_k|
//!     P += sum_k G_k (new_k - q_k);  q_k = new_k
//!     d = w (t P/|P| - P)
//! ```
//!
//! The loop is written once over [`Layout`]: the lanes hold 16 points of one problem ([`PointsInLanes`]) or one point
//! of 16 problems ([`crate::kernels::closed_form::interleaved`]). What makes it fast:
//!
//! 1. A block shares d, so that its 16 sums over lanes (re and im of 8 transducers) are one reduction, one inverse
//!    root and one wait for P. With blocks of 1 a solve takes 1.6 times as long at
//!    N = 996, M = 16, and 1.3 times at M = 64.
//! 2. The rows of the next block depend on nothing here. They are written in two halves, where the loop waits for its
//!    sums and for its pressures.
//! 3. P is loaded and stored once a block, its eight waves added in registers in two chains.
//! 4. Memory that begins on a cache line: .59 ns a transducer and point instead of .63 at M = 64.

pub(crate) mod interleaved;

use num_complex::Complex32;

use crate::kernels::lanes::{LANES, Lanes, groups, groups_mut};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::simd::{Simd, TINY};
use crate::kernels::vector::correlation;

/// The largest block: the real and imaginary sums of its transducers fill a register.
pub(crate) const MOST: usize = LANES / 2;

/// The problem and the memory of a sweep; all lists of points are padded alike.
pub(crate) struct Sweep<'a> {
    pub(crate) rows: Rows<'a>,
    pub(crate) target: &'a [f32],
    pub(crate) weight: &'a [f32],
    /// Transducers that share one residual, 1 to [`MOST`].
    pub(crate) block: usize,
    /// The part of its own wave that a transducer leaves in P while it is updated.
    pub(crate) own: f32,
    /// [`floats`] numbers of working memory.
    pub(crate) memory: &'a mut [f32],
}

/// Numbers of working memory for rows of `lanes`.
pub(crate) const fn floats(lanes: usize) -> usize {
    lanes * (2 + 2 * 2 * MOST)
}

/// Gives every transducer of `order` the phase arg sum w conj(G) (t P/|P| - P + `own` G q). `report` is given the
/// pressures after each block; where it answers false the sweep ends and returns false.
pub(crate) fn sweep(
    set: InstructionSet,
    sweep: Sweep<'_>,
    order: impl Iterator<Item = usize>,
    drive: &mut [Complex32],
    pressures: [&mut [f32]; 2],
    report: impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
    dispatch!(set, s => run(s, sweep, order, PointsInLanes { drive }, pressures, report))
}

/// What the lanes hold: points or problems.
pub(crate) trait Layout<S: Simd> {
    /// Gives each transducer of a block its new drive z/|z| and returns by how much the drives changed. `meanwhile` is
    /// called once, while the sums are waited for.
    fn update(&mut self, s: S, block: &Block<'_>, look: Look<'_>, meanwhile: impl FnOnce()) -> [[S::V; 2]; MOST];
}

/// What z is made of, beside rows and drives.
#[derive(Clone, Copy)]
pub(crate) struct Look<'a> {
    pub(crate) residual: [&'a [f32]; 2],
    pub(crate) weight: &'a [f32],
    pub(crate) own: f32,
}

/// Some transducers and their rows, one after the other.
pub(crate) struct Block<'a> {
    members: [usize; MOST],
    count: usize,
    pub(crate) rows: &'a mut [f32],
    lanes: usize,
}

impl<'a> Block<'a> {
    fn new(rows: &'a mut [f32], lanes: usize) -> Self {
        Self { members: [0; MOST], count: 0, rows, lanes }
    }

    /// The indices of its transducers.
    #[inline(always)]
    pub(crate) fn members(&self) -> &[usize] {
        &self.members[..self.count]
    }

    /// Takes the next members.
    fn take(&mut self, most: usize, order: &mut impl Iterator<Item = usize>) {
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
    fn write<S: Simd>(&mut self, s: S, rows: Rows<'_>, range: core::ops::Range<usize>) {
        let lists = self.rows.chunks_exact_mut(2 * self.lanes).zip(&self.members[..self.count]);
        for (row, &i) in lists.take(range.end).skip(range.start) {
            let (re, im) = row.split_at_mut(self.lanes);
            rows.write(s, i, re, im);
        }
    }
}

/// The sweep; false if `report` ended it.
#[inline(always)]
pub(crate) fn run<S: Simd>(
    s: S,
    sweep: Sweep<'_>,
    mut order: impl Iterator<Item = usize>,
    mut layout: impl Layout<S>,
    [re, im]: [&mut [f32]; 2],
    mut report: impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
    let Sweep { rows, target, weight, block: most, own, memory } = sweep;
    let lanes = target.len();
    let (rest, kept) = memory.split_at_mut(2 * lanes);
    let (rest_re, rest_im) = rest.split_at_mut(lanes);
    let (first, second) = kept.split_at_mut(2 * MOST * lanes);
    let mut block = Block::new(first, lanes);
    let mut next = Block::new(second, lanes);
    block.take(most, &mut order);
    block.write(s, rows, 0..MOST);
    residual(s, target, weight, [&*re, &*im], [&mut *rest_re, &mut *rest_im]);
    while block.count > 0 {
        let look = Look { residual: [&*rest_re, &*rest_im], weight, own };
        let moved = layout.update(
            s,
            &block,
            look,
            #[inline(always)]
            || {
                next.take(most, &mut order);
                next.write(s, rows, 0..MOST / 2);
            },
        );
        add_block(s, block.rows, &moved[..block.count], [&mut *re, &mut *im]);
        residual(s, target, weight, [&*re, &*im], [&mut *rest_re, &mut *rest_im]);
        next.write(s, rows, MOST / 2..MOST);
        if !report([&*re, &*im]) {
            return false;
        }
        core::mem::swap(&mut block, &mut next);
    }
    true
}

/// One problem, its points in the lanes.
struct PointsInLanes<'a> {
    drive: &'a mut [Complex32],
}

impl<S: Simd> Layout<S> for PointsInLanes<'_> {
    #[inline(always)]
    fn update(
        &mut self,
        s: S,
        block: &Block<'_>,
        Look { residual, weight, own }: Look<'_>,
        meanwhile: impl FnOnce(),
    ) -> [[S::V; 2]; MOST] {
        let mut sums = [s.splat(0.0); LANES];
        for (k, (row, &i)) in block.rows.chunks_exact(2 * block.lanes).zip(block.members()).enumerate() {
            let row = [&row[..block.lanes], &row[block.lanes..]];
            let [mut re, mut im] = correlation(s, row, residual);
            if own > 0.0 {
                let power = own_power(s, row, weight);
                let q = self.drive[i];
                re = s.fma(power, s.splat(own * q.re), re);
                im = s.fma(power, s.splat(own * q.im), im);
            }
            sums[k] = re;
            sums[k + MOST] = im;
        }
        let new = units(s, s.reduce_add_each(&sums));
        meanwhile();
        let mut moved = [[s.splat(0.0); 2]; MOST];
        for (k, (moved, &i)) in moved.iter_mut().zip(block.members()).enumerate() {
            let old = &mut self.drive[i];
            *moved = [s.splat(new[k] - old.re), s.splat(new[k + MOST] - old.im)];
            *old = Complex32::new(new[k], new[k + MOST]);
        }
        moved
    }
}

/// z/|z| of 8 complex numbers, real parts before imaginary ones; 0 for what is far below the largest.
#[inline(always)]
fn units<S: Simd>(s: S, z: S::V) -> Lanes {
    // Only directions matter, and relative to the largest no square under- or overflows.
    let largest = s.reduce_max(s.abs(z)).max(f32::MIN_POSITIVE);
    let z = s.mul(z, s.splat(1.0 / largest));
    let square = s.mul(z, z);
    let square = s.add(square, s.swap_halves(square));
    let least = s.splat(TINY);
    let unit = s.mul(z, s.rsqrt(s.max(square, least)));
    let mut units = [0.0; LANES];
    s.store(s.select_less(square, least, s.splat(0.0), unit), &mut units);
    units
}

/// P += `sum_k G_k q_k` for a block.
#[inline(always)]
fn add_block<S: Simd>(s: S, rows: &[f32], drives: &[[S::V; 2]], [re, im]: [&mut [f32]; 2]) {
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

/// d = w (t P/|P| - P); the phase of a silent point is 0.
#[inline(always)]
fn residual<S: Simd>(s: S, target: &[f32], weight: &[f32], pressure: [&[f32]; 2], out: [&mut [f32]; 2]) {
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
