//! The exact search of the greedy method: which candidate drive lowers the energy most.
//!
//! PointGroup candidates lie in the lanes and the points pass by one after another, so nothing is padded in the
//! points and no sum runs across lanes.

use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::lanes::{LANES, Lanes, groups};
use crate::kernels::simd::{Simd, TINY};
use crate::math::{cos, sin};
use alloc::vec::Vec;

/// A point's term of the energy, by how it changes with |P|.
pub(crate) trait Term {
    /// Whether it is (t - |P|)^2, whose moments are known.
    const SQUARE: bool;
    /// The change of the term when |P| rises by `rise`, `gap` = target - |P| before.
    fn change<S: Simd>(s: S, rise: S::V, gap: S::V) -> S::V;
    /// A bound on it for a drive of modulus 1: `gain` bounds |G|, and so |rise|.
    fn bound<S: Simd>(s: S, gain: S::V, gap: S::V) -> S::V;
}

/// (t - |P|)^2, the paper's eq. (7).
pub(crate) struct L2;

/// |t - |P||, which the authors' code minimises.
pub(crate) struct L1;

impl Term for L2 {
    const SQUARE: bool = true;

    #[inline(always)]
    fn change<S: Simd>(s: S, rise: S::V, gap: S::V) -> S::V {
        s.mul(rise, s.sub(rise, s.add(gap, gap)))
    }

    #[inline(always)]
    fn bound<S: Simd>(s: S, gain: S::V, gap: S::V) -> S::V {
        let gap = s.abs(gap);
        s.mul(gain, s.add(gain, s.add(gap, gap)))
    }
}

impl Term for L1 {
    const SQUARE: bool = false;

    #[inline(always)]
    fn change<S: Simd>(s: S, rise: S::V, gap: S::V) -> S::V {
        s.sub(s.abs(s.sub(gap, rise)), s.abs(gap))
    }

    #[inline(always)]
    fn bound<S: Simd>(_: S, gain: S::V, _gap: S::V) -> S::V {
        gain
    }
}

/// The points as the search sees them: their pressures and what is asked for, and this transducer's propagation.
#[derive(Clone, Copy)]
pub(crate) struct Points<'a> {
    pub(crate) groups: &'a [PointGroup],
    pub(crate) gain: [&'a [f32]; 2],
    /// How many of them are points; the rest is padding.
    pub(crate) count: usize,
}

/// Squares of smaller numbers vanish in f32; added to |P| + |P + e| it keeps 0/0 away.
const SMALLEST: f32 = 1e-20;

/// Length of a table of phases: any 16 of them can be read, from any phase on.
pub(crate) const fn table(phases: usize) -> usize {
    phases + LANES
}

/// Candidate drives a e^{j phi}: amplitudes outer, phases inner.
pub(crate) struct Candidates {
    /// cos and sin of the phases, and the first ones again up to [`table`]: a copy never wins against its original.
    cos: Vec<f32>,
    sin: Vec<f32>,
    /// The same of the even and of the odd thirty-seconds of a turn.
    coarse: [[Lanes; 2]; 2],
    /// The amplitudes.
    levels: Vec<f32>,
    pub(crate) phases: usize,
    pub(crate) amplitudes: usize,
}

impl Candidates {
    /// K = `amplitudes` times L = `phases` candidates: a = (k+1)/K outer, phi = 2 pi l/L inner.
    #[cfg(test)]
    pub(crate) fn new(phases: usize, amplitudes: usize, buffers: [Vec<f32>; 3]) -> Self {
        Self::grid(phases, (0..amplitudes).map(|k| (k as f64 + 1.0) / amplitudes as f64), buffers)
    }

    /// L = `phases` phases 2 pi l/L at each of some amplitudes, in buffers whose length is set here.
    pub(crate) fn grid(phases: usize, amplitudes: impl Iterator<Item = f64>, buffers: [Vec<f32>; 3]) -> Self {
        Self::made(phases, |l| l as f64 / phases as f64, amplitudes, buffers)
    }

    /// Rotations by up to `width` steps of 1/`phases`, at full amplitude: 0 first, then 1, -1, 2, -2 and so on.
    pub(crate) fn rotations(phases: usize, width: usize, buffers: [Vec<f32>; 3]) -> Self {
        let rotation = |k: usize| {
            let step = k.div_ceil(2) as f64 * if k % 2 == 1 { 1.0 } else { -1.0 };
            step / phases as f64
        };
        Self::made(width.min(phases), rotation, core::iter::once(1.0), buffers)
    }

