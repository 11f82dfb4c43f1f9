//! Candidate drives: K amplitudes times L phases, as tables of cosines and sines; the terms of the energy by which they differ.

use crate::kernels::prelude::*;
use crate::math::{cos, sin};

/// Returns the length of a table of phases, from which 16 can be read from any phase on.
pub(crate) const fn table(phases: usize) -> usize {
    phases + LANES
}

/// A range of phases of a grid around one phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PhaseRange {
    /// Index of the phase that is searched first.
    pub(crate) from: usize,
    /// Number of phases of the range after `from`.
    pub(crate) above: usize,
    /// Number of phases of the range before `from`; no phase is counted twice.
    pub(crate) below: usize,
}

impl PhaseRange {
    /// Returns the range of all `phases`.
    #[inline(always)]
    pub(crate) fn whole(phases: usize) -> Self {
        Self { from: 0, above: phases - 1, below: 0 }
    }
}

/// Candidate drives a e^{j phi}, ordered by amplitude, then by phase.
pub(crate) struct Candidates {
    /// cos and sin of the phases, then of the first phases again, up to [`table`] entries. A repeated phase never
    /// replaces its first entry as the best.
    cos: Vec<f32>,
    sin: Vec<f32>,
    /// cos and sin at the even and at the odd multiples of 1/32 of a turn.
    coarse: [[Lanes; 2]; 2],
    amplitude_table: Vec<f32>,
    pub(crate) phases: usize,
    pub(crate) amplitudes: usize,
}

impl Candidates {
    /// Creates K = `amplitudes` times L = `phases` candidates with a = (k+1)/K and phi = 2 pi l/L.
    #[cfg(test)]
    pub(crate) fn new(phases: usize, amplitudes: usize, buffers: [Vec<f32>; 3]) -> Self {
        Self::grid(phases, (0..amplitudes).map(|k| (k as f64 + 1.0) / amplitudes as f64), buffers)
    }

    /// Creates L = `phases` phases 2 pi l/L for each of the given amplitudes. Sets the length of the `buffers`.
    pub(crate) fn grid(phases: usize, amplitudes: impl Iterator<Item = f64>, buffers: [Vec<f32>; 3]) -> Self {
        Self::made(phases, |l| l as f64 / phases as f64, amplitudes, buffers)
    }

    /// Creates `width` rotations, at most `phases`, by steps of 1/`phases` turn at full amplitude: 0, then 1, -1, 2,
    /// -2, ...
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
        let [mut cosines, mut sines, mut amplitude_table] = buffers;
        amplitude_table.clear();
        amplitude_table.extend(amplitudes.map(|amplitude| amplitude as f32));
        for (buffer, part) in [(&mut cosines, cos as fn(f64) -> f64), (&mut sines, sin)] {
            buffer.clear();
            buffer.extend((0..table(phases)).map(|l| {
                let angle = TAU * turns_of(l % phases);
                part(angle) as f32
            }));
        }
        let amplitudes = amplitude_table.len();
        let every = |odd: usize| {
            [&cosines, &sines].map(|part| core::array::from_fn(|c| part[(2 * c + odd) * phases / (2 * LANES)]))
        };
        let coarse = [every(0), every(1)];
        Self { cos: cosines, sin: sines, coarse, amplitude_table, phases, amplitudes }
    }

    /// Returns the number of candidates.
    pub(crate) fn count(&self) -> usize {
        self.phases * self.amplitudes
    }

    /// Returns amplitude k.
    #[inline(always)]
    pub(crate) fn amplitude(&self, k: usize) -> f32 {
        self.amplitude_table[k]
    }

    /// Returns the drive (re, im) of candidate k L + l.
    #[inline(always)]
    pub(crate) fn drive(&self, index: usize) -> [f32; 2] {
        // Most grids have one amplitude, and a division takes as long as evaluating a candidate.
        let k = if index < self.phases { 0 } else { index / self.phases };
        let (amplitude, l) = (self.amplitude(k), index - k * self.phases);
        [amplitude * self.cos[l], amplitude * self.sin[l]]
    }

    /// Returns cos and sin of phase l.
    #[inline(always)]
    pub(crate) fn phasor(&self, l: usize) -> [f32; 2] {
        [self.cos[l], self.sin[l]]
    }

    /// Returns cos and sin of 16 phases from l on.
    #[inline(always)]
    pub(crate) fn sixteen(&self, l: usize) -> [&Lanes; 2] {
        [&self.cos, &self.sin].map(|part| part[l..].first_chunk().unwrap_or(&[0.0; LANES]))
    }

    /// Returns the drives of 16 phases from l on at amplitude a.
    #[inline(always)]
    pub(crate) fn drives(&self, a: f32, l: usize) -> Sixteen<'_> {
        Sixteen { amplitude: a, phasors: self.sixteen(l) }
    }

    /// Returns the index of the phase where an arc begins; an arc is 1/32 of a turn.
    #[inline(always)]
    pub(crate) fn start(&self, arc: usize) -> usize {
        arc * self.phases / (2 * LANES)
    }

    /// Returns the drives at amplitude a at the even and at the odd multiples of 1/32 of a turn.
    #[inline(always)]
    pub(crate) fn coarse(&self, a: f32) -> [Sixteen<'_>; 2] {
        self.coarse.each_ref().map(|phasors| Sixteen { amplitude: a, phasors: phasors.each_ref() })
    }

    /// Returns the buffers, so that they can be used again.
    pub(crate) fn into_buffers(self) -> [Vec<f32>; 3] {
        [self.cos, self.sin, self.amplitude_table]
    }
}

