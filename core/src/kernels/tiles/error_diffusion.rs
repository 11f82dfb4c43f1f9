//! Error diffusion: rounds an even drive to a board's phases, tiles after tiles, so that errors at the points cancel.
//!
//! ```text
//! r_j = |P_j| - s          error of point j, s the mean; |P_j| itself at a quiet point;   h_j = conj(P_j)/|P_j|
//! diffuse, for each 4 tiles of 16 transducers:
//!     d   = Im(q sum_j G_j w_j r_j h_j)                        steepest descent of sum w r^2 over their phases
//!     k   = sum d^2 / sum_j w_j Re(h_j sum_i G_ij q_i d_i j)^2                   step of the line search along d
//!     q'  = the board's phase nearest to arg q + k d;   P += sum_i G_i (q'_i - q_i)
//! exchange, for each tile:
//!     change the one code whose step up or down lowers sum w r^2 most, if there is one
//! ```
//!
//! In motion a drive keeps its last code while the exact one is within 3/4 of a step: each change of code is audible.
//!
//! Rounding leaves errors at the points. The next tiles choose their codes so that these become smaller (Floyd and
//! Steinberg, Proc. SID 17(2), 1976). Exchanges of single codes (direct binary search, Analoui and Allebach, SPIE 1666,
//! 1992) remove two thirds of what the last tiles leave. The time is O(N M): a pass takes as long as three or four
//! sweeps.
//!
//! 1. At few points each choice waits for the field of the one before. Four tiles at a time wait a quarter as often,
//!    and exchanges leave no more error than with one.
//! 2. The level s is the mean before the last choice, so that no choice waits for it.
//! 3. sum d^2, which is minus the slope along d, needs no field: it is summed while the field of d is computed.

use crate::kernels::grid::{Few, Phases};
use crate::kernels::prelude::*;
use crate::kernels::tiles::{Tiles, add_wave};

/// The rule by which a drive gets the code (index) of a phase.
#[derive(Clone, Copy)]
pub(crate) struct Choice<'a> {
    phases: &'a Phases,
    few: Option<Few>,
    /// The largest code of a phase, in either direction from code 0.
    most: f32,
    /// Distance from code 0, in steps, within which a drive gets code 0; 1/2 means the nearest code.
    zone: f32,
    /// The largest rotation of a drive, in turns, by which it corrects errors at the points.
    rotation: f32,
    /// Root mean square of the error, relative to the level, below which codes are not exchanged.
    even: f32,
}

impl<'a> Choice<'a> {
    /// The rule for the least error that the phases allow, with codes up to `most`.
    pub(crate) fn even(phases: &'a Phases, most: f32) -> Self {
        Self { phases, most, zone: 0.5, rotation: MOST_ROTATION, even: EVEN[0], few: None }
    }

    /// The rule for motion, where code 0 is the last frame's code: few codes change, because each change is audible.
    pub(crate) fn in_motion(phases: &'a Phases, most: f32) -> Self {
        let step = 1.0 / phases.count();
        let even = (step * step).clamp(EVEN[0], EVEN[1]);
        Self { zone: 0.75, rotation: 0.25 * step, even, few: phases.few(most), ..Self::even(phases, most) }
    }
}

/// The tiles, points and weights of an even drive, and the working memory.
pub(crate) struct Task<'a> {
    pub(crate) tiles: Tiles<'a>,
    pub(crate) choice: Choice<'a>,
    pub(crate) weights: &'a [f32],
    /// Number of points with a target, which come first; the others are quiet.
    pub(crate) targeted: usize,
    /// Working memory of [`floats`] numbers.
    pub(crate) memory: &'a mut [f32],
}

/// Returns the length of the working memory for `points`.
pub(crate) const fn floats(points: usize) -> usize {
    LISTS * 2 * points.next_multiple_of(EIGHT)
}

const LISTS: usize = 7;
/// Number of points whose complex sums fill a lane group.
const EIGHT: usize = LANES / 2;
/// Number of tiles that are rounded together: the loop waits once for their choice.
const MOST: usize = 4;
/// Largest rotation in turns for which a pressure is near its tangent.
const MOST_ROTATION: f32 = 0.125;
/// The least and the largest value of [`Choice::even`].
const EVEN: [f32; 2] = [5e-5, 1e-3];

/// Largest number of passes that exchange codes: a third pass removes less than a tenth of the error.
const ROUNDS: usize = 2;

