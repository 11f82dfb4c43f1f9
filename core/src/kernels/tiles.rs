//! Transducers in the lanes: G as tiles, a tile the gains of 16 transducers at every point, 16 numbers a point.
//!
//! A tile stays in the nearest cache while a wave goes from the points to its transducers and back; no sum runs
//! across lanes before the last tile, and 4 points are not padded to 16.

use super::level::{Level, dispatch};
use super::rows::Rows;
use super::simd::{Simd, TINY};
use super::{LANES, Lanes, groups, groups_mut};

/// Rows met at once by [`super::products`].
pub(super) const BLOCK: usize = 4;

/// Rows of a tile that holds `count`: padded to whole blocks, and past a multiple of 32 rows, at which a row of each
/// tile would want the same place in the nearest cache.
pub(crate) const fn height(count: usize) -> usize {
    let rows = count.next_multiple_of(BLOCK);
    if rows.is_multiple_of(32) { rows + BLOCK } else { rows }
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

/// Writes G as tiles: row `k` of each is point `order[k]` times `scale[k]`, zeros beyond the last point.
pub(crate) fn pack(
    level: Level,
    rows: Rows<'_>,
    transducers: usize,
    points: (&[u32], &[f32]),
    out: [&mut [f32]; 2],
) {
    dispatch!(level, s => {
        let (order, scale) = points;
        let [re, im] = out.map(groups_mut);
        let tiles = re.chunks_exact_mut(scale.len()).zip(im.chunks_exact_mut(scale.len()));
        for (t, (re, im)) in tiles.enumerate() {
            let (re, re_padding) = re.split_at_mut(order.len());
            let (im, im_padding) = im.split_at_mut(order.len());
            rows.write_tile(s, (t * LANES, transducers), (order, scale), [re, im]);
            re_padding.fill([0.0; LANES]);
            im_padding.fill([0.0; LANES]);
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
