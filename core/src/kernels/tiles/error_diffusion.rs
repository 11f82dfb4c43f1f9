//! Error diffusion: an even drive brought to a board's phases, tile after tile, without a trace at the points.
//!
//! ```text
//! r_j = |P_j| - s          what is wrong at a point, s the mean; |P_j| itself at a quiet one;   h_j = conj(P_j)/|P_j|
//! diffuse, for each tile of 16 transducers:
//!     d   = Im(q sum_j G_j w_j r_j h_j)                     steepest descent of sum w r^2 over the tile's phases
//!     k   = sum d^2 / sum_j w_j Re(h_j sum_i G_ij q_i d_i j)^2                   as far as it goes down (line search)
//!     q'  = the board's phase nearest to arg q + k d;   P += sum_i G_i (q'_i - q_i)
//! exchange, for each tile:
//!     the one code whose step up or down lowers sum w r^2 most is taken, if there is one
//! ```
//!
//! Rounding a tile leaves errors at the points; the next tile, which is to be rounded anyway, chooses its codes so that
//! they take them back (Floyd and Steinberg, Proc. SID 17(2), 1976). What remains is what the last tiles could not reach;
//! exchanging single codes (direct binary search, Analoui and Allebach, SPIE 1666, 1992) takes off two thirds of that.
//! Everything is O(N M): one pass takes as long as three or four sweeps.
//!
//! 1. The level s is the mean before the last tile: it is not waited for.
//! 2. sum d^2, which is minus the slope along d, needs no field: it is summed while the field of d is.

use crate::control::Control;
use crate::error::Error;
use crate::kernels::grid::Phases;
use crate::kernels::lanes::{BLOCK, LANES, Lanes, groups, groups_mut, padded};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::simd::{Simd, TINY};
use crate::kernels::tiles::Tiles;

/// An even drive, the points that it is even at, and the memory of both passes.
pub(crate) struct Task<'a> {
    pub(crate) tiles: Tiles<'a>,
    pub(crate) phases: &'a Phases,
    /// Square roots of the points' weights, padded with 0.
    pub(crate) roots: &'a [f32],
    /// Points with a target, which come first; the others are quiet.
    pub(crate) targeted: usize,
    /// [`floats`] numbers.
    pub(crate) memory: &'a mut [f32],
}

/// Numbers of memory for `points`.
pub(crate) const fn floats(points: usize) -> usize {
    LISTS * padded(points)
}

const LISTS: usize = 10;

/// Rotations in turns beyond which a pressure is no longer near its tangent.
const MOST_ROTATION: f32 = 0.125;

