//! Products of the rows of tiles: J J^T and G G^H.
//!
//! Four rows are multiplied by four (complex: two by four), over a run of tiles that fits the nearest cache. Their 16
//! sums stay in registers.

use crate::kernels::prelude::*;
use crate::kernels::tiles::{Tiles, blocks, stride};
use crate::kernels::vector::root;

/// Number of tiles in a run, over which rows are multiplied before the next rows follow. In a run, eight planes take 16
/// KB.
pub(crate) const RUN: usize = 32;

/// Writes the upper half of J J^T to a matrix of `size` padded rows. The rows of J are those of a plane, each with a
/// length of `lanes`.
///
/// # Errors
/// A requested stop, which is checked once every few rows.
pub(crate) fn products(
    set: InstructionSet,
    plane: &[f32],
    lanes: usize,
    size: usize,
    matrix: &mut [f32],
    control: &mut Control,
) -> Result<()> {
    dispatch!(set, s => {
        let wide = padded(size);
        matrix.fill(0.0);
        let rows = |k: usize| &blocks(plane)[k / BLOCK * stride(lanes)..][..lanes / LANES];
        for first in (0..lanes / LANES).step_by(RUN) {
            let run = first..(first + RUN).min(lanes / LANES);
            for k in (0..size).step_by(BLOCK) {
                control.pulse()?;
                let left = &rows(k)[run.clone()];
                for l in (k..size).step_by(BLOCK) {
                    let mut sums = [[s.splat(0.0); BLOCK]; BLOCK];
                    for (left, right) in left.iter().zip(&rows(l)[run.clone()]) {
                        let right = [s.load(&right[0]), s.load(&right[1]), s.load(&right[2]), s.load(&right[3])];
                        for (sums, left) in sums.iter_mut().zip(left) {
                            let left = s.load(left);
                            for (sum, right) in sums.iter_mut().zip(right) {
                                *sum = s.fma(left, right, *sum);
                            }
                        }
                    }
                    let [a, b, c, d] = sums;
                    let mut parts: Lanes = [0.0; LANES];
                    s.store(s.reduce_add_each(&[
                        a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3],
                        c[0], c[1], c[2], c[3], d[0], d[1], d[2], d[3],
                    ]), &mut parts);
                    for (k, parts) in (k..size).zip(parts.chunks_exact(BLOCK)) {
                        for (l, part) in (l..size).zip(parts) {
                            matrix[k * wide + l] += part;
                        }
                    }
                }
            }
        }
        Ok(())
    })
}

