//! Products of matrices whose rows are kept, planar and padded.

use num_complex::Complex32;

use crate::kernels::lanes::{LANES, Lanes, groups, groups_mut};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::Simd;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::vector::{add_wave, correlation};

/// Rows met together by one pass over a vector: their sums fill a register.
const TOGETHER: usize = LANES / 2;

/// out_k = `sum_j conj(row_kj) vector_j` for every row of a planar matrix.
pub(crate) fn correlate_rows(
    set: InstructionSet,
    rows: [&[f32]; 2],
    vector: [&[f32]; 2],
    mut out: impl FnMut(usize, Complex32),
) {
    dispatch!(set, s => {
        let lanes = vector[0].len();
        let row = |k: usize| rows.map(|part| &part[k * lanes..(k + 1) * lanes]);
        let count = rows[0].len() / lanes;
        for first in (0..count).step_by(TOGETHER) {
            let mut parts = [s.splat(0.0); LANES];
            for k in 0..TOGETHER.min(count - first) {
                let [re, im] = correlation(s, row(first + k), vector);
                parts[k] = re;
                parts[k + TOGETHER] = im;
            }
            let mut sums: Lanes = [0.0; LANES];
            s.store(s.reduce_add_each(&parts), &mut sums);
            for k in 0..TOGETHER.min(count - first) {
                out(first + k, Complex32::new(sums[k], sums[k + TOGETHER]));
            }
        }
    });
}

/// out = `sum_k row_k factor_k`: the field of a drive, G stored.
pub(crate) fn combine_rows(
    set: InstructionSet,
    rows: [&[f32]; 2],
    factors: &[Complex32],
    out: [&mut [f32]; 2],
) {
    /// Groups of the sum that stay in registers.
    const WIDE: usize = 4;
    #[inline(always)]
    fn some<S: Simd, const N: usize>(
        s: S,
        rows: [&[f32]; 2],
        factors: &[Complex32],
        out: &mut [&mut [f32]; 2],
        at: usize,
    ) {
        let lanes = out[0].len();
        let mut sums = [[s.splat(0.0); N]; 2];
        for (k, q) in factors.iter().enumerate() {
            let start = k * lanes + at * LANES;
            let [re, im] = rows.map(|part| groups(&part[start..start + N * LANES]));
            let (qr, qi) = (s.splat(q.re), s.splat(q.im));
            for g in 0..N {
                let (gr, gi) = (s.load(&re[g]), s.load(&im[g]));
                sums[0][g] = s.fma(gr, qr, s.fnma(gi, qi, sums[0][g]));
                sums[1][g] = s.fma(gr, qi, s.fma(gi, qr, sums[1][g]));
            }
        }
        for (part, sums) in out.iter_mut().zip(sums) {
            for (g, sum) in sums.into_iter().enumerate() {
                s.store(sum, &mut groups_mut(part)[at + g]);
            }
        }
    }
    dispatch!(set, s => {
        let mut out = out;
        let count = out[0].len() / LANES;
        let whole = count - count % WIDE;
        for at in (0..whole).step_by(WIDE) {
            some::<_, WIDE>(s, rows, factors, &mut out, at);
        }
        for at in whole..count {
            some::<_, 1>(s, rows, factors, &mut out, at);
        }
    });
}

/// P += G q for every transducer that is driven; `row` is memory for one row.
pub(crate) fn add_waves(
    set: InstructionSet,
    rows: Rows<'_>,
    drive: &[Complex32],
    row: [&mut [f32]; 2],
    field: [&mut [f32]; 2],
) {
    dispatch!(set, s => {
        let ([row_re, row_im], [re, im]) = (row, field);
        for (i, q) in drive.iter().enumerate().filter(|(_, q)| **q != Complex32::ZERO) {
            rows.write(s, i, row_re, row_im);
            add_wave(s, [&*row_re, &*row_im], [q.re, q.im], re, im);
        }
    });
}

/// Transducers whose rows wait together for [`gram`]: they stay in the second-level cache.
const PANEL: usize = 32;

/// Numbers of working memory for [`gram`] with rows of `lanes`.
pub(crate) const fn gram_floats(lanes: usize) -> usize {
    4 * PANEL * lanes
}

