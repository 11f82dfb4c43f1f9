//! Transducers in the lanes: G in tiles, a tile the propagation of 16 transducers at every point, 16 numbers a point.
//!
//! No sum runs across lanes before the last tile, and 4 points are not padded to 16. Four points' rows lie together,
//! tile after tile, then the next four's: whatever takes rows runs over memory in its order.

pub(crate) mod phases;
pub(crate) mod products;

use crate::kernels::lanes::{LANES, Lanes, groups, groups_mut};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::simd::{Simd, TINY};

/// Rows that lie together.
pub(crate) const BLOCK: usize = 4;

/// Four rows of a tile.
pub(crate) type Block = [Lanes; BLOCK];

/// Length of a vector over the transducers: whole pairs of tiles.
pub(crate) const fn lanes(transducers: usize) -> usize {
    transducers.next_multiple_of(2 * LANES)
}

/// Rows for `count` points: whole blocks.
pub(crate) const fn height(count: usize) -> usize {
    count.next_multiple_of(BLOCK)
}

/// Blocks from four rows to the next four: one more than there are, since at an even number the rows of a tile would
/// want the same place in the nearest cache.
pub(crate) const fn stride(lanes: usize) -> usize {
    lanes / LANES + 1
}

/// Numbers of `rows` (whole blocks) over `lanes`.
pub(crate) const fn size(rows: usize, lanes: usize) -> usize {
    rows * LANES * stride(lanes)
}

pub(crate) fn blocks(plane: &[f32]) -> &[Block] {
    groups(plane).as_chunks().0
}

fn blocks_mut(plane: &mut [f32]) -> &mut [Block] {
    groups_mut(plane).as_chunks_mut().0
}

/// G over [`lanes`].
#[derive(Clone, Copy)]
pub(crate) struct Tiles<'a> {
    pub(crate) planes: [&'a [f32]; 2],
    pub(crate) lanes: usize,
}

impl<'a> Tiles<'a> {
    /// Re and im of four rows, tile after tile.
    #[inline(always)]
    pub(crate) fn rows(&self, block: usize) -> [&'a [Block]; 2] {
        let first = block * stride(self.lanes);
        self.planes.map(|plane| &blocks(plane)[first..first + self.lanes / LANES])
    }

