//! Blocks of transducers that share one residual: the loop of the closed-form sweep.
//!
//! Point j has the pressure P, the target t and the weight w; q_k is the drive of transducer k and G_kj its pressure at
//! point j at drive 1.
//!
//! ```text
//! d = w (t P/|P| - P)                              the residual: P against the nearest pressure of modulus t
//! for each block of up to 8 transducers k:
//!     z_k = sum_j conj(G_kj) d_j                   in further sweeps + own q_k sum_j w_j |G_kj|^2
//!     new_k = z_k/|z_k|
//!     P += sum_k G_k (new_k - q_k);  q_k = new_k
//!     d = w (t P/|P| - P)
//! ```
//!
//! The loop is written once over [`Layout`]: a lane group contains 16 points ([`points`](crate::kernels::closed_form::points)), 4 or 8 points of 4 or 2
//! transducers ([`segments`](crate::kernels::closed_form::segments)) or one point of 16 problems ([`interleaved_sweep`](crate::kernels::closed_form::interleaved_sweep)). Instruction sets of narrow registers
//! have a loop of their own (`short`). All of them add the terms of a sum in the same order. What makes the sweep
//! fast:
//!
//! 1. A block shares d, so that its 16 sums over lanes (re and im of 8 transducers) need one reduction, one inverse
//!    root and one wait for P. With blocks of 1 a solve takes 1.6 times as long at N = 996 transducers and M = 16
//!    points, and 1.3 times at M = 64.
//! 2. The rows of the next block do not depend on this block. The loop writes one half of them while it waits for its
//!    sums, and the other half while it waits for its pressures.
//! 3. A block's eight rows lie side by side, lane group by lane group: d and P are loaded and stored once a block, and
//!    its eight waves are added in registers in four chains.
//! 4. The memory begins on a cache line: .59 ns for each transducer and point instead of .63 at M = 64.

use crate::kernels::grid::Phases;
use crate::kernels::prelude::*;
use crate::kernels::propagate::octets::write_rows;
use crate::kernels::propagate::rows::Rows;

/// Number of transducers in the largest block: their real and imaginary sums fill a lane group.
pub(crate) const MOST: usize = LANES / 2;

/// Number of transducers in half a block. Each of the four chains of additions has one transducer of each half.
pub(crate) const QUAD: usize = MOST / 2;

/// The problem and the working memory of a sweep. All lists of points have the same padded length.
pub(crate) struct Sweep<'a> {
    pub(crate) rows: Rows<'a>,
    pub(crate) target: &'a [f32],
    pub(crate) weight: &'a [f32],
    /// The number of points; the other lanes are padding.
    pub(crate) count: usize,
    /// Number of transducers that share one residual, 1 to [`MOST`].
    pub(crate) block: usize,
    /// Factor of a transducer's own wave in z, see the module's head. It is 0 in a first sweep, which begins with all
    /// drives at 0.
    pub(crate) own: f32,
    /// The phases of a board. If given, each new drive is rounded to the nearest of them before the next block is
    /// updated.
    pub(crate) phases: Option<&'a Phases>,
    pub(crate) memory: Memory<'a>,
}

/// Working memory of a sweep.
pub(crate) struct Memory<'a> {
    /// Space for the rows of G of two blocks of transducers.
    pub(crate) rows: &'a mut [f32],
    /// Space for the residuals d: real and imaginary parts.
    pub(crate) residual: [&'a mut [f32]; 2],
}

impl<'a> Memory<'a> {
    /// Divides a list of [`floats`] numbers, with any content, into the working memory.
    pub(crate) fn of(numbers: &'a mut [f32]) -> Self {
        let (rows, rest) = numbers.split_at_mut(numbers.len() / floats(1) * ROWS);
        Self { rows, residual: rest.split_at_mut(rest.len() / 2).into() }
    }
}

/// Number of f32 for each lane in the rows of two blocks: real and imaginary parts of [`MOST`] transducers each.
pub(crate) const ROWS: usize = 2 * 2 * MOST;

/// Returns the length of the working memory for rows of `lanes` numbers.
pub(crate) const fn floats(lanes: usize) -> usize {
    lanes * (ROWS + 2)
}

/// The layout of a lane group: its lanes are points, or segments with the rows of several transducers, or problems.
pub(crate) trait Layout<S: Simd> {
    /// Number of transducers whose rows share a lane group.
    const SHARED: usize = 1;

    /// Writes the rows of `members` to a block of rows, from column `first` on.
    #[inline(always)]
    fn write(s: S, rows: Rows<'_>, members: &[usize], first: usize, to: &mut [Octet]) {
        write_rows(s, rows, members, first, to);
    }

    /// Gives each transducer of a block its new drive z/|z|; returns the change of each drive, column by column. Calls
    /// `meanwhile` once, while the processor waits for the sums z.
    fn update(&mut self, s: S, block: &Block<'_>, look: Look<'_>, meanwhile: impl FnOnce()) -> [[S::V; 2]; MOST];

