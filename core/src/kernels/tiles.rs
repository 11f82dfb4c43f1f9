//! Transducers in the lanes: G as tiles, a tile the gains of 16 transducers at every point, 16 numbers a point.
//!
//! A tile stays in the nearest cache while a wave goes from the points to its transducers and back; no sum runs
//! across lanes before the last tile, and 4 points are not padded to 16.

use super::level::{Level, dispatch};
use super::rows::Rows;
use super::simd::{Simd, TINY};
use super::turns::wave as phasor;
use super::{LANES, Lanes, groups, groups_mut};

/// Rows met at once: four meet two in [`couplings`] and [`products`], and their sums fill the registers.
const LEFT: usize = 4;
const RIGHT: usize = 2;

/// Rows of a tile that holds `count`: padded to whole blocks, and past a multiple of 32 rows, at which a row of each
/// tile would want the same place in the nearest cache.
pub(crate) const fn height(count: usize) -> usize {
    let rows = count.next_multiple_of(LEFT);
    if rows.is_multiple_of(32) { rows + LEFT } else { rows }
}

/// G, `count` rows of lanes a tile.
#[derive(Clone, Copy)]
pub(crate) struct Tiles<'a> {
    pub(crate) planes: [&'a [f32]; 2],
    pub(crate) count: usize,
}

impl Tiles<'_> {
    #[inline(always)]
    fn tile(&self, tile: usize) -> [&[Lanes]; 2] {
        let size = self.count * LANES;
        self.planes.map(|plane| groups(&plane[tile * size..(tile + 1) * size]))
    }
}

/// A drive and what it makes at the points, re and im.
pub(crate) struct Wave<'a> {
    pub(crate) drive: [&'a mut [f32]; 2],
    pub(crate) field: [&'a mut [f32]; 2],
    /// Room for 16 numbers a point.
    pub(crate) lanes: [&'a mut [f32]; 2],
}

/// Writes G as tiles: row `k` of each is point `order[k]` times `scale[k]`. `memory` holds 32 rows of `rows`.
pub(crate) fn pack(
    level: Level,
    rows: Rows<'_>,
    transducers: usize,
    points: (&[u32], &[f32]),
    memory: &mut [f32],
    out: [&mut [f32]; 2],
) {
    dispatch!(level, s => {
        let (order, scale) = points;
        let lanes = memory.len() / (2 * LANES);
        let count = scale.len();
        let [re, im] = out;
        for first in (0..transducers).step_by(LANES) {
            let (res, ims) = memory.split_at_mut(LANES * lanes);
            let members = LANES.min(transducers - first);
            for m in 0..members {
                let own = m * lanes..(m + 1) * lanes;
                rows.write(s, first + m, &mut res[own.clone()], &mut ims[own]);
            }
            for (part, all) in [(&*res, &mut *re), (&*ims, &mut *im)] {
                let tile = groups_mut(&mut all[first * count..(first + LANES) * count]);
                for ((to, &j), &scale) in tile.iter_mut().zip(order).zip(scale) {
                    for m in 0..members {
                        to[m] = part[m * lanes + j as usize] * scale;
                    }
                }
            }
        }
    });
}

/// z/|z|, 0 where |z|^2 is below [`TINY`].
#[inline(always)]
fn unit<S: Simd>(s: S, [re, im]: [S::V; 2]) -> [S::V; 2] {
    let square = s.fma(re, re, s.mul(im, im));
    let tiny = s.splat(TINY);
    let inverse = s.select_less(square, tiny, s.splat(0.0), s.inverse_root(s.max(square, tiny)));
    [s.mul(re, inverse), s.mul(im, inverse)]
}

/// Drives the array tile by tile and hears it.
#[inline(always)]
fn play<S: Simd>(
    s: S,
    tiles: Tiles<'_>,
    wave: Wave<'_>,
    mut drive: impl FnMut(usize, [&[Lanes]; 2]) -> [S::V; 2],
) {
    let Wave { drive: [qr, qi], field, lanes } = wave;
    let [re, im] = lanes;
    let (re, im) = (groups_mut(re), groups_mut(im));
    re.fill([0.0; LANES]);
    im.fill([0.0; LANES]);
    for (t, (to_re, to_im)) in groups_mut(qr).iter_mut().zip(groups_mut(qi)).enumerate() {
        let [gr, gi] = tiles.tile(t);
        let [qr, qi] = drive(t, [gr, gi]);
        s.store(qr, to_re);
        s.store(qi, to_im);
        for ((gr, gi), (re, im)) in gr.iter().zip(gi).zip(re.iter_mut().zip(im.iter_mut())) {
            let (gr, gi) = (s.load(gr), s.load(gi));
            s.store(s.fma(gr, qr, s.fnma(gi, qi, s.load(re))), re);
            s.store(s.fma(gr, qi, s.fma(gi, qr, s.load(im))), im);
        }
    }
    for (field, lanes) in field.into_iter().zip([re, im]) {
        for (field, lanes) in field.iter_mut().zip(lanes) {
            *field = s.sum(s.load(lanes));
        }
    }
}

/// q = b/|b| with b = sum_j conj(G_j) p_j, 0 where b is, and P = G q.
pub(crate) fn sweep(level: Level, tiles: Tiles<'_>, wanted: [&[f32]; 2], wave: Wave<'_>) {
    dispatch!(level, s => play(s, tiles, wave, #[inline(always)] |_, [gr, gi]| {
        // Four sums that do not wait for one another.
        let mut sums = [s.splat(0.0); 4];
        for ((gr, gi), (&pr, &pi)) in gr.iter().zip(gi).zip(wanted[0].iter().zip(wanted[1])) {
            let (gr, gi, pr, pi) = (s.load(gr), s.load(gi), s.splat(pr), s.splat(pi));
            sums = [s.fma(gr, pr, sums[0]), s.fma(gi, pi, sums[1]), s.fma(gr, pi, sums[2]), s.fma(gi, pr, sums[3])];
        }
        unit(s, [s.add(sums[0], sums[1]), s.sub(sums[2], sums[3])])
    }));
}

/// q = (r + j f d r) / |.| of another drive r and turns d, and P = G q: e^{jfd} r but for (f d)^3/3.
pub(crate) fn turn(
    level: Level,
    tiles: Tiles<'_>,
    from: [&[f32]; 2],
    turns: &[f32],
    factor: f32,
    wave: Wave<'_>,
) {
    dispatch!(level, s => {
        let ([re, im], turns) = (from.map(groups), groups(turns));
        play(s, tiles, wave, #[inline(always)] |t, _| {
            let (re, im) = (s.load(&re[t]), s.load(&im[t]));
            let turn = s.mul(s.splat(factor), s.load(&turns[t]));
            unit(s, [s.fnma(turn, im, re), s.fma(turn, re, im)])
        });
    });
}