    fn made(
        phases: usize,
        turns_of: impl Fn(usize) -> f64,
        amplitudes: impl Iterator<Item = f64>,
        buffers: [Vec<f32>; 3],
    ) -> Self {
        let [mut cosines, mut sines, mut levels] = buffers;
        levels.clear();
        levels.extend(amplitudes.map(|amplitude| amplitude as f32));
        for (buffer, part) in [(&mut cosines, cos as fn(f64) -> f64), (&mut sines, sin)] {
            buffer.clear();
            buffer.extend((0..table(phases)).map(|l| {
                let angle = core::f64::consts::TAU * turns_of(l % phases);
                part(angle) as f32
            }));
        }
        let amplitudes = levels.len();
        let every = |odd: usize| {
            [&cosines, &sines].map(|part| core::array::from_fn(|c| part[(2 * c + odd) * phases / (2 * LANES)]))
        };
        let coarse = [every(0), every(1)];
        Self { cos: cosines, sin: sines, coarse, levels, phases, amplitudes }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.phases * self.amplitudes
    }

    /// Amplitude k.
    #[inline(always)]
    pub(crate) fn amplitude(&self, k: usize) -> f32 {
        self.levels[k]
    }

    /// The drive (re, im) of candidate k L + l.
    #[inline(always)]
    pub(crate) fn drive(&self, index: usize) -> [f32; 2] {
        // Most grids have one amplitude, and a division takes as long as evaluating it.
        let k = if index < self.phases { 0 } else { index / self.phases };
        let (amplitude, l) = (self.amplitude(k), index - k * self.phases);
        [amplitude * self.cos[l], amplitude * self.sin[l]]
    }

    /// cos and sin of phase l.
    #[inline(always)]
    pub(crate) fn phasor(&self, l: usize) -> [f32; 2] {
        [self.cos[l], self.sin[l]]
    }

    /// cos and sin of 16 phases from l on.
    #[inline(always)]
    pub(crate) fn sixteen(&self, l: usize) -> [&Lanes; 2] {
        [&self.cos, &self.sin].map(|part| part[l..].first_chunk().unwrap_or(&[0.0; LANES]))
    }

    /// The drives of 16 phases from l on at amplitude a.
    #[inline(always)]
    pub(crate) fn drives<S: Simd>(&self, s: S, a: f32, l: usize) -> [S::V; 2] {
        scaled(s, a, self.sixteen(l))
    }

    /// The phase where the arc of some thirty-second of a turn begins.
    #[inline(always)]
    pub(crate) fn start(&self, arc: usize) -> usize {
        arc * self.phases / (2 * LANES)
    }

    /// cos and sin there, at the even and at the odd ones.
    #[inline(always)]
    pub(crate) fn coarse(&self) -> [[&Lanes; 2]; 2] {
        [self.coarse[0].each_ref(), self.coarse[1].each_ref()]
    }

    /// Gives the buffers back.
    pub(crate) fn into_buffers(self) -> [Vec<f32>; 3] {
        [self.cos, self.sin, self.levels]
    }
}

/// 16 drives of amplitude a.
#[inline(always)]
pub(crate) fn scaled<S: Simd>(s: S, a: f32, [cos, sin]: [&Lanes; 2]) -> [S::V; 2] {
    [s.mul(s.splat(a), s.load(cos)), s.mul(s.splat(a), s.load(sin))]
}

/// Below this difference two energies are equal. 0 if the transducer cannot change any term.
#[inline(always)]
pub(crate) fn tolerance<S: Simd, T: Term>(s: S, points: Points<'_>) -> f32 {
    EQUAL * s.reduce_max(largest::<S, T>(s, points))
}

/// Of the largest term summed, the part below which two energies are equal: the rounding of f32.
pub(crate) const EQUAL: f32 = 1e-7;

/// A bound on the largest term summed, lanes apart.
#[inline(always)]
pub(crate) fn largest<S: Simd, T: Term>(s: S, points: Points<'_>) -> S::V {
    let propagation = groups(points.gain[0]).iter().zip(groups(points.gain[1]));
    let mut most = s.splat(0.0);
    for ((re, im), group) in propagation.zip(points.groups) {
        let gain = s.add(s.abs(s.load(re)), s.abs(s.load(im)));
        let gap = s.sub(s.load(&group.target), s.load(&group.modulus));
        most = s.max(most, s.mul(s.load(&group.weight), T::bound(s, gain, gap)));
    }
    most
}

/// Adds the change of some points' terms under the candidates (re, im) to `total`.
#[inline(always)]
pub(crate) fn add_changes<S: Simd, T: Term>(
    s: S,
    points: Points<'_>,
    some: impl Iterator<Item = usize>,
    [re, im]: [S::V; 2],
    mut total: S::V,
) -> S::V {
    for j in some {
        let (gr, gi) = (s.splat(points.gain[0][j]), s.splat(points.gain[1][j]));
        let (group, lane) = (&points.groups[j / LANES], j % LANES);
        let old = [s.splat(group.re[lane]), s.splat(group.im[lane]), s.splat(group.modulus[lane])];
        let e = [s.fnma(gi, im, s.mul(gr, re)), s.fma(gi, re, s.mul(gr, im))];
        let gap = s.splat(group.target[lane] - group.modulus[lane]);
        total = s.fma(s.splat(group.weight[lane]), T::change(s, rise(s, old, e), gap), total);
    }
    total
}

