//! Closed-form greedy sweep of one problem: a lane group contains 16 of its points.

use crate::kernels::closed_form::blocks;
use crate::kernels::closed_form::blocks::{Block, Layout, Look, MOST, QUAD, Sweep, directions, own_power};
use crate::kernels::prelude::*;

/// Runs the sweep [`closed_form::sweep`] with 16 points in a lane group.
pub(super) fn sweep(
    set: InstructionSet,
    sweep: Sweep<'_>,
    order: impl Iterator<Item = usize>,
    drive: &mut [Complex32],
    pressures: [&mut [f32]; 2],
    report: impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
    dispatch!(set, s => !s.is_short() && blocks::run(s, sweep, order, PointsInLanes { drive }, pressures, report))
}

/// The drives of one problem whose points are in the lanes.
struct PointsInLanes<'a> {
    drive: &'a mut [Complex32],
}

impl PointsInLanes<'_> {
    /// Adds `own` times the old drives' own waves to the sums z (see [`closed_form`]). Returns the sums and the old
    /// drives, real and imaginary parts side by side.
    #[inline(always)]
    fn with_own<S: Simd>(
        &self,
        s: S,
        block: &Block<'_>,
        weight: &[f32],
        own: f32,
        mut sums: [S::V; LANES],
    ) -> ([S::V; LANES], Lanes) {
        let mut old = [0.0; LANES];
        for (k, &i) in block.members().iter().enumerate() {
            let (q, power) = (self.drive[i], own_power(s, block.rows, k, weight));
            for (part, q) in [q.re, q.im].into_iter().enumerate() {
                sums[2 * k + part] = s.fma(power, s.splat(own * q), sums[2 * k + part]);
                old[2 * k + part] = q;
            }
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
        let mut old = [0.0; LANES];
        if own > 0.0 {
            (sums, old) = self.with_own(s, block, weight, own, sums);
        }
        let q = directions(s, phases, s.reduce_add_each(&sums));
        meanwhile();
        let (mut new, mut change) = ([0.0; LANES], [0.0; LANES]);
        s.store(q, &mut new);
        s.store(s.sub(q, s.load(&old)), &mut change);
        for (k, &i) in block.members().iter().enumerate() {
            self.drive[i] = Complex32::new(new[2 * k], new[2 * k + 1]);
        }
        let mut moved = [[s.splat(0.0); 2]; MOST];
        for (k, moved) in moved.iter_mut().enumerate() {
            *moved = [s.splat(change[2 * k]), s.splat(change[2 * k + 1])];
        }
        moved
    }
}

/// Returns sum_j conj(G_j) d_j, the correlations of rows of G with the residuals d, for the first `QUADS` halves of a
/// block. Each is one partial sum in each lane; real and imaginary parts are side by side.
#[inline(always)]
fn correlations<S: Simd, const QUADS: usize>(s: S, rows: &[Octet], residual: [&[f32]; 2]) -> [S::V; LANES] {
    let mut sums = [s.splat(0.0); LANES];
    for (octet, (dr, di)) in rows.iter().zip(groups(residual[0]).iter().zip(groups(residual[1]))) {
        let (dr, di) = (s.load(dr), s.load(di));
        for k in 0..QUADS * QUAD {
            let (gr, gi) = (s.load(&octet[k][0]), s.load(&octet[k][1]));
            sums[2 * k] = s.fma(gr, dr, s.fma(gi, di, sums[2 * k]));
            sums[2 * k + 1] = s.fma(gr, di, s.fnma(gi, dr, sums[2 * k + 1]));
        }
    }
    sums
}
