//! G stored in tiles of 16 transducers (in the lanes) by 4 points: layout, sweeps, rotations, Jacobians.
//!
//! No sum runs across lanes before the last tile, and 4 points are not padded to 16. Four points' rows lie together,
//! tile after tile, then the rows of the next four points: kernels that go over rows read memory in its order.

pub(crate) mod error_diffusion;
pub(crate) mod phases;
pub(crate) mod products;
pub(crate) mod unit;

use crate::kernels::lanes::Block;
use crate::kernels::prelude::*;
use crate::kernels::propagate::rows::Rows;
use crate::kernels::vector::add_wave;

/// Returns the length of a vector over the transducers: whole pairs of tiles.
pub(crate) const fn lanes(transducers: usize) -> usize {
    transducers.next_multiple_of(2 * LANES)
}

/// Returns the number of rows for `count` points: whole blocks of four.
pub(crate) const fn height(count: usize) -> usize {
    count.next_multiple_of(BLOCK)
}

/// Returns the distance from one block of rows to the next, in lane groups of four rows. It is one more than the number
/// of tiles: with an even distance the rows of a tile would compete for the same line of the nearest cache.
pub(crate) const fn stride(lanes: usize) -> usize {
    lanes / LANES + 1
}

/// Returns the length of a plane with `rows` (whole blocks) over `lanes`.
pub(crate) const fn size(rows: usize, lanes: usize) -> usize {
    rows * LANES * stride(lanes)
}

pub(crate) fn blocks(plane: &[f32]) -> &[Block] {
    groups(plane).as_chunks().0
}

fn blocks_mut(plane: &mut [f32]) -> &mut [Block] {
    groups_mut(plane).as_chunks_mut().0
}

/// G as tiles over [`lanes`]: real and imaginary planes.
#[derive(Clone, Copy)]
pub(crate) struct Tiles<'a> {
    pub(crate) planes: [&'a [f32]; 2],
    pub(crate) lanes: usize,
}

impl<'a> Tiles<'a> {
    /// Returns whether a transducer reaches any point.
    pub(crate) fn reaches(&self, transducer: usize) -> bool {
        let (tile, lane) = (transducer / LANES, transducer % LANES);
        let mut tiles = self.planes.into_iter().flat_map(|plane| blocks(plane).chunks_exact(stride(self.lanes)));
        // The first point is checked first, because nearly every transducer reaches it.
        blocks(self.planes[0])[tile][0][lane] != 0.0 || tiles.any(|rows| rows[tile].iter().any(|row| row[lane] != 0.0))
    }

    /// Returns the real and imaginary parts of four rows, tile after tile.
    #[inline(always)]
    pub(crate) fn rows(&self, block: usize) -> [&'a [Block]; 2] {
        let first = block * stride(self.lanes);
        self.planes.map(|plane| &blocks(plane)[first..first + self.lanes / LANES])
    }