    /// Re and im of a tile and the next, four rows after four.
    #[inline(always)]
    fn pair(&self, tile: usize) -> impl Iterator<Item = [&'a [Block]; 2]> + Clone + use<'a> {
        let stride = stride(self.lanes);
        let [re, im] = self.planes.map(|plane| blocks(plane).chunks_exact(stride));
        re.zip(im).map(
            #[inline(always)]
            move |(re, im)| [&re[tile..tile + 2], &im[tile..tile + 2]],
        )
    }
}

/// A drive and what it makes at the points, re and im.
pub(crate) struct Wave<'a> {
    pub(crate) drive: [&'a mut [f32]; 2],
    pub(crate) field: [&'a mut [f32]; 2],
}

/// Writes G as tiles: row `k` is point `order[k]` times `scale[k]`, zeros beyond the last point and transducer.
pub(crate) fn pack(
    set: InstructionSet,
    rows: Rows<'_>,
    transducers: usize,
    points: (&[u32], &[f32]),
    out: [&mut [f32]; 2],
) {
    dispatch!(set, s => {
        let lanes = lanes(transducers);
        let [re, im] = out.map(blocks_mut);
        let last = points.0.len() / BLOCK * stride(lanes);
        for plane in [&mut *re, &mut *im] {
            plane[last..].as_flattened_mut().fill([0.0; LANES]);
        }
        for tile in 0..lanes / LANES {
            rows.write_tile(s, (tile, stride(lanes)), transducers, points, [&mut *re, &mut *im]);
        }
    });
}

/// Multiplies row `k` of a plane over `lanes` by `factor`.
pub(crate) fn rescale(plane: &mut [f32], lanes: usize, k: usize, factor: f32) {
    let first = k / BLOCK * stride(lanes);
    for block in &mut blocks_mut(plane)[first..first + lanes / LANES] {
        block[k % BLOCK].iter_mut().for_each(|x| *x *= factor);
    }
}

/// z/|z|, 0 where |z|^2 is below [`TINY`].
#[inline(always)]
fn unit<S: Simd>(s: S, [re, im]: [S::V; 2]) -> [S::V; 2] {
    let square = s.fma(re, re, s.mul(im, im));
    let tiny = s.splat(TINY);
    let inverse = s.select_less(square, tiny, s.splat(0.0), s.rsqrt(s.max(square, tiny)));
    [s.mul(re, inverse), s.mul(im, inverse)]
}

/// Drives the array two tiles at a time, then hears it, four rows at a time.
#[inline(always)]
fn play<S: Simd>(s: S, tiles: Tiles<'_>, wave: Wave<'_>, mut drive: impl FnMut(usize) -> [[S::V; 2]; 2]) {
    let Wave { drive: [qr, qi], field: [re, im] } = wave;
    let (qr, qi) = (groups_mut(qr), groups_mut(qi));
    for t in (0..qr.len()).step_by(2) {
        let [[ar, ai], [br, bi]] = drive(t);
        s.store(ar, &mut qr[t]);
        s.store(ai, &mut qi[t]);
        s.store(br, &mut qr[t + 1]);
        s.store(bi, &mut qi[t + 1]);
    }
    let field = re.as_chunks_mut::<BLOCK>().0.iter_mut().zip(im.as_chunks_mut::<BLOCK>().0);
    for (block, (re, im)) in field.enumerate() {
        let [gr, gi] = tiles.rows(block);
        let mut sums = [[s.splat(0.0); 2]; BLOCK];
        for ((gr, gi), (qr, qi)) in gr.iter().zip(gi).zip(qr.iter().zip(&*qi)) {
            let (qr, qi) = (s.load(qr), s.load(qi));
            for ([real, imag], (gr, gi)) in sums.iter_mut().zip(gr.iter().zip(gi)) {
                let (gr, gi) = (s.load(gr), s.load(gi));
                *real = s.fma(gr, qr, s.fnma(gi, qi, *real));
                *imag = s.fma(gr, qi, s.fma(gi, qr, *imag));
            }
        }
        for ([real, imag], (re, im)) in sums.into_iter().zip(re.iter_mut().zip(im)) {
            (*re, *im) = (s.reduce_add(real), s.reduce_add(imag));
        }
    }
}

/// q = b/|b| with b = sum_j conj(G_j) p_j, 0 where b is, and P = G q.
pub(crate) fn sweep(set: InstructionSet, tiles: Tiles<'_>, wanted: [&[f32]; 2], wave: Wave<'_>) {
    dispatch!(set, s => {
        let [pr, pi] = wanted.map(|plane| plane.as_chunks::<BLOCK>().0);
        play(s, tiles, wave, #[inline(always)] |t| {
            // Sums that do not wait for one another.
            let mut sums = [[s.splat(0.0); 4]; 2];
            for ([gr, gi], (pr, pi)) in tiles.pair(t).zip(pr.iter().zip(pi)) {
                for row in 0..BLOCK {
                    let (pr, pi) = (s.splat(pr[row]), s.splat(pi[row]));
                    for (tile, sums) in sums.iter_mut().enumerate() {
                        let (gr, gi) = (s.load(&gr[tile][row]), s.load(&gi[tile][row]));
                        *sums = [
                            s.fma(gr, pr, sums[0]),
                            s.fma(gi, pi, sums[1]),
                            s.fma(gr, pi, sums[2]),
                            s.fma(gi, pr, sums[3]),
                        ];
                    }
                }
            }
            let [a, b] = sums;
            [unit(s, [s.add(a[0], a[1]), s.sub(a[2], a[3])]), unit(s, [s.add(b[0], b[1]), s.sub(b[2], b[3])])]
        });
    });
}

/// q = (r + j f d r) / |.| of another drive r and turns d, and P = G q: e^{jfd} r but for (f d)^3/3.
pub(crate) fn turn(
    set: InstructionSet,
    tiles: Tiles<'_>,
    from: [&[f32]; 2],
    turns: &[f32],
    factor: f32,
    wave: Wave<'_>,
) {
    #[inline(always)]
    fn turned<S: Simd>(s: S, re: &Lanes, im: &Lanes, turn: &Lanes, factor: f32) -> [S::V; 2] {
        let (re, im) = (s.load(re), s.load(im));
        let turn = s.mul(s.splat(factor), s.load(turn));
        unit(s, [s.fnma(turn, im, re), s.fma(turn, re, im)])
    }
    dispatch!(set, s => {
        let ([re, im], turns) = (from.map(groups), groups(turns));
        play(s, tiles, wave, #[inline(always)] |t| [
            turned(s, &re[t], &im[t], &turns[t], factor),
            turned(s, &re[t + 1], &im[t + 1], &turns[t + 1], factor),
        ]);
    });
}