/// The slopes of the equations, row after row: f Re(G q) + g Im(G q) of the first rows of each tile, then of the rows
/// from `again` on once more, with as many factors as there are rows in all.
pub(crate) fn slopes(
    level: Level,
    tiles: Tiles<'_>,
    drive: [&[f32]; 2],
    factors: [&[f32]; 2],
    points: (usize, usize),
    out: &mut [f32],
) {
    dispatch!(level, s => {
        let (count, again) = points;
        let rows = factors[0].len();
        let [qr, qi] = drive.map(groups);
        for (t, out) in groups_mut(out).chunks_exact_mut(rows).enumerate() {
            let [gr, gi] = tiles.tile(t);
            let (qr, qi) = (s.load(&qr[t]), s.load(&qi[t]));
            for (point, (out, (&f, &g))) in (0..count).chain(again..count).zip(out.iter_mut().zip(factors[0].iter().zip(factors[1]))) {
                let (gr, gi) = (s.load(&gr[point]), s.load(&gi[point]));
                let (re, im) = (s.fnma(gi, qi, s.mul(gr, qr)), s.fma(gi, qr, s.mul(gr, qi)));
                s.store(s.fma(s.splat(f), re, s.mul(s.splat(g), im)), out);
            }
        }
    });
}

/// out = sum_k factor_k row_k over each tile of real rows; the largest modulus.
pub(crate) fn combine(level: Level, tiles: &[f32], factors: &[f32], out: &mut [f32]) -> f32 {
    dispatch!(level, s => {
        let mut most = s.splat(0.0);
        for (tile, out) in groups(tiles).chunks_exact(factors.len()).zip(groups_mut(out)) {
            let mut total = s.splat(0.0);
            for (row, &factor) in tile.iter().zip(factors) {
                total = s.fma(s.splat(factor), s.load(row), total);
            }
            s.store(total, out);
            most = s.max(s.abs(total), most);
        }
        s.greatest(most)
    })
}

/// The lower half of J J^T, J given in tiles of `rows` rows: a matrix of `size` x `size`.
pub(crate) fn products(level: Level, tiles: &[f32], rows: usize, size: usize, matrix: &mut [f32]) {
    dispatch!(level, s => {
        let all = groups(tiles);
        for k in (0..size).step_by(LEFT) {
            for l in (0..(k + LEFT).min(size)).step_by(RIGHT) {
                let mut sums = [[s.splat(0.0); RIGHT]; LEFT];
                for tile in all.chunks_exact(rows) {
                    let right = [s.load(&tile[l]), s.load(&tile[l + 1])];
                    for (sums, row) in sums.iter_mut().zip(&tile[k..k + LEFT]) {
                        let row = s.load(row);
                        *sums = [s.fma(row, right[0], sums[0]), s.fma(row, right[1], sums[1])];
                    }
                }
                for (k, sums) in (k..size).zip(sums) {
                    for (l, sum) in (l..size).zip(sums) {
                        matrix[k * size + l] = s.sum(sum);
                    }
                }
            }
        }
    });
}