/// Lists over the points. A lane group has eight of them: real, then imaginary parts, or the same number twice.
struct Points<'a> {
    /// sqrt(w), w the weight; 0 in the padding.
    root: &'a mut [Lanes],
    /// 1 for points with a target, 0 for quiet ones.
    loud: &'a mut [Lanes],
    field: &'a mut [Lanes],
    /// sqrt(w) h, see the module's head.
    unit: &'a mut [Lanes],
    /// sqrt(w) r with the error r of the module's head.
    miss: &'a mut [Lanes],
    /// w r h, see the module's head.
    pull: &'a mut [Lanes],
    /// The pressures that a tile's drives add at the points.
    change: &'a mut [Lanes],
    /// 1 over twice the number of points with a target: each is in a lane group twice.
    share: f32,
    level: f32,
}

impl<'a> Points<'a> {
    #[inline(always)]
    fn new<S: Simd>(s: S, weights: &[f32], targeted: usize, field: [&[f32]; 2], memory: &'a mut [f32]) -> Self {
        memory.fill(0.0);
        let mut lists = groups_mut(memory).chunks_exact_mut(weights.len().div_ceil(EIGHT));
        let [root, loud, pressures, unit, miss, pull, change]: [&mut [Lanes]; LISTS] =
            core::array::from_fn(|_| lists.next().unwrap_or_default());
        for (k, (weight, (re, im))) in weights.iter().zip(field[0].iter().zip(field[1])).enumerate() {
            let (group, lane) = (k / EIGHT, k % EIGHT);
            (pressures[group][lane], pressures[group][lane + EIGHT]) = (*re, *im);
            for half in [lane, lane + EIGHT] {
                root[group][half] = sqrtf(*weight);
                loud[group][half] = if k < targeted { 1.0 } else { 0.0 };
            }
        }
        let share = 0.5 / targeted as f32;
        let mut points = Self { root, loud, field: pressures, unit, miss, pull, change, share, level: 0.0 };
        // The first call computes the mean, the second the errors.
        points.look(s);
        points.look(s);
        points
    }

    /// Updates the errors r relative to the last mean, and then the mean. Returns sum w r^2.
    #[inline(always)]
    fn look<S: Simd>(&mut self, s: S) -> S::V {
        s.aside(
            #[inline(always)]
            || {
                let (mut total, mut wrong) = (s.splat(0.0), s.splat(0.0));
                // Signs of the complex conjugate.
                let mut signs: Lanes = [1.0; LANES];
                signs[EIGHT..].fill(-1.0);
                let signs = s.load(&signs);
                let requested = self.root.iter().zip(&*self.loud).zip(&*self.field);
                let outputs = self.unit.iter_mut().zip(&mut *self.miss).zip(&mut *self.pull);
                for (((root, loud), field), ((unit, miss), pull)) in requested.zip(outputs) {
                    let (root, loud, field) = (s.load(root), s.load(loud), s.load(field));
                    let part = s.mul(field, field);
                    let square = s.max(s.add(part, s.swap::<8>(part)), s.splat(TINY));
                    let inverse = s.rsqrt(square);
                    let modulus = s.mul(square, inverse);
                    total = s.fma(modulus, loud, total);
                    let off = s.mul(root, s.fnma(s.splat(self.level), loud, modulus));
                    wrong = s.fma(off, off, wrong);
                    let along = s.mul(s.mul(signs, field), s.mul(root, inverse));
                    s.store(off, miss);
                    s.store(along, unit);
                    s.store(s.mul(off, along), pull);
                }
                self.level = self.share * s.reduce_add(total);
                wrong
            },
        )
    }

    /// Returns for changes c of the pressures twice sum w Re(h c)^2 (points with a target) + sum w |c|^2 (quiet
    /// points).
    #[inline(always)]
    fn weigh_change<S: Simd>(&self, s: S) -> f32 {
        s.aside(
            #[inline(always)]
            || {
                let mut total = s.splat(0.0);
                let lists = self.root.iter().zip(&*self.loud).zip(self.unit.iter().zip(&*self.change));
                for ((root, loud), (unit, change)) in lists {
                    let change = s.load(change);
                    let along = s.mul(s.load(unit), change);
                    let along = s.sub(along, s.swap::<8>(along));
                    let whole = s.mul(s.load(root), change);
                    let whole = s.mul(s.splat(2.0), s.mul(whole, whole));
                    total = s.add(total, s.select_less(s.splat(0.0), s.load(loud), s.mul(along, along), whole));
                }
                s.reduce_add(total)
            },
        )
    }

    /// Computes the change of the pressures by drives of K tiles.
    #[inline(always)]
    fn hear<S: Simd, const K: usize>(&mut self, s: S, tiles: Tiles<'_>, tile: usize, q: &[[S::V; 2]; K]) {
        s.aside(
            #[inline(always)]
            || {
                let mut rows = tiles.columns::<K>(tile);
                for change in &mut *self.change {
                    let mut sums = [s.splat(0.0); LANES];
                    for half in 0..EIGHT / BLOCK {
                        let Some([gr, gi]) = rows.next() else { break };
                        for row in 0..BLOCK {
                            let k = half * BLOCK + row;
                            for (tile, &q) in q.iter().enumerate() {
                                let g = [s.load(&gr[tile][row]), s.load(&gi[tile][row])];
                                [sums[k], sums[k + EIGHT]] = add_wave(s, g, q, [sums[k], sums[k + EIGHT]]);
                            }
                        }
                    }
                    s.store(s.reduce_add_each(&sums), change);
                }
            },
        );
    }
}