    /// Returns the pressure P, with which the first chain of additions starts; the other chains start from 0.
    #[inline(always)]
    fn start(_: S, pressure: S::V) -> S::V {
        pressure
    }

    /// Adds the four chains of a block's waves to the new pressure P. Chain c contains transducers c and c + 4; chains
    /// c and c + 2 are added first.
    #[inline(always)]
    fn sum(s: S, [a, b, c, d]: [S::V; QUAD]) -> S::V {
        s.add(s.add(a, c), s.add(b, d))
    }
}

/// The values on which the sums z of the module's head depend, besides rows and drives.
#[derive(Clone, Copy)]
pub(crate) struct Look<'a> {
    pub(crate) residual: [&'a [f32]; 2],
    pub(crate) weight: &'a [f32],
    pub(crate) own: f32,
    pub(crate) phases: Option<&'a Phases>,
}

/// The indices of up to [`MOST`] transducers, and their rows.
pub(crate) struct Block<'a> {
    members: [usize; MOST],
    count: usize,
    pub(crate) rows: &'a mut [Octet],
}

impl<'a> Block<'a> {
    fn new(rows: &'a mut [f32]) -> Self {
        let (pairs, _) = groups_mut(rows).as_chunks_mut();
        Self { members: [0; MOST], count: 0, rows: pairs.as_chunks_mut().0 }
    }

    /// Returns the indices of the block's transducers.
    #[inline(always)]
    pub(crate) fn members(&self) -> &[usize] {
        &self.members[..self.count]
    }

    /// Returns whether the block has transducers in half `quad`, 0 or 1.
    #[inline(always)]
    pub(crate) fn has(&self, quad: usize) -> bool {
        quad * QUAD < self.count
    }

    /// Replaces the transducers by the next ones of `order`, at most `most`.
    fn take(&mut self, most: usize, order: &mut impl Iterator<Item = usize>) {
        self.count = 0;
        while self.count < most
            && let Some(i) = order.next()
        {
            self.members[self.count] = i;
            self.count += 1;
        }
    }

    /// Writes the rows of the transducers in half `quad`, and zeros for those that a short block lacks.
    #[inline(always)]
    fn write<S: Simd, L: Layout<S>>(&mut self, s: S, rows: Rows<'_>, quad: usize) {
        if !self.has(quad) {
            return;
        }
        let members = &self.members[quad * QUAD..self.count.min((quad + 1) * QUAD)];
        let lists = quad * QUAD / L::SHARED..(quad + 1) * QUAD / L::SHARED;
        L::write(s, rows, members, lists.start, self.rows);
        for silent in lists.skip(members.len().div_ceil(L::SHARED)) {
            self.rows.iter_mut().for_each(|octet| octet[silent] = [[0.0; LANES]; 2]);
        }
    }
}

/// Runs the sweep in a given layout; returns false if `report` ended it.
#[inline(always)]
pub(crate) fn run<S: Simd, L: Layout<S>>(
    s: S,
    sweep: Sweep<'_>,
    mut order: impl Iterator<Item = usize>,
    mut layout: L,
    [re, im]: [&mut [f32]; 2],
    mut report: impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
    let Sweep { rows, target, weight, count, block: most, own, phases, memory } = sweep;
    let Memory { rows: buffer, residual: [rest_re, rest_im] } = memory;
    let (first, second) = buffer.split_at_mut(buffer.len() / 2);
    // The first block is empty: the first pass computes d and writes the rows of the second block.
    let mut block = Block::new(first);
    let mut next = Block::new(second);
    loop {
        let look = Look { residual: [&*rest_re, &*rest_im], weight, own, phases };
        let moved = layout.update(
            s,
            &block,
            look,
            #[inline(always)]
            || {
                next.take(most, &mut order);
                next.write::<S, L>(s, rows, 0);
            },
        );
        if block.has(1) {
            add_block::<S, L, 2>(s, block.rows, &moved, [&mut *re, &mut *im]);
        } else if block.has(0) {
            add_block::<S, L, 1>(s, block.rows, &moved, [&mut *re, &mut *im]);
        }
        residual(s, target, weight, [&*re, &*im], [&mut *rest_re, &mut *rest_im]);
        next.write::<S, L>(s, rows, 1);
        let goes_on = !block.has(0) || report([&re[..count], &im[..count]]);
        core::mem::swap(&mut block, &mut next);
        if !goes_on || !block.has(0) {
            // Removes the sums that the padding collected.
            re[count..].fill(0.0);
            im[count..].fill(0.0);
            return goes_on;
        }
    }
}

/// Sums z smaller than this count as 0.
const LEAST: f32 = 1e-37;

