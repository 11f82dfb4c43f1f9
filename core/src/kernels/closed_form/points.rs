//! Closed-form greedy sweep of one problem, 16 of its points in a lane group.

use num_complex::Complex32;

use crate::kernels::closed_form;
use crate::kernels::closed_form::{Block, Layout, Look, MOST, QUAD, Sweep, direction, own_power};
use crate::kernels::lanes::{LANES, Lanes, Octet, groups};
use crate::kernels::simd::Simd;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};

/// See [`closed_form::sweep`].
pub(super) fn sweep(
    set: InstructionSet,
    sweep: Sweep<'_>,
    order: impl Iterator<Item = usize>,
    drive: &mut [Complex32],
    pressures: [&mut [f32]; 2],
    report: impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
    dispatch!(set, s => closed_form::run(s, sweep, order, PointsInLanes { drive }, pressures, report))
}

/// One problem, its points in the lanes.
struct PointsInLanes<'a> {
    drive: &'a mut [Complex32],
}

impl PointsInLanes<'_> {
    /// Adds what is to be left of the waves of old drives to the sums; and these drives, re and im.
    #[inline(always)]
    fn with_own<S: Simd>(
        &self,
        s: S,
        block: &Block<'_>,
        weight: &[f32],
        own: f32,
        mut sums: [S::V; LANES],
    ) -> ([S::V; LANES], [Lanes; 2]) {
        let mut old = [[0.0; LANES]; 2];
        for (k, &i) in block.members().iter().enumerate() {
            let (q, power) = (self.drive[i], own_power(s, block.rows, k, weight));
            sums[k] = s.fma(power, s.splat(own * q.re), sums[k]);
            sums[k + MOST] = s.fma(power, s.splat(own * q.im), sums[k + MOST]);
            (old[0][k], old[1][k]) = (q.re, q.im);
        }
        (sums, old)
    }
}

impl<S: Simd> Layout<S> for PointsInLanes<'_> {
    #[inline(always)]
    fn update(
        &mut self,
        s: S,
        block: &Block<'_>,
        Look { residual, weight, own, phases }: Look<'_>,
        meanwhile: impl FnOnce(),
    ) -> [[S::V; 2]; MOST] {
        let mut sums = if block.has(1) {
            correlations::<_, 2>(s, block.rows, residual)
        } else {
            correlations::<_, 1>(s, block.rows, residual)
        };
        let mut old = [[0.0; LANES]; 2];
        if own > 0.0 {
            (sums, old) = self.with_own(s, block, weight, own, sums);
        }
        let z = s.reduce_add_each(&sums);
        let [re, im] = direction(s, phases, [z, s.swap::<MOST>(z)]);
        meanwhile();
        let mut new = [[0.0; LANES]; 2];
        s.store(re, &mut new[0]);
        s.store(im, &mut new[1]);
        for (k, &i) in block.members().iter().enumerate() {
            self.drive[i] = Complex32::new(new[0][k], new[1][k]);
        }
        s.store(s.sub(re, s.load(&old[0])), &mut old[0]);
        s.store(s.sub(im, s.load(&old[1])), &mut old[1]);
        let mut moved = [[s.splat(0.0); 2]; MOST];
        for (k, moved) in moved.iter_mut().enumerate() {
            *moved = [s.splat(old[0][k]), s.splat(old[1][k])];
        }
        moved
    }
}

/// sum_j conj(G_j) d_j of the first `QUADS` of a block, lanes apart; real parts before imaginary ones.
#[inline(always)]
fn correlations<S: Simd, const QUADS: usize>(s: S, rows: &[Octet], residual: [&[f32]; 2]) -> [S::V; LANES] {
    let mut sums = [s.splat(0.0); LANES];
    for (octet, (dr, di)) in rows.iter().zip(groups(residual[0]).iter().zip(groups(residual[1]))) {
        let (dr, di) = (s.load(dr), s.load(di));
        for k in 0..QUADS * QUAD {
            let (gr, gi) = (s.load(&octet[k][0]), s.load(&octet[k][1]));
            sums[k] = s.fma(gr, dr, s.fma(gi, di, sums[k]));
            sums[k + MOST] = s.fma(gr, di, s.fnma(gi, dr, sums[k + MOST]));
        }
    }
    sums
}