/// Rounds a drive (|q| = 1 or 0) to the phases; each tile's choice corrects the errors of the tiles before. `field` is
/// that of the old drive. Writes the new `codes`. Then exchanges codes as long as that lowers the error.
///
/// # Errors
/// A requested stop, which is checked once a tile: the drive is then part old and part new.
pub(crate) fn diffuse(
    set: InstructionSet,
    task: Task<'_>,
    [qr, qi]: [&mut [f32]; 2],
    field: [&[f32]; 2],
    codes: &mut [f32],
    control: &mut Control,
) -> Result<()> {
    dispatch!(set, s => {
        let Task { tiles, choice, weights, targeted, memory } = task;
        let mut points = Points::new(s, weights, targeted, field, memory);
        let (qr, qi, codes) = (groups_mut(qr), groups_mut(qi), groups_mut(codes));
        let (mut re, mut im, mut chunks) = (qr.chunks_mut(MOST), qi.chunks_mut(MOST), codes.chunks_mut(MOST));
        let mut tile = 0;
        while let (Some(re), Some(im), Some(codes)) = (re.next(), im.next(), chunks.next()) {
            control.pulse()?;
            // The number of tiles is even.
            match codes.len() {
                MOST => round_tiles::<_, MOST>(s, tiles, tile, choice, &mut points, [re, im], codes),
                _ => round_tiles::<_, 2>(s, tiles, tile, choice, &mut points, [re, im], codes),
            }
            tile += MOST;
        }
        for _ in 0..ROUNDS {
            let off = s.reduce_add(points.look(s)) * points.share;
            if off <= choice.even * choice.even * points.level * points.level {
                break;
            }
            let mut moved = false;
            for tile in 0..tiles.lanes / LANES {
                control.pulse()?;
                let q = [&mut qr[tile], &mut qi[tile]];
                moved |= exchange(s, tiles, tile, choice, &mut points, q, &mut codes[tile]);
            }
            if !moved {
                break;
            }
        }
        Ok(())
    })
}

/// Rounds K tiles so that their rounding errors reduce the errors at the points.
#[inline(always)]
fn round_tiles<S: Simd, const K: usize>(
    s: S,
    tiles: Tiles<'_>,
    tile: usize,
    choice: Choice<'_>,
    points: &mut Points<'_>,
    [own_re, own_im]: [&mut [Lanes]; 2],
    codes: &mut [Lanes],
) {
    let zero = s.splat(0.0);
    let mut q = [[zero; 2]; K];
    for (q, (re, im)) in q.iter_mut().zip(own_re.iter().zip(&*own_im)) {
        *q = [s.load(re), s.load(im)];
    }
    let mut sums = [[zero; 4]; K];
    for (block, [gr, gi]) in tiles.columns::<K>(tile).enumerate() {
        let pull = &points.pull[block / 2];
        for row in 0..BLOCK {
            let k = block % 2 * BLOCK + row;
            let (re, im) = (s.splat(pull[k]), s.splat(pull[k + EIGHT]));
            for (sums, (gr, gi)) in sums.iter_mut().zip(gr.iter().zip(gi)) {
                let (gr, gi) = (s.load(&gr[row]), s.load(&gi[row]));
                *sums =
                    [s.fma(gr, re, sums[0]), s.fma(gi, im, sums[1]), s.fma(gr, im, sums[2]), s.fma(gi, re, sums[3])];
            }
        }
    }
    // For each drive: the steepest descent d of the module's head, and the drive's change along d; then sum d^2.
    let (mut down, mut change, mut slope) = ([zero; K], [[zero; 2]; K], zero);
    for ((down, change), (&[re, im], &[a, b, c, d])) in down.iter_mut().zip(&mut change).zip(q.iter().zip(&sums)) {
        *down = s.fma(re, s.add(c, d), s.mul(im, s.sub(a, b)));
        *change = [s.mul(s.sub(zero, im), *down), s.mul(re, *down)];
        slope = s.fma(*down, *down, slope);
    }
    points.hear(s, tiles, tile, &change);
    let slope = 2.0 / core::f32::consts::TAU * s.reduce_add(slope);
    let far = s.splat(slope / points.weigh_change(s).max(f32::MIN_POSITIVE));
    let most = s.splat(choice.rotation);
    let lists = own_re.iter_mut().zip(own_im).zip(codes);
    for (((re, im), codes), (&q, (&down, change))) in lists.zip(q.iter().zip(down.iter().zip(&mut change))) {
        let rotation = s.max(s.min(s.mul(down, far), most), s.sub(zero, most));
        let (code, new) = rounded(s, choice, q, rotation);
        s.store(code, codes);
        s.store(new[0], re);
        s.store(new[1], im);
        *change = [s.sub(new[0], q[0]), s.sub(new[1], q[1])];
    }
    points.hear(s, tiles, tile, &change);
    for (field, change) in points.field.iter_mut().zip(&*points.change) {
        s.store(s.add(s.load(field), s.load(change)), field);
    }
    points.look(s);
}