/// `sum_i f_i conj(G_ki) G_li` for rows k and l of the points, row k padded, `count` rows: conj(G diag(f) G^H).
///
/// A tile of 4 rows and 2 groups is summed over a panel of transducers in registers; what lies left of the
/// diagonal's group is mirrored at the end.
pub(crate) fn gram(
    set: InstructionSet,
    rows: Rows<'_>,
    factors: impl Fn(usize) -> f32,
    transducers: usize,
    count: usize,
    memory: &mut [f32],
    out: [&mut [f32]; 2],
) {
    dispatch!(set, s => {
        let [re, im] = out;
        let lanes = memory.len() / (4 * PANEL);
        let (right, left) = memory.split_at_mut(2 * PANEL * lanes);
        for start in (0..transducers).step_by(PANEL) {
            let members = PANEL.min(transducers - start);
            for m in 0..members {
                let (row_re, rest) = right[2 * m * lanes..].split_at_mut(lanes);
                let row_im = &mut rest[..lanes];
                rows.write(s, start + m, row_re, row_im);
                let factor = s.splat(factors(start + m));
                let weighted = groups_mut(&mut left[2 * m * lanes..2 * (m + 1) * lanes]).iter_mut();
                for (to, from) in weighted.zip(groups(row_re).iter().chain(groups(row_im))) {
                    s.store(s.mul(factor, s.load(from)), to);
                }
            }
            let (right, left) = (&right[..2 * members * lanes], &left[..2 * members * lanes]);
            for k in (0..count).step_by(4) {
                let groups = lanes / LANES;
                let mut group = k / LANES;
                while group + 2 <= groups {
                    tile::<_, 2>(s, left, right, lanes, k, group, [&mut *re, &mut *im]);
                    group += 2;
                }
                if group < groups {
                    tile::<_, 1>(s, left, right, lanes, k, group, [&mut *re, &mut *im]);
                }
            }
        }
        for k in 0..count {
            for l in 0..k / LANES * LANES {
                re[k * lanes + l] = re[l * lanes + k];
                im[k * lanes + l] = -im[l * lanes + k];
            }
        }
    });
}

/// Adds a panel's part to the 4 x (16 N) entries from row k and group `group` on. Rows beyond the last point land
/// in padding: `re` and `im` hold a multiple of 4 rows.
#[inline(always)]
fn tile<S: Simd, const N: usize>(
    s: S,
    left: &[f32],
    right: &[f32],
    lanes: usize,
    k: usize,
    group: usize,
    [re, im]: [&mut [f32]; 2],
) {
    let mut sums = [[[s.splat(0.0); N]; 2]; 4];
    let at = group * LANES;
    for (left, right) in left.chunks_exact(2 * lanes).zip(right.chunks_exact(2 * lanes)) {
        let (ours_re, ours_im) = (&left[k..k + 4], &left[lanes + k..lanes + k + 4]);
        let (theirs_re, theirs_im) =
            (groups(&right[at..at + N * LANES]), groups(&right[lanes + at..lanes + at + N * LANES]));
        for g in 0..N {
            let (tr, ti) = (s.load(&theirs_re[g]), s.load(&theirs_im[g]));
            for row in 0..4 {
                let (or, oi) = (s.splat(ours_re[row]), s.splat(ours_im[row]));
                let [sum_re, sum_im] = &mut sums[row];
                sum_re[g] = s.fma(or, tr, s.fma(oi, ti, sum_re[g]));
                sum_im[g] = s.fma(or, ti, s.fnma(oi, tr, sum_im[g]));
            }
        }
    }
    for (row, sums) in sums.into_iter().enumerate() {
        let start = (k + row) * lanes + at;
        // Padding of the last rows.
        if start + N * LANES > re.len() {
            return;
        }
        for (part, sums) in [&mut *re, &mut *im].into_iter().zip(sums) {
            for (to, sum) in groups_mut(&mut part[start..start + N * LANES]).iter_mut().zip(sums) {
                s.store(s.add(s.load(to), sum), to);
            }
        }
    }
}
