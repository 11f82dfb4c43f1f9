//! Closed-form greedy sweep over an interleaved batch: up to 16 problems of at most 16 points, problem b in lane b.
//!
//! The loop is that of [`crate::kernels::closed_form`]. Here a list of points has one lane group for each point, and
//! each lane belongs to one problem. Each lane repeats the operations of the sweep of its single problem in their
//! order, and adds the points in the tree of [`Simd::reduce_add`]. So the result has the same bits.
//! Points that a problem lacks have target and weight 0 and add +0.
//!
//! 1. No lane is padding and nothing is summed across lanes: with M = 4 points a problem takes half of the time
//!    that it takes alone.
//! 2. The sums of two transducers are computed together, so that each residual is loaded once for both.
//! 3. The summation tree is written out, deepest terms first: at most five partial sums exist at a time.

use core::array;

use crate::kernels::closed_form::blocks;
use crate::kernels::closed_form::blocks::{Block, Layout, Look, MOST, Sweep, direction};
use crate::kernels::prelude::*;

/// Runs [`crate::kernels::closed_form::sweep`] for the problems of all lanes, each of up to 16 points. `drive` has two
/// lane groups for each transducer: the real and the imaginary parts.
pub(crate) fn sweep(
    set: InstructionSet,
    sweep: Sweep<'_>,
    order: impl Iterator<Item = usize>,
    drive: &mut [f32],
    pressures: [&mut [f32]; 2],
) {
    dispatch!(set, s => blocks::run(s, sweep, order, ProblemsInLanes { drive }, pressures, |_| true));
}

/// Number of transducers whose real and imaginary parts fill one lane group.
pub(crate) const EIGHT: usize = LANES / 2;

/// Appends the drives, given as two lane groups for each transducer, to the lists of their problems, [`EIGHT`]
/// transducers at a time.
pub(crate) fn deal_out(set: InstructionSet, drive: &[f32], out: &mut [Vec<Complex32>; LANES]) {
    dispatch!(set, s => {
        for eight in groups(drive).as_chunks::<LANES>().0 {
            let mut vectors = [s.splat(0.0); LANES];
            for (vector, lanes) in vectors.iter_mut().zip(eight) {
                *vector = s.load(lanes);
            }
            for (vector, out) in s.transpose(vectors).into_iter().zip(&mut *out) {
                let mut lanes: Lanes = [0.0; LANES];
                s.store(vector, &mut lanes);
                let drives: [_; EIGHT] = array::from_fn(|k| Complex32::new(lanes[2 * k], lanes[2 * k + 1]));
                out.extend_from_slice(&drives);
            }
        }
    });
}

/// Writes the drives of up to 16 problems, given one problem after another, in the order that [`deal_out`] reads. Lanes
/// without a problem get 0.
pub(crate) fn deal_in(set: InstructionSet, drives: &[Complex32], transducers: usize, out: &mut [f32]) {
    dispatch!(set, s => {
        for (k, eight) in groups_mut(out).as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            let mut vectors = [s.splat(0.0); LANES];
            for (vector, drive) in vectors.iter_mut().zip(drives.chunks_exact(transducers)) {
                let drives = &drive[k * EIGHT..transducers.min((k + 1) * EIGHT)];
                let mut lanes: Lanes = [0.0; LANES];
                for (pair, q) in lanes.as_chunks_mut::<2>().0.iter_mut().zip(drives) {
                    *pair = [q.re, q.im];
                }
                *vector = s.load(&lanes);
            }
            for (lanes, vector) in eight.iter_mut().zip(s.transpose(vectors)) {
                s.store(vector, lanes);
            }
        }
    });
}

/// Drives of up to 16 problems, one problem in each lane.
struct ProblemsInLanes<'a> {
    drive: &'a mut [f32],
}

impl ProblemsInLanes<'_> {
    /// Returns `factor` times the drive of transducer `i` in each lane.
    #[inline(always)]
    fn drive<S: Simd>(&self, s: S, i: usize, factor: f32) -> [S::V; 2] {
        let (drive, factor) = (groups(self.drive), s.splat(factor));
        [s.mul(factor, s.load(&drive[2 * i])), s.mul(factor, s.load(&drive[2 * i + 1]))]
    }
}