/// |P + e| - |P|, from P (re, im, modulus) and e.
#[inline(always)]
pub(crate) fn rise<S: Simd>(s: S, [pr, pi, old]: [S::V; 3], [er, ei]: [S::V; 2]) -> S::V {
    let (x, y) = (s.add(pr, er), s.add(pi, ei));
    // |P + e|^2 - |P|^2 without the cancellation of its two large parts.
    let square = s.fma(er, s.add(pr, x), s.mul(ei, s.add(pi, y)));
    let new = s.sqrt_rsqrt(s.max(s.fma(x, x, s.mul(y, y)), s.splat(TINY))).0;
    s.mul(square, reciprocal(s, s.add(new, s.add(old, s.splat(SMALLEST)))))
}

/// 1/a of normal a > 0, by the inverse root and one step of Newton.
#[inline(always)]
fn reciprocal<S: Simd>(s: S, a: S::V) -> S::V {
    let guess = s.rsqrt_estimate(a);
    let guess = s.mul(guess, guess);
    s.fma(guess, s.fnma(a, guess, s.splat(1.0)), guess)
}

/// The best candidate so far.
#[derive(Clone, Copy)]
pub(crate) struct Winner {
    pub(crate) index: usize,
    change: f32,
}

impl Winner {
    /// Before any candidate is known.
    pub(crate) const NONE: Self = Self { index: 0, change: f32::INFINITY };

    /// This or the best of 16 further candidates: the first one that no other beats by more than `tolerance`.
    #[inline(always)]
    pub(crate) fn or<S: Simd>(self, s: S, changes: S::V, index: impl Fn(usize) -> usize, tolerance: f32) -> Self {
        let least = -s.reduce_max(s.sub(s.splat(0.0), changes));
        // Not "at most": an infinite change stands against the first.
        if self.change - least <= tolerance {
            return self;
        }
        let beyond = s.less(s.splat(least + tolerance), changes);
        let lane = (!beyond & 0xffff).trailing_zeros().min(15) as usize;
        let mut lanes: Lanes = [0.0; LANES];
        s.store(changes, &mut lanes);
        Self { index: index(lane), change: lanes[lane] }
    }
}

/// The first of all candidates that no other one beats by more than `tolerance`; with `silent` the amplitudes
/// alone are searched (phase 0).
#[inline(always)]
pub(crate) fn best<S: Simd, T: Term>(
    s: S,
    points: Points<'_>,
    candidates: &Candidates,
    silent: bool,
    tolerance: f32,
) -> usize {
    let (phases, amplitudes) = (candidates.phases, candidates.amplitudes);
    let mut winner = Winner::NONE;
    let zero = s.splat(0.0);
    if silent {
        for first in (0..amplitudes).step_by(LANES) {
            let at = |lane: usize| (first + lane).min(amplitudes - 1);
            let re = s.load(&core::array::from_fn(|lane| candidates.amplitude(at(lane))));
            let changes = add_changes::<S, T>(s, points, 0..points.count, [re, zero], zero);
            winner = winner.or(s, changes, |lane| at(lane) * phases, tolerance);
        }
        return winner.index;
    }
    for k in 0..amplitudes {
        for first in (0..phases).step_by(LANES) {
            let drives = candidates.drives(s, candidates.amplitude(k), first);
            let changes = add_changes::<S, T>(s, points, 0..points.count, drives, zero);
            winner = winner.or(s, changes, |lane| k * phases + first + lane, tolerance);
        }
    }
    winner.index
}

/// As [`best`], among candidates given by their index in rising order: here the points lie in the lanes.
#[inline(always)]
pub(crate) fn best_of<S: Simd>(
    s: S,
    points: Points<'_>,
    candidates: &Candidates,
    some: &[u32],
    tolerance: f32,
) -> usize {
    let mut winner = Winner::NONE;
    for chunk in some.chunks(LANES) {
        let mut changes = [s.splat(0.0); LANES];
        for (&index, change) in chunk.iter().zip(&mut changes) {
            let [re, im] = candidates.drive(index as usize);
            let q = [s.splat(re), s.splat(im)];
            let propagation = groups(points.gain[0]).iter().zip(groups(points.gain[1]));
            for (group, (re, im)) in points.groups.iter().zip(propagation) {
                *change = group.add_change(s, [re, im], q, *change);
            }
        }
        let mut lanes = [f32::INFINITY; LANES];
        s.store(s.reduce_add_each(&changes), &mut lanes);
        lanes[chunk.len()..].fill(f32::INFINITY);
        let at = |lane: usize| chunk[lane.min(chunk.len() - 1)] as usize;
        winner = winner.or(s, s.load(&lanes), at, tolerance);
    }
    winner.index
}