/// Returns the new drives for eight sums z (see the module's head); real and imaginary parts are side by side.
#[inline(always)]
pub(crate) fn directions<S: Simd>(s: S, phases: Option<&Phases>, z: S::V) -> S::V {
    match phases {
        Some(phases) => phases.nearest_pairs(s, z),
        None => unit(s, [z, s.swap::<1>(z)])[0],
    }
}

/// Returns a transducer's new drive for its sum z: the board's phase nearest to the phase of z, or z/|z| without a
/// board; 0 where z is 0.
#[inline(always)]
pub(crate) fn direction<S: Simd>(s: S, phases: Option<&Phases>, z: [S::V; 2]) -> [S::V; 2] {
    match phases {
        Some(phases) => phases.nearest(s, z),
        None => unit(s, z),
    }
}

/// Returns z/|z|; 0 where z is 0.
#[inline(always)]
pub(crate) fn unit<S: Elementwise>(s: S, [re, im]: [S::V; 2]) -> [S::V; 2] {
    // First divide by the root of the larger part: the square then is about that part, and neither under- nor
    // overflows.
    let larger = s.max(s.abs(re), s.abs(im));
    let root = s.rsqrt_estimate(larger);
    let (x, y) = (s.mul(re, root), s.mul(im, root));
    let (guess, miss) = s.rsqrt_guess(s.add(s.mul(x, x), s.mul(y, y)));
    let (x, y) = (s.mul(x, guess), s.mul(y, guess));
    let (zero, half, least) = (s.splat(0.0), s.splat(0.5), s.splat(LEAST));
    // A sum below LEAST may have lost all digits, so it counts as 0.
    [
        s.select_less(larger, least, zero, s.fma(s.mul(x, half), miss, x)),
        s.select_less(larger, least, zero, s.fma(s.mul(y, half), miss, y)),
    ]
}

/// Adds the waves `sum_k G_k q_k` to the pressures P over the first `QUADS` halves of a block, q_k the changes of
/// drives.
#[inline(always)]
fn add_block<S: Simd, L: Layout<S>, const QUADS: usize>(
    s: S,
    rows: &[Octet],
    drives: &[[S::V; 2]; MOST],
    [re, im]: [&mut [f32]; 2],
) {
    let lists = QUAD / L::SHARED;
    for (octet, (re, im)) in rows.iter().zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
        let mut real = [s.splat(0.0); QUAD];
        let mut imag = real;
        (real[0], imag[0]) = (L::start(s, s.load(re)), L::start(s, s.load(im)));
        for k in 0..QUADS * lists {
            let (gr, gi, [qr, qi]) = (s.load(&octet[k][0]), s.load(&octet[k][1]), drives[k]);
            real[k % lists] = s.fma(gr, qr, s.fnma(gi, qi, real[k % lists]));
            imag[k % lists] = s.fma(gr, qi, s.fma(gi, qr, imag[k % lists]));
        }
        s.store(L::sum(s, real), re);
        s.store(L::sum(s, imag), im);
    }
}

/// Writes the residuals d = w (t P/|P| - P) for pressures P, targets t and weights w; P = 0 counts with phase 0.
#[inline(always)]
pub(crate) fn residual<S: Elementwise>(
    s: S,
    target: &[f32],
    weight: &[f32],
    pressure: [&[f32]; 2],
    out: [&mut [f32]; 2],
) {
    let [out_re, out_im] = out;
    let (zero, least) = (s.splat(0.0), s.splat(TINY));
    let requested = groups(target).iter().zip(groups(weight));
    let pressures = groups(pressure[0]).iter().zip(groups(pressure[1]));
    let out = groups_mut(out_re).iter_mut().zip(groups_mut(out_im));
    for (((t, w), (re, im)), (out_re, out_im)) in requested.zip(pressures).zip(out) {
        let (t, w, re, im) = (s.load(t), s.load(w), s.load(re), s.load(im));
        let square = s.fma(re, re, s.mul(im, im));
        let (guess, miss) = s.rsqrt_guess(square);
        let silent = s.mul(w, t);
        let near = s.mul(silent, guess);
        // This is w t/|P| - w. Where P is 0 this value is arbitrary, and the selections below ignore it.
        let factor = s.fma(s.mul(near, s.splat(0.5)), miss, s.sub(near, w));
        s.store(s.select_less(square, least, silent, s.mul(re, factor)), out_re);
        s.store(s.select_less(square, least, zero, s.mul(im, factor)), out_im);
    }
}

/// Returns `sum_j w_j |G_j|^2` over the points, for the row of G in column `k`, as one partial sum in each lane.
#[inline(always)]
pub(crate) fn own_power<S: Elementwise>(s: S, rows: &[Octet], k: usize, weight: &[f32]) -> S::V {
    let mut sum = s.splat(0.0);
    for (octet, weight) in rows.iter().zip(groups(weight)) {
        let (re, im) = (s.load(&octet[k][0]), s.load(&octet[k][1]));
        sum = s.fma(s.load(weight), s.fma(re, re, s.mul(im, im)), sum);
    }
    sum
}
