//! Closed-form greedy sweep of few points: a lane group has a segment for each of 2 or 4 transducers.
//!
//! ```text
//! coordinates, targets, weights, P and d are repeated in every segment; a lane group of rows is that of N transducers
//! z    = conj(G) d, summed within each segment: the sums of all eight transducers fold into one lane group
//! q    = z/|z|, computed once for all eight
//! P    = the waves, each q copied to all lanes of its segment, added over the lists and then over the segments
//! ```
//!
//! 1. Four points fill the lanes: a block of 8 transducers is 2 rows, not 8.
//! 2. Between the pressures P of one block and those of the next, all values stay in registers. Drives are read and
//!    stored meanwhile.
//!
//! At N = 996 transducers a solve takes half of the time that it takes with 16 points in a lane group at M = 4 points,
//! and .65 of it at M = 8 (AVX2).

use core::array;

use crate::kernels::closed_form::blocks::{Block, Layout, Look, QUAD, ROWS, directions, own_power};
use crate::kernels::closed_form::{MOST, Memory, Sweep, blocks};
use crate::kernels::prelude::*;
use crate::kernels::propagate::octets::write_segments;
use crate::kernels::{ControlPoints, Rows};

/// The rows of two blocks over one lane group, aligned to a cache line.
#[repr(align(64))]
struct Buffer([f32; ROWS * LANES]);

/// Runs [`closed_form::sweep`] with N transducers in a lane group, for at most 16/N points.
pub(super) fn sweep<const N: usize>(
    set: InstructionSet,
    sweep: &Sweep<'_>,
    order: impl Iterator<Item = usize>,
    drive: &mut [Complex32],
    [re, im]: [&mut [f32]; 2],
    report: impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
    let count = sweep.count;
    let repeated = |list: &[f32]| Line(array::from_fn(|lane| list[lane % (LANES / N)]));
    let (target, weight) = (repeated(sweep.target), repeated(sweep.weight));
    let (mut real, mut imag) = (repeated(re), repeated(im));
    let coordinates;
    let rows = match sweep.rows {
        Rows::Computed { radiation, sources, control_points, .. } => {
            coordinates = control_points.coordinates.map(repeated);
            let [x, y, z] = &coordinates;
            let control_points = ControlPoints { coordinates: [&x.0, &y.0, &z.0], count: LANES };
            Rows::Computed { radiation, sources, control_points, amplitudes: &[] }
        }
        stored @ Rows::Stored { .. } => stored,
    };
    let mut buffer = Buffer([0.0; ROWS * LANES]);
    let [mut rest_re, mut rest_im] = [(); 2].map(|()| Line([0.0; LANES]));
    // The arrays are separate variables, so that the residuals stay in registers.
    let memory = Memory { rows: &mut buffer.0, residual: [&mut rest_re.0, &mut rest_im.0] };
    let few = Sweep { rows, target: &target.0, weight: &weight.0, memory, ..*sweep };
    let pressures = [&mut real.0[..], &mut imag.0[..]];
    let sweep = Segments::<N> { drive };
    let goes_on = dispatch!(set, s => !s.is_short() && blocks::run(s, few, order, sweep, pressures, report));
    re[..count].copy_from_slice(&real.0[..count]);
    im[..count].copy_from_slice(&imag.0[..count]);
    goes_on
}

/// Sums the lanes of each of N segments, for the first 16/N vectors: lane l of a segment of the result is the sum of
/// that segment of `sums[l]`. The order of additions is the tree of [`Simd::reduce_add`] with zeros for missing points.
#[inline(always)]
fn folded<S: Simd, const N: usize>(s: S, sums: [S::V; LANES]) -> S::V {
    let mut v = sums;
    if N == 2 {
        for k in 0..4 {
            v[k] = s.fold::<4>(v[k], v[k + 4]);
        }
    }
    s.fold::<1>(s.fold::<2>(v[0], v[2]), s.fold::<2>(v[1], v[3]))
}