/// Lists over the points, each padded to whole lane groups.
struct Points<'a> {
    roots: &'a [f32],
    /// 1 for points with a target, 0 for quiet ones.
    loud: &'a [f32],
    /// 1 over the number of points with a target.
    share: f32,
    level: f32,
    field: [&'a mut [f32]; 2],
    /// sqrt(w) h.
    unit: [&'a mut [f32]; 2],
    /// sqrt(w) r.
    miss: &'a mut [f32],
    /// w r h.
    pull: [&'a mut [f32]; 2],
    /// What a tile's drives make at the points.
    change: [&'a mut [f32]; 2],
}

impl<'a> Points<'a> {
    fn new<S: Simd>(s: S, roots: &'a [f32], targeted: usize, field: [&[f32]; 2], memory: &'a mut [f32]) -> Self {
        let mut lists = memory.chunks_exact_mut(roots.len());
        let [loud, re, im, unit_re, unit_im, miss, pull_re, pull_im, change_re, change_im]: [&mut [f32]; LISTS] =
            core::array::from_fn(|_| lists.next().unwrap_or_default());
        for (list, field) in [&mut *re, &mut *im].into_iter().zip(field) {
            list.fill(0.0);
            list[..field.len()].copy_from_slice(field);
        }
        loud.fill(0.0);
        loud[..targeted].fill(1.0);
        let mut points = Self {
            roots,
            loud,
            share: 1.0 / targeted as f32,
            level: 0.0,
            field: [re, im],
            unit: [unit_re, unit_im],
            miss,
            pull: [pull_re, pull_im],
            change: [change_re, change_im],
        };
        // The first look finds the mean, the second what is missing from it.
        points.look(s);
        points.look(s);
        points
    }

    /// What is wrong with the field, at the last look's mean; then the mean.
    #[inline(always)]
    fn look<S: Simd>(&mut self, s: S) {
        let mut total = s.splat(0.0);
        let level = s.splat(self.level);
        for k in 0..groups(self.roots).len() {
            let at = |list: &[f32]| s.load(&groups(list)[k]);
            let (re, im, root, loud) = (at(self.field[0]), at(self.field[1]), at(self.roots), at(self.loud));
            let square = s.max(s.fma(re, re, s.mul(im, im)), s.splat(TINY));
            let inverse = s.rsqrt(square);
            let modulus = s.mul(square, inverse);
            total = s.fma(modulus, loud, total);
            let miss = s.mul(root, s.fnma(level, loud, modulus));
            let along = s.mul(root, inverse);
            let unit = [s.mul(along, re), s.mul(along, s.sub(s.splat(0.0), im))];
            s.store(miss, &mut groups_mut(self.miss)[k]);
            for (part, unit) in unit.into_iter().enumerate() {
                s.store(unit, &mut groups_mut(self.unit[part])[k]);
                s.store(s.mul(miss, unit), &mut groups_mut(self.pull[part])[k]);
            }
        }
        self.level = self.share * s.reduce_add(total);
    }

    /// sum w Re(h c)^2 over the points with a target and sum w |c|^2 over the quiet ones, of the changes c.
    #[inline(always)]
    fn weigh_change<S: Simd>(&self, s: S) -> f32 {
        let mut total = s.splat(0.0);
        for k in 0..groups(self.roots).len() {
            let at = |list: &[f32]| s.load(&groups(list)[k]);
            let (re, im, root) = (at(self.change[0]), at(self.change[1]), at(self.roots));
            let along = s.fnma(at(self.unit[1]), im, s.mul(at(self.unit[0]), re));
            let (re, im) = (s.mul(root, re), s.mul(root, im));
            let whole = s.fma(re, re, s.mul(im, im));
            total = s.add(total, s.select_less(s.splat(0.0), at(self.loud), s.mul(along, along), whole));
        }
        s.reduce_add(total)
    }

    /// Adds the change to the field.
    #[inline(always)]
    fn accept<S: Simd>(&mut self, s: S) {
        for (field, change) in self.field.iter_mut().zip(&self.change) {
            for (field, change) in groups_mut(field).iter_mut().zip(groups(change)) {
                s.store(s.add(s.load(field), s.load(change)), field);
            }
        }
        self.look(s);
    }

    /// The change that drives of a tile make.
    #[inline(always)]
    fn hear<S: Simd>(&mut self, s: S, tiles: Tiles<'_>, tile: usize, q: [S::V; 2]) {
        // Eight points' real and imaginary sums fill a register.
        let [re, im] = &mut self.change;
        let change = re.as_chunks_mut::<EIGHT>().0.iter_mut().zip(im.as_chunks_mut::<EIGHT>().0);
        let mut rows = tiles.column(tile);
        for (re, im) in change {
            let mut sums = [s.splat(0.0); LANES];
            for half in 0..EIGHT / BLOCK {
                let Some([gr, gi]) = rows.next() else { break };
                for row in 0..BLOCK {
                    let (gr, gi) = (s.load(&gr[row]), s.load(&gi[row]));
                    let k = half * BLOCK + row;
                    sums[k] = s.fnma(gi, q[1], s.mul(gr, q[0]));
                    sums[k + EIGHT] = s.fma(gr, q[1], s.mul(gi, q[0]));
                }
            }
            let mut lanes: Lanes = [0.0; LANES];
            s.store(s.reduce_add_each(&sums), &mut lanes);
            re.copy_from_slice(&lanes[..EIGHT]);
            im.copy_from_slice(&lanes[EIGHT..]);
        }
    }
}

/// Points whose complex sums fill a register.
const EIGHT: usize = LANES / 2;

/// Brings the drive (|q| = 1 or 0) to the phases, each tile's choice taking back the errors of those before; `field` is
/// that of the drive before. `codes` are those of the phases. Then exchanges codes in up to `rounds` passes, less if
/// nothing is gained.
///
/// # Errors
/// A stop, asked for once a tile: the drive is then part old and part new.
pub(crate) fn diffuse(
    set: InstructionSet,
    task: Task<'_>,
    rounds: usize,
    [qr, qi]: [&mut [f32]; 2],
    field: [&[f32]; 2],
    codes: &mut [f32],
    control: &mut Control,
) -> Result<(), Error> {
    dispatch!(set, s => {
        let Task { tiles, phases, roots, targeted, memory } = task;
        let mut points = Points::new(s, roots, targeted, field, memory);
        for tile in 0..tiles.lanes / LANES {
            control.pulse()?;
            let own = [&mut groups_mut(qr)[tile], &mut groups_mut(qi)[tile]];
            round_tile(s, tiles, tile, phases, &mut points, own, &mut groups_mut(codes)[tile]);
        }
        for _ in 0..rounds {
            let mut moved = false;
            for tile in 0..tiles.lanes / LANES {
                control.pulse()?;
                let own = [&mut groups_mut(qr)[tile], &mut groups_mut(qi)[tile]];
                moved |= exchange(s, tiles, tile, phases, &mut points, own, &mut groups_mut(codes)[tile]);
            }
            if !moved {
                break;
            }
        }
        Ok(())
    })
}

/// Rounds a tile where its errors do least harm.
#[inline(always)]
fn round_tile<S: Simd>(
    s: S,
    tiles: Tiles<'_>,
    tile: usize,
    phases: &Phases,
    points: &mut Points<'_>,
    [own_re, own_im]: [&mut Lanes; 2],
    codes: &mut Lanes,
) {
    let (zero, q) = (s.splat(0.0), [s.load(own_re), s.load(own_im)]);
    let mut sums = [zero; 4];
    let pulls = points.pull[0].as_chunks::<BLOCK>().0.iter().zip(points.pull[1].as_chunks::<BLOCK>().0);
    for ([gr, gi], (re, im)) in tiles.column(tile).zip(pulls) {
        for row in 0..BLOCK {
            let (gr, gi) = (s.load(&gr[row]), s.load(&gi[row]));
            let (re, im) = (s.splat(re[row]), s.splat(im[row]));
            sums = [s.fma(gr, re, sums[0]), s.fma(gi, im, sums[1]), s.fma(gr, im, sums[2]), s.fma(gi, re, sums[3])];
        }
    }
    let (re, im) = (s.sub(sums[0], sums[1]), s.add(sums[2], sums[3]));
    let down = s.fma(q[0], im, s.mul(q[1], re));
    points.hear(s, tiles, tile, [s.sub(zero, s.mul(q[1], down)), s.mul(q[0], down)]);
    let slope = s.reduce_add(s.mul(down, down));
    let far = slope / points.weigh_change(s).max(f32::MIN_POSITIVE) / core::f32::consts::TAU;
    let most = s.splat(MOST_ROTATION);
    let rotation = s.max(s.min(s.mul(down, s.splat(far)), most), s.sub(zero, most));
    let code = phases.codes(s, s.fma(rotation, s.splat(phases.count()), phases.places(s, q)));
    s.store(code, codes);
    let [re, im] = phases.phasors(s, code);
    // Transducers without effect stay silent.
    let power = s.fma(q[0], q[0], s.mul(q[1], q[1]));
    let half = s.splat(0.5);
    let new = [s.select_less(power, half, zero, re), s.select_less(power, half, zero, im)];
    s.store(new[0], own_re);
    s.store(new[1], own_im);
    points.hear(s, tiles, tile, [s.sub(new[0], q[0]), s.sub(new[1], q[1])]);
    points.accept(s);
}

/// Takes the step of one code that gains most; whether one does.
#[inline(always)]
fn exchange<S: Simd>(
    s: S,
    tiles: Tiles<'_>,
    tile: usize,
    phases: &Phases,
    points: &mut Points<'_>,
    [own_re, own_im]: [&mut Lanes; 2],
    codes: &mut Lanes,
) -> bool {
    let (zero, q) = (s.splat(0.0), [s.load(own_re), s.load(own_im)]);
    // A step up or down makes u (c +- j s) of a wave u = h G q.
    let [c, sine] = phases.step();
    let (cosine, sine) = (s.splat(c), s.splat(sine));
    let along = [s.mul(q[0], cosine), s.mul(q[1], cosine)];
    let across = [s.mul(q[0], sine), s.mul(q[1], sine)];
    let square = s.splat(-2.0 * c);
    // What either step costs, and what the step up costs less than the one down.
    let (mut both, mut odd) = (zero, zero);
    for (block, [gr, gi]) in tiles.column(tile).enumerate() {
        for row in 0..BLOCK {
            let k = block * BLOCK + row;
            let (gr, gi) = (s.load(&gr[row]), s.load(&gi[row]));
            let (hr, hi, miss) = (s.splat(points.unit[0][k]), s.splat(points.unit[1][k]), s.splat(points.miss[k]));
            let (tr, ti) = (s.fnma(gi, hi, s.mul(gr, hr)), s.fma(gi, hr, s.mul(gr, hi)));
            let even = s.fnma(ti, along[1], s.mul(tr, along[0]));
            let side = s.fma(tr, across[1], s.mul(ti, across[0]));
            let near = s.add(miss, even);
            if points.loud[k] > 0.0 {
                both = s.fma(side, side, s.fma(even, s.add(miss, near), both));
                odd = s.fma(side, near, odd);
            } else {
                let whole = s.mul(square, s.fma(tr, tr, s.mul(ti, ti)));
                both = s.add(s.fma(s.add(miss, miss), even, both), whole);
                odd = s.fma(side, miss, odd);
            }
        }
    }
    let change = s.fnma(s.splat(2.0), s.abs(odd), both);
    let least = s.reduce_min(change);
    if s.less(least, zero) == 0 {
        return false;
    }
    let lane = s.less(least, change).trailing_ones() as usize % LANES;
    let mut steps: Lanes = [0.0; LANES];
    s.store(odd, &mut steps);
    let [re, im] = phases.stepped(&mut codes[lane], steps[lane] > 0.0);
    let [dr, di] = [re - own_re[lane], im - own_im[lane]];
    (own_re[lane], own_im[lane]) = (re, im);
    let [field_re, field_im] = &mut points.field;
    let field = field_re.as_chunks_mut::<BLOCK>().0.iter_mut().zip(field_im.as_chunks_mut::<BLOCK>().0);
    for ([gr, gi], (re, im)) in tiles.column(tile).zip(field) {
        for row in 0..BLOCK {
            let (gr, gi) = (gr[row][lane], gi[row][lane]);
            re[row] += gr * dr - gi * di;
            im[row] += gr * di + gi * dr;
        }
    }
    points.look(s);
    true
}
