//! Products of the rows of tiles: J J^T and G G^H.
//!
//! Four rows meet four (two, if complex) over a run of tiles short enough for the nearest cache, their 16 sums in
//! registers.

use super::level::{Level, dispatch};
use super::tiles::{BLOCK, Tiles};
use super::{Lanes, groups, padded};

/// Tiles that rows meet over before the next rows are fetched: eight planes of them are 16 KB.
const RUN: usize = 32;

/// The upper half of J J^T, J given in tiles of `rows` rows: a matrix of `size` padded rows.
pub(crate) fn products(level: Level, tiles: &[f32], rows: usize, size: usize, matrix: &mut [f32]) {
    dispatch!(level, s => {
        let lanes = padded(size);
        matrix.fill(0.0);
        for run in groups(tiles).chunks(RUN * rows) {
            for k in (0..size).step_by(BLOCK) {
                for l in (k..size).step_by(BLOCK) {
                    let mut sums = [[s.splat(0.0); BLOCK]; BLOCK];
                    for tile in run.chunks_exact(rows) {
                        let right = [s.load(&tile[l]), s.load(&tile[l + 1]), s.load(&tile[l + 2]), s.load(&tile[l + 3])];
                        for (sums, row) in sums.iter_mut().zip(&tile[k..k + BLOCK]) {
                            let row = s.load(row);
                            for (sum, right) in sums.iter_mut().zip(right) {
                                *sum = s.fma(row, right, *sum);
                            }
                        }
                    }
                    let [a, b, c, d] = sums;
                    let mut parts: Lanes = [0.0; 16];
                    s.store(s.sums(&[
                        a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3],
                        c[0], c[1], c[2], c[3], d[0], d[1], d[2], d[3],
                    ]), &mut parts);
                    for (k, parts) in (k..size).zip(parts.chunks_exact(BLOCK)) {
                        for (l, part) in (l..size).zip(parts) {
                            matrix[k * lanes + l] += part;
                        }
                    }
                }
            }
        }
    });
}

/// The upper half of G G^H over the first `size` points.
pub(crate) fn couplings(level: Level, tiles: Tiles<'_>, size: usize, matrix: [&mut [f32]; 2]) {
    dispatch!(level, s => {
        let [to_re, to_im] = matrix;
        to_re.fill(0.0);
        to_im.fill(0.0);
        let [all_re, all_im] = tiles.planes.map(|plane| groups(plane).chunks(RUN * tiles.count));
        for (run_re, run_im) in all_re.zip(all_im) {
            for l in (0..size).step_by(BLOCK) {
                for k in (0..size.min(l + BLOCK)).step_by(BLOCK / 2) {
                    let mut sums = [[[s.splat(0.0); 2]; 2]; BLOCK];
                    for (re, im) in run_re.chunks_exact(tiles.count).zip(run_im.chunks_exact(tiles.count)) {
                        let left = [[s.load(&re[k]), s.load(&im[k])], [s.load(&re[k + 1]), s.load(&im[k + 1])]];
                        for (sums, (re, im)) in sums.iter_mut().zip(re[l..l + BLOCK].iter().zip(&im[l..l + BLOCK])) {
                            let (re, im) = (s.load(re), s.load(im));
                            for ([real, imag], [own_re, own_im]) in sums.iter_mut().zip(left) {
                                *real = s.fma(own_re, re, s.fma(own_im, im, *real));
                                *imag = s.fma(own_im, re, s.fnma(own_re, im, *imag));
                            }
                        }
                    }
                    let [a, b, c, d] = sums;
                    let mut parts: Lanes = [0.0; 16];
                    s.store(s.sums(&[
                        a[0][0], a[1][0], b[0][0], b[1][0], c[0][0], c[1][0], d[0][0], d[1][0],
                        a[0][1], a[1][1], b[0][1], b[1][1], c[0][1], c[1][1], d[0][1], d[1][1],
                    ]), &mut parts);
                    let (re, im) = parts.split_at(2 * BLOCK);
                    for (to, parts) in [(&mut *to_re, re), (&mut *to_im, im)] {
                        for (l, parts) in (l..size).zip(parts.chunks_exact(2)) {
                            for (k, part) in (k..size).zip(parts) {
                                to[k * size + l] += part;
                            }
                        }
                    }
                }
            }
        }
    });
}