/// Copies lane `lane` of each of N segments to all lanes of that segment.
#[inline(always)]
fn spread<S: Simd, const N: usize>(s: S, v: S::V, lane: usize) -> S::V {
    macro_rules! both {
        ($v:expr, $distance:literal) => {{
            let (v, other) = ($v, s.swap::<$distance>($v));
            if lane & $distance == 0 { s.pick::<$distance>(v, other) } else { s.pick::<$distance>(other, v) }
        }};
    }
    let v = both!(both!(v, 1), 2);
    if N == 2 { both!(v, 4) } else { v }
}

/// The drives of one problem of few points, with N transducers in a lane group.
struct Segments<'a, const N: usize> {
    drive: &'a mut [Complex32],
}

impl<const N: usize> Segments<'_, N> {
    /// Returns the lane of the real part of the drive of transducer `k` of a block; the imaginary part is in the next
    /// lane.
    const fn lane(k: usize) -> usize {
        LANES / N * (k % N) + 2 * (k / N)
    }

    /// Returns the drives of a block's transducers, in the lanes that [`Self::lane`] gives.
    #[inline(always)]
    fn old(&self, block: &Block<'_>) -> Lanes {
        let mut lanes = [0.0; LANES];
        for (k, &i) in block.members().iter().enumerate() {
            (lanes[Self::lane(k)], lanes[Self::lane(k) + 1]) = (self.drive[i].re, self.drive[i].im);
        }
        lanes
    }
}

impl<S: Simd, const N: usize> Layout<S> for Segments<'_, N> {
    const SHARED: usize = N;

    #[inline(always)]
    fn write(s: S, rows: Rows<'_>, members: &[usize], first: usize, to: &mut [Octet]) {
        write_segments::<S, N>(s, rows, members, first, &mut to[0]);
    }

    #[inline(always)]
    fn update(
        &mut self,
        s: S,
        block: &Block<'_>,
        Look { residual, weight, own, phases }: Look<'_>,
        meanwhile: impl FnOnce(),
    ) -> [[S::V; 2]; MOST] {
        let zero = s.splat(0.0);
        let (dr, di) = (s.load(&groups(residual[0])[0]), s.load(&groups(residual[1])[0]));
        let old = if own > 0.0 { s.load(&self.old(block)) } else { zero };
        let (mut sums, left) = ([zero; LANES], s.mul(s.splat(own), old));
        for k in 0..MOST / N {
            if !block.has(k * N / QUAD) {
                break;
            }
            let (gr, gi) = (s.load(&block.rows[0][k][0]), s.load(&block.rows[0][k][1]));
            let mut re = s.fma(gr, dr, s.fma(gi, di, zero));
            let mut im = s.fma(gr, di, s.fnma(gi, dr, zero));
            if own > 0.0 {
                let power = own_power(s, block.rows, k, weight);
                re = s.fma(power, spread::<S, N>(s, left, 2 * k), re);
                im = s.fma(power, spread::<S, N>(s, left, 2 * k + 1), im);
            }
            (sums[2 * k], sums[2 * k + 1]) = (re, im);
        }
        let new = directions(s, phases, folded::<S, N>(s, sums));
        meanwhile();
        let mut lanes: Lanes = [0.0; LANES];
        s.store(new, &mut lanes);
        for (k, &i) in block.members().iter().enumerate() {
            self.drive[i] = Complex32::new(lanes[Self::lane(k)], lanes[Self::lane(k) + 1]);
        }
        let change = s.sub(new, old);
        let mut moved = [[zero; 2]; MOST];
        for (k, moved) in moved.iter_mut().enumerate().take(MOST / N) {
            *moved = [spread::<S, N>(s, change, 2 * k), spread::<S, N>(s, change, 2 * k + 1)];
        }
        moved
    }

    #[inline(always)]
    fn start(s: S, pressure: S::V) -> S::V {
        s.mul(pressure, s.quarters([1.0, if N == 2 { 1.0 } else { 0.0 }, 0.0, 0.0]))
    }

    #[inline(always)]
    fn sum(s: S, [a, b, ..]: [S::V; QUAD]) -> S::V {
        if N == 2 {
            let both = s.add(a, b);
            return s.add(both, s.swap::<8>(both));
        }
        // The tree of [`Layout::sum`]: segments k and k + 2 are added first. No swap waits for a sum.
        let quarters = s.swap::<4>(a);
        s.add(s.add(a, s.swap::<8>(a)), s.add(quarters, s.swap::<8>(quarters)))
    }
}