/// The slopes of the equations as the rows of a plane: f Re(G q) + g Im(G q) of the points `points`, in their order.
pub(crate) fn slopes(
    set: InstructionSet,
    tiles: Tiles<'_>,
    drive: [&[f32]; 2],
    factors: [&[f32]; 2],
    points: impl Iterator<Item = usize>,
    out: &mut [f32],
) {
    dispatch!(set, s => {
        let [qr, qi] = drive.map(groups);
        let out = blocks_mut(out);
        let stride = stride(tiles.lanes);
        let mut rows = 0;
        for ((k, point), (&f, &g)) in points.enumerate().zip(factors[0].iter().zip(factors[1])) {
            let [gr, gi] = tiles.rows(point / BLOCK);
            let (f, g) = (s.splat(f), s.splat(g));
            let to = &mut out[k / BLOCK * stride..][..gr.len()];
            for (((gr, gi), (qr, qi)), to) in gr.iter().zip(gi).zip(qr.iter().zip(qi)).zip(to) {
                let (gr, gi) = (s.load(&gr[point % BLOCK]), s.load(&gi[point % BLOCK]));
                let (qr, qi) = (s.load(qr), s.load(qi));
                let (re, im) = (s.fnma(gi, qi, s.mul(gr, qr)), s.fma(gi, qr, s.mul(gr, qi)));
                s.store(s.fma(f, re, s.mul(g, im)), &mut to[k % BLOCK]);
            }
            rows = k + 1;
        }
        // Zeros below the last equation.
        if let Some(last) = out.chunks_exact_mut(stride).nth(rows / BLOCK) {
            for block in last {
                block[rows % BLOCK..].fill([0.0; LANES]);
            }
        }
    });
}

/// out = sum_k factor_k row_k over the rows of a plane; the largest modulus.
pub(crate) fn combine(set: InstructionSet, plane: &[f32], factors: &[f32], out: &mut [f32]) -> f32 {
    dispatch!(set, s => {
        let mut most = s.splat(0.0);
        let stride = stride(out.len());
        for (t, out) in groups_mut(out).iter_mut().enumerate() {
            let mut sums = [s.splat(0.0); BLOCK];
            let column = blocks(plane).chunks_exact(stride);
            for (rows, factors) in column.zip(factors.as_chunks::<BLOCK>().0) {
                for (sum, (row, &factor)) in sums.iter_mut().zip(rows[t].iter().zip(factors)) {
                    *sum = s.fma(s.splat(factor), s.load(row), *sum);
                }
            }
            let total = s.add(s.add(sums[0], sums[1]), s.add(sums[2], sums[3]));
            s.store(total, out);
            most = s.max(s.abs(total), most);
        }
        s.reduce_max(most)
    })
}
