//! The brute-force search of the greedy method: which candidate drive lowers the energy most.
//!
//! Sixteen candidates lie in the lanes and the points pass by one after another, so nothing is padded in the
//! points and no sum runs across lanes.

use core::array::from_fn;

use super::{LANES, Lanes, groups, padded};
use crate::math::{cos, sin, sqrtf};
use alloc::vec::Vec;

/// A point's term of eq. (7), by its change when |P| rises towards its target or past it.
pub(crate) trait Term {
    /// The change of the term when |P| rises by `rise`, `gap` = target - |P| before.
    fn change(rise: f32, gap: f32) -> f32;
    /// A bound on it for a drive of modulus 1: `gain` bounds |G|, and so |rise|.
    fn bound(gain: f32, gap: f32) -> f32;
}

/// (t - |P|)^2, the paper's eq. (7).
pub(crate) struct L2;

/// |t - |P||, which the authors' code minimises.
pub(crate) struct L1;

impl Term for L2 {
    #[inline(always)]
    fn change(rise: f32, gap: f32) -> f32 {
        rise * (rise - (gap + gap))
    }

    #[inline(always)]
    fn bound(gain: f32, gap: f32) -> f32 {
        gain * (gain + 2.0 * gap.abs())
    }
}

impl Term for L1 {
    #[inline(always)]
    fn change(rise: f32, gap: f32) -> f32 {
        (gap - rise).abs() - gap.abs()
    }

    #[inline(always)]
    fn bound(gain: f32, _gap: f32) -> f32 {
        gain
    }
}