/// The lower half of G G^H over the first `size` points.
pub(crate) fn couplings(level: Level, tiles: Tiles<'_>, size: usize, matrix: [&mut [f32]; 2]) {
    dispatch!(level, s => {
        let [all_re, all_im] = tiles.planes.map(groups);
        let [to_re, to_im] = matrix;
        for k in (0..size).step_by(LEFT) {
            for l in (0..(k + LEFT).min(size)).step_by(RIGHT) {
                let mut sums = [[[s.splat(0.0); 2]; RIGHT]; LEFT];
                for (re, im) in all_re.chunks_exact(tiles.count).zip(all_im.chunks_exact(tiles.count)) {
                    let right = [l, l + 1].map(|l| [s.load(&re[l]), s.load(&im[l])]);
                    for (sums, (re, im)) in sums.iter_mut().zip(re[k..k + LEFT].iter().zip(&im[k..k + LEFT])) {
                        let (re, im) = (s.load(re), s.load(im));
                        for ([real, imag], [other_re, other_im]) in sums.iter_mut().zip(right) {
                            *real = s.fma(re, other_re, s.fma(im, other_im, *real));
                            *imag = s.fma(im, other_re, s.fnma(re, other_im, *imag));
                        }
                    }
                }
                for (k, sums) in (k..size).zip(sums) {
                    for (l, [real, imag]) in (l..size).zip(sums) {
                        (to_re[k * size + l], to_im[k * size + l]) = (s.sum(real), s.sum(imag));
                    }
                }
            }
        }
    });
}

/// Vectors v of the moduli `shares` and the phases `turns`, sixteen side by side, brought into line: `rounds` times
/// each v_k gets the phase of sum_l C_kl v_l, in the order of `visits`. The sum of |v_k| |sum_l C_kl v_l|.
///
/// Where the sum is silent v_k stays.
pub(crate) fn align(
    level: Level,
    matrix: [&[f32]; 2],
    shares: &[f32],
    visits: &[u32],
    rounds: usize,
    vectors: [&mut [f32]; 2],
) -> Lanes {
    dispatch!(level, s => {
        let [re, im] = vectors.map(groups_mut);
        let size = shares.len();
        let tiny = s.splat(TINY);
        let mut energy = s.splat(0.0);
        for _ in 0..rounds {
            energy = s.splat(0.0);
            for &k in visits {
                let k = k as usize;
                let row = matrix.map(|plane| &plane[k * size..(k + 1) * size]);
                let mut sums = [s.splat(0.0); 4];
                for ((&cr, &ci), (re, im)) in row[0].iter().zip(row[1]).zip(re.iter().zip(im.iter())) {
                    let (cr, ci, re, im) = (s.splat(cr), s.splat(ci), s.load(re), s.load(im));
                    sums = [s.fma(cr, re, sums[0]), s.fma(ci, im, sums[1]), s.fma(cr, im, sums[2]), s.fma(ci, re, sums[3])];
                }
                let (x, y) = (s.sub(sums[0], sums[1]), s.add(sums[2], sums[3]));
                let square = s.fma(x, x, s.mul(y, y));
                let (root, inverse) = s.roots(s.max(square, tiny));
                let share = s.splat(shares[k]);
                energy = s.fma(share, root, energy);
                let scale = s.mul(share, inverse);
                s.store(s.select_less(square, tiny, s.load(&re[k]), s.mul(scale, x)), &mut re[k]);
                s.store(s.select_less(square, tiny, s.load(&im[k]), s.mul(scale, y)), &mut im[k]);
            }
        }
        let mut lanes = [0.0; LANES];
        s.store(energy, &mut lanes);
        lanes
    })
}

/// v = share e^{2 pi j x}, sixteen numbers of each share.
pub(crate) fn phasors(level: Level, turns: &[f32], shares: &[f32], out: [&mut [f32]; 2]) {
    dispatch!(level, s => {
        let [re, im] = out.map(groups_mut);
        for ((turns, &share), (re, im)) in groups(turns).iter().zip(shares).zip(re.iter_mut().zip(im)) {
            let [x, y] = phasor(s, s.load(turns), s.splat(share));
            s.store(x, re);
            s.store(y, im);
        }
    });
}
