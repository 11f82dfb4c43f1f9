//! The brute-force search of the greedy method: which candidate drive lowers the energy most.
//!
//! Sixteen candidates lie in the lanes and the points pass by one after another, so nothing is padded in the
//! points and no sum runs across lanes.

use core::array::from_fn;

use super::{LANES, Lanes, groups, padded};
use crate::math::{cos, sin, sqrtf};
use alloc::vec::Vec;

/// A point's term of eq. (7) as a function of |P|^2, by its change.
pub(crate) trait Term {
    /// The change of the term when |P| goes from `old` up by `rise` and |P|^2 up by `square`.
    fn change(old: f32, rise: f32, square: f32, target: f32) -> f32;
}

/// (t - |P|)^2, the paper's eq. (7).
pub(crate) struct L2;

/// |t - |P||, which the authors' code minimises.
pub(crate) struct L1;

impl Term for L2 {
    #[inline(always)]
    fn change(_old: f32, rise: f32, square: f32, target: f32) -> f32 {
        square - (target + target) * rise
    }
}

impl Term for L1 {
    #[inline(always)]
    fn change(old: f32, rise: f32, _square: f32, target: f32) -> f32 {
        let gap = target - old;
        (gap - rise).abs() - gap.abs()
    }
}

/// One point as the search sees it: its pressure, this transducer's gain, and what is asked for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Point {
    pub(crate) pressure: [f32; 2],
    pub(crate) modulus: f32,
    pub(crate) gain: [f32; 2],
    pub(crate) target: f32,
    pub(crate) weight: f32,
}

/// Candidate drives a e^{j phi}, a = (k+1)/K outer, phi = 2 pi l/L inner.
pub(crate) struct Candidates {
    re: Vec<f32>,
    im: Vec<f32>,
    count: usize,
}

impl Candidates {
    /// Fills two buffers with K = `amplitudes` times L = `phases` candidates; their length is set here.
    pub(crate) fn new(phases: usize, amplitudes: usize, mut re: Vec<f32>, mut im: Vec<f32>) -> Self {
        let count = phases * amplitudes;
        for buffer in [&mut re, &mut im] {
            buffer.clear();
            buffer.resize(padded(count), 0.0);
        }
        for phase in 0..phases {
            let angle = core::f64::consts::TAU * phase as f64 / phases as f64;
            let (cos, sin) = (cos(angle), sin(angle));
            for level in 0..amplitudes {
                let amplitude = (level as f64 + 1.0) / amplitudes as f64;
                re[level * phases + phase] = (amplitude * cos) as f32;
                im[level * phases + phase] = (amplitude * sin) as f32;
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

/// Below this difference two energies are equal: 1e-7 (f32 rounding) of a bound on the largest term summed.
pub(crate) fn tolerance(points: &[Point]) -> f32 {
    points.iter().fold(0.0, |most: f32, point| {
        let gain = sqrtf(point.gain[0] * point.gain[0] + point.gain[1] * point.gain[1]);
        let term = point.weight * gain * (gain + 2.0 * (point.modulus + point.target));
        if term > most { term } else { most }
    }) * 1e-7
}

/// The change of the energy for each candidate of one group.
#[inline(always)]
fn changes<T: Term>(points: &[Point], re: &Lanes, im: &Lanes) -> Lanes {
    let mut total = [0.0; LANES];
    for point in points {
        let ([gr, gi], [pr, pi]) = (point.gain, point.pressure);
        let er: Lanes = from_fn(|l| gr * re[l] - gi * im[l]);
        let ei: Lanes = from_fn(|l| gr * im[l] + gi * re[l]);
        let x: Lanes = from_fn(|l| pr + er[l]);
        let y: Lanes = from_fn(|l| pi + ei[l]);
        // |P + e|^2 - |P|^2 and |P + e| - |P| without the cancellation of their two large parts.
        let square: Lanes = from_fn(|l| er[l] * (pr + x[l]) + ei[l] * (pi + y[l]));
        let modulus: Lanes = from_fn(|l| sqrtf(x[l] * x[l] + y[l] * y[l]));
        let rise: Lanes = from_fn(|l| square[l] / (modulus[l] + point.modulus + f32::MIN_POSITIVE));
        total = from_fn(|l| {
            total[l] + point.weight * T::change(point.modulus, rise[l], square[l], point.target)
        });
    }
    total
}

/// The first candidate that no other one beats by more than `tolerance`; `stride` = L searches the amplitudes
/// alone (phase 0), 1 all candidates.
pub(crate) fn best<T: Term>(points: &[Point], candidates: &Candidates, stride: usize, tolerance: f32) -> usize {
    let mut winner = (0, f32::INFINITY);
    let mut offer = |index: usize, change: f32| {
        if change < winner.1 - tolerance || winner.1 == f32::INFINITY {
            winner = (index, change);
        }
    };
    if stride == 1 {
        for (group, (re, im)) in groups(&candidates.re).iter().zip(groups(&candidates.im)).enumerate() {
            for (lane, change) in changes::<T>(points, re, im).into_iter().enumerate() {
                offer(group * LANES + lane, change);
            }
        }
    } else {
        for first in (0..candidates.count).step_by(stride * LANES) {
            let index = |lane: usize| (first + lane * stride).min(candidates.count - stride);
            let re = from_fn(|lane| candidates.re[index(lane)]);
            let im = from_fn(|lane| candidates.im[index(lane)]);
            for (lane, change) in changes::<T>(points, &re, &im).into_iter().enumerate() {
                offer(index(lane), change);
            }
        }
    }
    winner.0
}