/// Adds the upper half of G G^H over the first `size` points and the tiles of `over`.
///
/// # Errors
/// A requested stop, which is checked once every few rows.
pub(crate) fn couplings(
    set: InstructionSet,
    tiles: Tiles<'_>,
    over: Range<usize>,
    size: usize,
    matrix: [&mut [f32]; 2],
    control: &mut Control,
) -> Result<()> {
    /// Number of complex rows that are multiplied by four other rows at once.
    const PAIR: usize = 2;
    dispatch!(set, s => {
        let [to_re, to_im] = matrix;
        let wide = to_re.len() / size;
        for first in over.clone().step_by(RUN) {
            let run = first..(first + RUN).min(over.end);
            for l in (0..size).step_by(BLOCK) {
                control.pulse()?;
                let [right_re, right_im] = tiles.rows(l / BLOCK).map(|rows| &rows[run.clone()]);
                for k in (0..size.min(l + BLOCK)).step_by(PAIR) {
                    let [left_re, left_im] = tiles.rows(k / BLOCK).map(|rows| &rows[run.clone()]);
                    let at = k % BLOCK;
                    let mut sums = [[[s.splat(0.0); 2]; PAIR]; BLOCK];
                    for ((re, im), (own_re, own_im)) in right_re.iter().zip(right_im).zip(left_re.iter().zip(left_im)) {
                        let left = [
                            [s.load(&own_re[at]), s.load(&own_im[at])],
                            [s.load(&own_re[at + 1]), s.load(&own_im[at + 1])],
                        ];
                        for (sums, (re, im)) in sums.iter_mut().zip(re.iter().zip(im)) {
                            let (re, im) = (s.load(re), s.load(im));
                            for ([real, imag], [own_re, own_im]) in sums.iter_mut().zip(left) {
                                *real = s.fma(own_re, re, s.fma(own_im, im, *real));
                                *imag = s.fma(own_im, re, s.fnma(own_re, im, *imag));
                            }
                        }
                    }
                    let [a, b, c, d] = sums;
                    let mut parts: Lanes = [0.0; LANES];
                    s.store(s.reduce_add_each(&[
                        a[0][0], a[1][0], b[0][0], b[1][0], c[0][0], c[1][0], d[0][0], d[1][0],
                        a[0][1], a[1][1], b[0][1], b[1][1], c[0][1], c[1][1], d[0][1], d[1][1],
                    ]), &mut parts);
                    let (re, im) = parts.split_at(PAIR * BLOCK);
                    for (to, parts) in [(&mut *to_re, re), (&mut *to_im, im)] {
                        for (l, parts) in (l..size).zip(parts.chunks_exact(PAIR)) {
                            for (k, part) in (k..size).zip(parts) {
                                to[k * wide + l] += part;
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    })
}

/// Writes sum |G|^2 of each row.
pub(crate) fn powers(set: InstructionSet, tiles: Tiles<'_>, out: &mut [f32]) {
    dispatch!(set, s => {
        for (k, out) in out.iter_mut().enumerate() {
            let [re, im] = tiles.rows(k / BLOCK);
            let mut sums = [s.splat(0.0); 2];
            for (re, im) in re.iter().zip(im) {
                let (re, im) = (s.load(&re[k % BLOCK]), s.load(&im[k % BLOCK]));
                sums = [s.fma(re, re, sums[0]), s.fma(im, im, sums[1])];
            }
            *out = s.reduce_add(s.add(sums[0], sums[1]));
        }
    });
}

/// Writes sum_j f_j |G_j| for each transducer, with the factors f.
pub(crate) fn moduli(set: InstructionSet, tiles: Tiles<'_>, factors: &[f32], out: &mut [f32]) {
    dispatch!(set, s => {
        for (t, out) in groups_mut(out).iter_mut().enumerate() {
            let mut sum = s.splat(0.0);
            for ([re, im], factors) in tiles.columns::<1>(t).zip(factors.chunks(BLOCK)) {
                for ((re, im), &factor) in re[0].iter().zip(&im[0]).zip(factors) {
                    let (re, im) = (s.load(re), s.load(im));
                    sum = s.fma(s.splat(factor), root(s, s.fma(re, re, s.mul(im, im))), sum);
                }
            }
            s.store(sum, out);
        }
    });
}

/// Returns entry (k, l) of G G^H.
pub(crate) fn coupling(set: InstructionSet, tiles: Tiles<'_>, k: usize, l: usize) -> [f32; 2] {
    dispatch!(set, s => {
        let [mut real, mut imag] = [s.splat(0.0); 2];
        let [[own_re, own_im], [re, im]] = [k, l].map(|k| tiles.rows(k / BLOCK));
        for ((own_re, own_im), (re, im)) in own_re.iter().zip(own_im).zip(re.iter().zip(im)) {
            let (own_re, own_im) = (s.load(&own_re[k % BLOCK]), s.load(&own_im[k % BLOCK]));
            let (re, im) = (s.load(&re[l % BLOCK]), s.load(&im[l % BLOCK]));
            real = s.fma(own_re, re, s.fma(own_im, im, real));
            imag = s.fma(own_im, re, s.fnma(own_re, im, imag));
        }
        [s.reduce_add(real), s.reduce_add(imag)]
    })
}