    /// Iterates over the real and imaginary parts of K tiles, four rows at a time.
    #[inline(always)]
    fn columns<const K: usize>(&self, tile: usize) -> impl Iterator<Item = [&'a [Block; K]; 2]> + Clone + use<'a, K> {
        let stride = stride(self.lanes);
        let [re, im] = self.planes.map(|plane| blocks(plane).chunks_exact(stride));
        re.zip(im).map(
            #[inline(always)]
            move |(re, im)| [re, im].map(|tiles| tiles[tile..].first_chunk().expect("as many tiles")),
        )
    }
}

/// A drive and its pressures at the points, real and imaginary parts.
pub(crate) struct Wave<'a> {
    pub(crate) drive: [&'a mut [f32]; 2],
    pub(crate) field: [&'a mut [f32]; 2],
}

/// Returns whether each of the first `transducers` has a drive other than 0 and a G other than 0 at the first point.
pub(crate) fn all_sound(set: InstructionSet, tiles: Tiles<'_>, drive: [&[f32]; 2], transducers: usize) -> bool {
    dispatch!(set, s => {
        let [qr, qi] = drive.map(groups);
        let [gr, gi] = tiles.planes.map(blocks);
        let mut missing = 0;
        for (t, ((gr, gi), (qr, qi))) in gr.iter().zip(gi).zip(qr.iter().zip(qi)).enumerate() {
            let mask = (1 << transducers.saturating_sub(t * LANES).min(LANES)) - 1;
            let reach = s.add(s.abs(s.load(&gr[0])), s.abs(s.load(&gi[0])));
            let sound = s.add(s.abs(s.load(qr)), s.abs(s.load(qi)));
            missing |= mask & !s.less(s.splat(0.0), s.min(reach, sound));
        }
        missing == 0
    })
}

/// Writes G of the transducers `members` as tiles: row `k` is point `order[k]`. Rows and lanes beyond the last point
/// and transducer get 0.
///
/// # Errors
/// A requested stop, which is checked once a tile.
pub(crate) fn pack(
    set: InstructionSet,
    rows: Rows<'_>,
    members: Range<usize>,
    order: &[u32],
    out: [&mut [f32]; 2],
    control: &mut Control,
) -> Result<()> {
    dispatch!(set, s => {
        let lanes = lanes(members.len());
        let [re, im] = out.map(blocks_mut);
        let last = order.len() / BLOCK * stride(lanes);
        for plane in [&mut *re, &mut *im] {
            plane[last..].as_flattened_mut().fill([0.0; LANES]);
        }
        for tile in 0..lanes / LANES {
            control.pulse()?;
            let first = members.start + tile * LANES;
            let range = first.min(members.end)..(first + LANES).min(members.end);
            rows.write_tile(s, tile, stride(lanes), range, order, [&mut *re, &mut *im]);
        }
        Ok(())
    })
}

/// Multiplies G of each transducer by its factor.
pub(crate) fn weigh(set: InstructionSet, plane: &mut [f32], factors: &[f32]) {
    dispatch!(set, s => {
        for rows in blocks_mut(plane).chunks_exact_mut(stride(factors.len())) {
            for (block, factor) in rows.iter_mut().zip(groups(factors)) {
                let factor = s.load(factor);
                for row in block {
                    s.store(s.mul(factor, s.load(row)), row);
                }
            }
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

/// Computes the pressures P = G q of drives q, four rows at a time.
#[inline(always)]
fn sound<S: Simd>(s: S, tiles: Tiles<'_>, [qr, qi]: [&[Lanes]; 2], [re, im]: [&mut [f32]; 2]) {
    let field = re.as_chunks_mut::<BLOCK>().0.iter_mut().zip(im.as_chunks_mut::<BLOCK>().0);
    for (block, (re, im)) in field.enumerate() {
        let [gr, gi] = tiles.rows(block);
        let mut sums = [[s.splat(0.0); 2]; BLOCK];
        for ((gr, gi), (qr, qi)) in gr.iter().zip(gi).zip(qr.iter().zip(qi)) {
            let q = [s.load(qr), s.load(qi)];
            for (sum, (gr, gi)) in sums.iter_mut().zip(gr.iter().zip(gi)) {
                *sum = add_wave(s, [s.load(gr), s.load(gi)], q, *sum);
            }
        }
        hear(s, sums, re, im);
    }
}

/// Writes the pressures of four rows, the sums over the lanes.
#[inline(always)]
fn hear<S: Simd>(s: S, sums: [[S::V; 2]; BLOCK], re: &mut [f32; BLOCK], im: &mut [f32; BLOCK]) {
    for ([real, imag], (re, im)) in sums.into_iter().zip(re.iter_mut().zip(im)) {
        (*re, *im) = (s.reduce_add(real), s.reduce_add(imag));
    }
}

/// Computes the pressures P = G q of the wave's own drive.
pub(crate) fn play(set: InstructionSet, tiles: Tiles<'_>, wave: Wave<'_>) {
    dispatch!(set, s => {
        let [qr, qi] = wave.drive;
        sound(s, tiles, [groups(qr), groups(qi)], wave.field);
    });
}

/// Returns b = sum_j conj(G_j) p_j over points j of pressure p_j, for the transducers of two tiles.
#[inline(always)]
fn correlated<S: Simd>(s: S, tiles: Tiles<'_>, t: usize, [pr, pi]: [&[[f32; BLOCK]]; 2]) -> [[S::V; 2]; 2] {
    // These sums are independent, so the processor adds them at once.
    let mut sums = [[s.splat(0.0); 4]; 2];
    for ([gr, gi], (pr, pi)) in tiles.columns::<2>(t).zip(pr.iter().zip(pi)) {
        for row in 0..BLOCK {
            let (pr, pi) = (s.splat(pr[row]), s.splat(pi[row]));
            for (tile, sums) in sums.iter_mut().enumerate() {
                let (gr, gi) = (s.load(&gr[tile][row]), s.load(&gi[tile][row]));
                *sums =
                    [s.fma(gr, pr, sums[0]), s.fma(gi, pi, sums[1]), s.fma(gr, pi, sums[2]), s.fma(gi, pr, sums[3])];
            }
        }
    }
    sums.map(
        #[inline(always)]
        |[a, b, c, d]| [s.add(a, b), s.sub(c, d)],
    )
}

/// Writes b = sum_j conj(G_j) p_j over points j of pressure p_j, for every transducer.
pub(crate) fn correlate(set: InstructionSet, tiles: Tiles<'_>, pressures: [&[f32]; 2], out: [&mut [f32]; 2]) {
    dispatch!(set, s => {
        let [re, im] = out.map(groups_mut);
        let pressures = pressures.map(|plane| plane.as_chunks::<BLOCK>().0);
        for t in (0..re.len()).step_by(2) {
            for (tile, [real, imag]) in correlated(s, tiles, t, pressures).into_iter().enumerate() {
                s.store(real, &mut re[t + tile]);
                s.store(imag, &mut im[t + tile]);
            }
        }
    });
}

/// Multiplies G of each transducer by its q; afterwards, drives are relative to these q.
pub(crate) fn rotate_columns(set: InstructionSet, [re, im]: [&mut [f32]; 2], [qr, qi]: [&[f32]; 2]) {
    dispatch!(set, s => {
        let each = stride(qr.len());
        for (re, im) in blocks_mut(re).chunks_exact_mut(each).zip(blocks_mut(im).chunks_exact_mut(each)) {
            for ((re, im), (qr, qi)) in re.iter_mut().zip(im).zip(groups(qr).iter().zip(groups(qi))) {
                let q = [s.load(qr), s.load(qi)];
                for (re, im) in re.iter_mut().zip(im) {
                    let zero = [s.splat(0.0); 2];
                    let [real, imag] = add_wave(s, [s.load(re), s.load(im)], q, zero);
                    s.store(real, re);
                    s.store(imag, im);
                }
            }
        }
    });
}

/// Writes the slopes of equations as rows of a plane: f Re(G q) + g Im(G q) at each of `points`, with `factors` f and
/// g.
///
/// # Errors
/// A requested stop, which is checked once a row.
pub(crate) fn slopes(
    set: InstructionSet,
    tiles: Tiles<'_>,
    drive: [&[f32]; 2],
    factors: [&[f32]; 2],
    points: impl Iterator<Item = usize>,
    out: &mut [f32],
    control: &mut Control,
) -> Result<()> {
    dispatch!(set, s => {
        let [qr, qi] = drive.map(groups);
        let out = blocks_mut(out);
        let stride = stride(tiles.lanes);
        let mut rows = 0;
        for ((k, point), (&f, &g)) in points.enumerate().zip(factors[0].iter().zip(factors[1])) {
            control.pulse()?;
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
        // The rows below the last equation are 0.
        if let Some(last) = out.chunks_exact_mut(stride).nth(rows / BLOCK) {
            for block in last {
                block[rows % BLOCK..].fill([0.0; LANES]);
            }
        }
        Ok(())
    })
}

/// out = sum_k factor_k row_k over the rows of a plane; returns the largest modulus.
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