/// 16 drives: an amplitude times cosines and sines.
#[derive(Clone, Copy)]
pub(crate) struct Sixteen<'a> {
    pub(crate) amplitude: f32,
    pub(crate) phasors: [&'a Lanes; 2],
}

impl Sixteen<'_> {
    /// Returns the real and imaginary parts.
    #[inline(always)]
    pub(crate) fn load<S: Elementwise>(&self, s: S) -> [S::V; 2] {
        let amplitude = s.splat(self.amplitude);
        [s.mul(amplitude, s.load(self.phasors[0])), s.mul(amplitude, s.load(self.phasors[1]))]
    }
}

/// The term of one point in the energy, as a function of |P|.
pub(crate) trait Term {
    /// Whether the term is (t - |P|)^2, for which the moments are known.
    const SQUARE: bool;
    /// Returns the change of the term when |P| grows by `rise`; `gap` = target - |P| before.
    fn change<S: Elementwise>(s: S, rise: S::V, gap: S::V) -> S::V;
    /// Returns a bound on the change of the term by a drive of modulus 1; `gain` is a bound on |G|, and so on |rise|.
    fn bound<S: Elementwise>(s: S, gain: S::V, gap: S::V) -> S::V;
}

/// (t - |P|)^2, the paper's eq. (7).
pub(crate) struct L2;

/// |t - |P||, which the authors' code minimises.
pub(crate) struct L1;

impl Term for L2 {
    const SQUARE: bool = true;

    #[inline(always)]
    fn change<S: Elementwise>(s: S, rise: S::V, gap: S::V) -> S::V {
        s.mul(rise, s.sub(rise, s.add(gap, gap)))
    }

    #[inline(always)]
    fn bound<S: Elementwise>(s: S, gain: S::V, gap: S::V) -> S::V {
        let gap = s.abs(gap);
        s.mul(gain, s.add(gain, s.add(gap, gap)))
    }
}

impl Term for L1 {
    const SQUARE: bool = false;

    #[inline(always)]
    fn change<S: Elementwise>(s: S, rise: S::V, gap: S::V) -> S::V {
        s.sub(s.abs(s.sub(gap, rise)), s.abs(gap))
    }

    #[inline(always)]
    fn bound<S: Elementwise>(_: S, gain: S::V, _gap: S::V) -> S::V {
        gain
    }
}

/// Squares of smaller numbers are 0 in f32. This constant is added to |P| + |P + e|, so that 0/0 does not occur.
const SMALLEST: f32 = 1e-20;

/// Returns |P + e| - |P|, the change of the modulus of a pressure P (re, im, modulus) when a wave e is added.
#[inline(always)]
pub(crate) fn rise<S: Elementwise>(s: S, [pr, pi, old]: [S::V; 3], [er, ei]: [S::V; 2]) -> S::V {
    let (x, y) = (s.add(pr, er), s.add(pi, ei));
    // This is |P + e|^2 - |P|^2 without the cancellation of two large terms.
    let square = s.fma(er, s.add(pr, x), s.mul(ei, s.add(pi, y)));
    let new = s.sqrt_rsqrt(s.max(s.fma(x, x, s.mul(y, y)), s.splat(TINY))).0;
    s.mul(square, reciprocal(s, s.add(new, s.add(old, s.splat(SMALLEST)))))
}

/// Returns 1/a of normal a > 0, from the inverse root and one step of Newton's method.
#[inline(always)]
fn reciprocal<S: Elementwise>(s: S, a: S::V) -> S::V {
    let guess = s.rsqrt_estimate(a);
    let guess = s.mul(guess, guess);
    s.fma(guess, s.fnma(a, guess, s.splat(1.0)), guess)
}