/// Returns the codes nearest to q after rotations in turns, and their phasors.
#[inline(always)]
fn rounded<S: Simd>(s: S, choice: Choice<'_>, q: [S::V; 2], rotation: S::V) -> (S::V, [S::V; 2]) {
    s.aside(
        #[inline(always)]
        || {
            let Choice { phases, most, zone, few, .. } = choice;
            let later = s.fma(rotation, s.splat(phases.count()), phases.later(s, q));
            let code = s.select_less(s.abs(s.sub(later, s.splat(0.5))), s.splat(zone), s.splat(0.0), s.floor(later));
            let code = s.max(s.min(code, s.splat(most)), s.splat(-most));
            // Transducers without effect keep the drive 0.
            let Some(few) = &few else { return (code, phases.phasors(s, code, q)) };
            (code, few.phasors(s, code, q))
        },
    )
}

/// Makes the step of one code that lowers the error most; returns false if no step lowers it.
#[inline(always)]
fn exchange<S: Simd>(
    s: S,
    tiles: Tiles<'_>,
    tile: usize,
    Choice { phases, most: most_code, .. }: Choice<'_>,
    points: &mut Points<'_>,
    [own_re, own_im]: [&mut Lanes; 2],
    codes: &mut Lanes,
) -> bool {
    let (zero, q) = (s.splat(0.0), [s.load(own_re), s.load(own_im)]);
    // A step up or down adds u (c +- j s) to the pressure, for a wave u = h G q.
    let [c, sine] = phases.step();
    let (cosine, sine) = (s.splat(c), s.splat(sine));
    let along = [s.mul(q[0], cosine), s.mul(q[1], cosine)];
    let across = [s.mul(q[0], sine), s.mul(q[1], sine)];
    let square = s.splat(-2.0 * c);
    // A step up changes the error by `both` - 2 `odd`, a step down by `both` + 2 `odd`.
    let (mut both, mut odd) = (zero, zero);
    for (block, [[gr], [gi]]) in tiles.columns(tile).enumerate() {
        let [unit, miss, loud] = [&points.unit, &points.miss, &points.loud].map(|list| &list[block / 2]);
        for row in 0..BLOCK {
            let k = block % 2 * BLOCK + row;
            let (gr, gi) = (s.load(&gr[row]), s.load(&gi[row]));
            let (hr, hi, miss) = (s.splat(unit[k]), s.splat(unit[k + EIGHT]), s.splat(miss[k]));
            let (tr, ti) = (s.fnma(gi, hi, s.mul(gr, hr)), s.fma(gi, hr, s.mul(gr, hi)));
            let even = s.fnma(ti, along[1], s.mul(tr, along[0]));
            let side = s.fma(tr, across[1], s.mul(ti, across[0]));
            let near = s.add(miss, even);
            if loud[k] > 0.0 {
                both = s.fma(side, side, s.fma(even, s.add(miss, near), both));
                odd = s.fma(side, near, odd);
            } else {
                let whole = s.mul(square, s.fma(tr, tr, s.mul(ti, ti)));
                both = s.add(s.fma(s.add(miss, miss), even, both), whole);
                odd = s.fma(side, miss, odd);
            }
        }
    }
    // A code beyond the largest one is not allowed.
    let after = s.add(s.load(codes), s.select_less(s.splat(0.0), odd, s.splat(1.0), s.splat(-1.0)));
    let change = s.fnma(s.splat(2.0), s.abs(odd), both);
    let change = s.select_less(s.splat(most_code), s.abs(after), s.splat(f32::MAX), change);
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
    for (block, [[gr], [gi]]) in tiles.columns(tile).enumerate() {
        let field = &mut points.field[block / 2];
        for row in 0..BLOCK {
            let (gr, gi, k) = (gr[row][lane], gi[row][lane], block % 2 * BLOCK + row);
            field[k] += gr * dr - gi * di;
            field[k + EIGHT] += gr * di + gi * dr;
        }
    }
    points.look(s);
    true
}