impl<S: Simd> Layout<S> for ProblemsInLanes<'_> {
    #[inline(always)]
    fn update(&mut self, s: S, block: &Block<'_>, look: Look<'_>, meanwhile: impl FnOnce()) -> [[S::V; 2]; MOST] {
        let members = block.members();
        let mut moved = [[s.splat(0.0); 2]; MOST];
        for ((pair, z), members) in moved.as_chunks_mut().0.iter_mut().enumerate().zip(members.chunks(2)) {
            let at = |k: usize| self.drive(s, members[k.min(members.len() - 1)], look.own);
            let old = (look.own > 0.0).then(|| [at(0), at(1)]);
            *z = Terms::new(s, (block.rows, 2 * pair), look, old).sum();
        }
        // An odd number of members leaves a result without a transducer in the last pair.
        moved[members.len()..].fill([s.splat(0.0); 2]);
        for (z, &i) in moved.iter_mut().zip(members) {
            let (q, old) = (direction(s, look.phases, *z), self.drive(s, i, 1.0));
            let lanes = &mut groups_mut(self.drive)[2 * i..2 * i + 2];
            s.store(q[0], &mut lanes[0]);
            s.store(q[1], &mut lanes[1]);
            *z = [s.sub(q[0], old[0]), s.sub(q[1], old[1])];
        }
        meanwhile();
        moved
    }
}

/// The terms of the sums z (see [`crate::kernels::closed_form`]) of two transducers, one lane group for each point.
struct Terms<'a, S: Simd> {
    s: S,
    rows: &'a [Octet],
    /// Index of the first of the two transducers in the block.
    first: usize,
    residual: [&'a [Lanes]; 2],
    weight: &'a [Lanes],
    /// The old drives of both transducers times `own`; `None` where `own` is 0.
    old: Option<[[S::V; 2]; 2]>,
}

impl<'a, S: Simd> Terms<'a, S> {
    #[inline(always)]
    fn new(s: S, (rows, first): (&'a [Octet], usize), look: Look<'a>, old: Option<[[S::V; 2]; 2]>) -> Self {
        let count = rows.len();
        let residual = look.residual.map(|list| &groups(list)[..count]);
        Self { s, rows, first, residual, weight: &groups(look.weight)[..count], old }
    }

    /// Returns the terms of point `l` in both sums: conj(G) d + w |G|^2 `old`, for the gain G, the residual d and the
    /// weight w.
    #[inline(always)]
    fn term(&self, l: usize) -> [[S::V; 2]; 2] {
        let (s, zero) = (self.s, self.s.splat(0.0));
        let (dr, di) = (s.load(&self.residual[0][l]), s.load(&self.residual[1][l]));
        let mut terms = [[zero; 2]; 2];
        for (k, ([re, im], term)) in self.rows[l][self.first..self.first + 2].iter().zip(&mut terms).enumerate() {
            let (gr, gi) = (s.load(re), s.load(im));
            *term = [s.fma(gr, dr, s.fma(gi, di, zero)), s.fma(gr, di, s.fnma(gi, dr, zero))];
            if let Some(old) = &self.old {
                let power = s.fma(s.load(&self.weight[l]), s.fma(gr, gr, s.mul(gi, gi)), zero);
                *term = [s.fma(power, old[k][0], term[0]), s.fma(power, old[k][1], term[1])];
            }
        }
        terms
    }

    /// Adds the terms of all points in the tree of [`Simd::reduce_add`], as if missing points had the term +0.
    #[inline(always)]
    fn sum(&self) -> [[S::V; 2]; 2] {
        let (s, count) = (self.s, self.weight.len());
        // Adds the sum over the points l, l + 2 step, ... and the sum over those halfway between them, each split again
        // in the same way.
        macro_rules! tree {
            ($l:expr;) => {
                self.term($l)
            };
            ($l:expr; $step:literal $($finer:literal)*) => {{
                let low = tree!($l; $($finer)*);
                if $l + $step < count { add(s, low, tree!($l + $step; $($finer)*)) } else { low }
            }};
        }
        let sum = tree!(0; 1 2 4 8);
        // With +0 among the terms, the sum is never -0.
        if count < LANES { add(s, sum, [[s.splat(0.0); 2]; 2]) } else { sum }
    }
}

#[inline(always)]
fn add<S: Simd>(s: S, a: [[S::V; 2]; 2], b: [[S::V; 2]; 2]) -> [[S::V; 2]; 2] {
    [[s.add(a[0][0], b[0][0]), s.add(a[0][1], b[0][1])], [s.add(a[1][0], b[1][0]), s.add(a[1][1], b[1][1])]]
}