/// The points as the search sees them: their pressures, this transducer's gains, and what is asked for. All
/// slices are padded alike.
#[derive(Clone, Copy)]
pub(crate) struct Points<'a> {
    pub(crate) pressure: [&'a [f32]; 2],
    pub(crate) modulus: &'a [f32],
    pub(crate) gain: [&'a [f32]; 2],
    pub(crate) target: &'a [f32],
    pub(crate) weight: &'a [f32],
    /// How many of them are points; the rest is padding.
    pub(crate) count: usize,
}

/// Squares of smaller numbers vanish in f32; added to |P| + |P + e| it keeps 0/0 away.
const SMALLEST: f32 = 1e-20;

/// Candidate drives a e^{j phi}.
pub(crate) struct Candidates {
    re: Vec<f32>,
    im: Vec<f32>,
    count: usize,
}

impl Candidates {
    /// K = `amplitudes` times L = `phases` candidates: a = (k+1)/K outer, phi = 2 pi l/L inner.
    #[cfg(test)]
    pub(crate) fn new(phases: usize, amplitudes: usize, re: Vec<f32>, im: Vec<f32>) -> Self {
        let even = |k: usize| (k as f64 + 1.0) / amplitudes as f64;
        Self::grid(phases, amplitudes, even, re, im)
    }

    /// The same with the amplitudes of a table. Fills two buffers; their length is set here.
    pub(crate) fn grid(
        phases: usize,
        amplitudes: usize,
        amplitude: impl Fn(usize) -> f64,
        mut re: Vec<f32>,
        mut im: Vec<f32>,
    ) -> Self {
        let count = phases * amplitudes;
        for buffer in [&mut re, &mut im] {
            buffer.clear();
            buffer.resize(padded(count), 0.0);
        }
        for phase in 0..phases {
            let angle = core::f64::consts::TAU * phase as f64 / phases as f64;
            let (cos, sin) = (cos(angle), sin(angle));
            for level in 0..amplitudes {
                re[level * phases + phase] = (amplitude(level) * cos) as f32;
                im[level * phases + phase] = (amplitude(level) * sin) as f32;
            }
        }
        // The last candidate again in the spare lanes: a copy never wins against its original.
        let last = (re[count - 1], im[count - 1]);
        re[count..].fill(last.0);
        im[count..].fill(last.1);
        Self { re, im, count }
    }

    /// The drive (re, im) of candidate `index`.
    pub(crate) fn drive(&self, index: usize) -> [f32; 2] {
        [self.re[index], self.im[index]]
    }

    /// Gives the two buffers back.
    pub(crate) fn into_buffers(self) -> [Vec<f32>; 2] {
        [self.re, self.im]
    }
}

/// Below this difference two energies are equal: 1e-7 (f32 rounding) of a bound on the largest term summed. 0 if
/// the transducer cannot change any term.
pub(crate) fn tolerance<T: Term>(points: Points<'_>) -> f32 {
    let gains = groups(points.gain[0]).iter().zip(groups(points.gain[1]));
    let asked = groups(points.target).iter().zip(groups(points.weight));
    let mut most = [0.0; LANES];
    for (((re, im), old), (target, weight)) in gains.zip(groups(points.modulus)).zip(asked) {
        let bound: Lanes = from_fn(|l| weight[l] * T::bound(re[l].abs() + im[l].abs(), target[l] - old[l]));
        most = from_fn(|l| if bound[l] > most[l] { bound[l] } else { most[l] });
    }
    1e-7 * greatest(&most)
}

/// The greatest lane, halves against halves.
#[inline(always)]
fn greatest(lanes: &Lanes) -> f32 {
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let eight: [f32; 8] = from_fn(|l| larger(lanes[l], lanes[l + 8]));
    let four: [f32; 4] = from_fn(|l| larger(eight[l], eight[l + 4]));
    larger(larger(four[0], four[2]), larger(four[1], four[3]))
}

/// The change of the energy for each candidate of one group.
#[inline(always)]
fn changes<T: Term>(points: Points<'_>, re: &Lanes, im: &Lanes) -> Lanes {
    let count = points.count;
    let [pressure_re, pressure_im] = points.pressure.map(|slice| &slice[..count]);
    let [gain_re, gain_im] = points.gain.map(|slice| &slice[..count]);
    let [modulus, target, weight] =
        [points.modulus, points.target, points.weight].map(|slice| &slice[..count]);
    let mut total = [0.0; LANES];
    for j in 0..count {
        let (gr, gi, pr, pi) = (gain_re[j], gain_im[j], pressure_re[j], pressure_im[j]);
        let (old, target, weight) = (modulus[j], target[j], weight[j]);
        let (floor, gap) = (old + SMALLEST, target - old);
        for l in 0..LANES {
            let er = gr * re[l] - gi * im[l];
            let ei = gr * im[l] + gi * re[l];
            let (x, y) = (pr + er, pi + ei);
            // |P + e|^2 - |P|^2 without the cancellation of its two large parts.
            let square = er * (pr + x) + ei * (pi + y);
            // So is |P + e| - |P|.
            let rise = square / (sqrtf(x * x + y * y) + floor);
            total[l] += weight * T::change(rise, gap);
        }
    }
    total
}

/// The first candidate that no other one beats by more than `tolerance`; `stride` = L searches the amplitudes
/// alone (phase 0), 1 all candidates.
pub(crate) fn best<T: Term>(
    points: Points<'_>,
    candidates: &Candidates,
    stride: usize,
    tolerance: f32,
) -> usize {
    let mut winner = (0, f32::INFINITY);
    if stride == 1 {
        for (group, (re, im)) in groups(&candidates.re).iter().zip(groups(&candidates.im)).enumerate() {
            if let Some((lane, change)) = winner_of(&changes::<T>(points, re, im), winner.1, tolerance) {
                winner = (group * LANES + lane, change);
            }
        }
    } else {
        for first in (0..candidates.count).step_by(stride * LANES) {
            let index = |lane: usize| (first + lane * stride).min(candidates.count - stride);
            let re = from_fn(|lane| candidates.re[index(lane)]);
            let im = from_fn(|lane| candidates.im[index(lane)]);
            if let Some((lane, change)) = winner_of(&changes::<T>(points, &re, &im), winner.1, tolerance) {
                winner = (index(lane), change);
            }
        }
    }
    winner.0
}

/// The first lane within `tolerance` of the least, if that beats what stands by more than `tolerance`.
#[inline(always)]
fn winner_of(changes: &Lanes, stands: f32, tolerance: f32) -> Option<(usize, f32)> {
    let least = -greatest(&from_fn(|l| -changes[l]));
    if stands - least <= tolerance {
        return None;
    }
    let within =
        changes.iter().rev().fold(0_u32, |bits, &change| bits << 1 | u32::from(change <= least + tolerance));
    let lane = (within.trailing_zeros() as usize).min(LANES - 1);
    Some((lane, changes[lane]))
}
