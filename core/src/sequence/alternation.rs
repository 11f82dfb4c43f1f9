//! Alternation: best tracks for given point phases and weights, then new phases and weights from their field.
//!
//! For point phases psi_j(t) and weights w_j(t), transducer i is to follow the wave S_i(t) = sum_j w_j e^{j psi_j}
//! conj(G_ji). Each transducer is then independent of the others, and its best track is found exactly. The field of the
//! tracks gives the next phases (Gerchberg-Saxton over all frames at once), and larger or smaller weights for points
//! that are too weak or too loud (Di Leonardo et al., Opt. Express 15(4), 2007).

use crate::math::unit;
use crate::prelude::*;
use crate::sequence::frames::{Frames, Visit};
use crate::sequence::track::{Circle, Ends, Tracker};

/// The part of a point's old phasor that is subtracted from its field before the new phase is read: the field mostly
/// repeats the old phase. In trials it halves the rounds; with .8 they do not converge.
const ECHO: f32 = 0.5;

/// The largest factor of a weight in a round.
const MOST_CHANGE: f32 = 2.0;

/// Factors of a weight's step size: the first if the weight continues in its direction, the second if it turns back.
const PACES: [f32; 2] = [1.2, 0.5];

/// The phases and weights of the points in all frames.
pub(super) struct ComplexWeights {
    /// The weights w_j (T, M); 0 for an absent point.
    weights: Vec<f32>,
    /// Step size of each weight in a round (T, M), as a part of the way to level/|P_j|. With the whole way two or three
    /// points would alternate.
    paces: Vec<f32>,
    /// Whether a point was too weak in the last round (T, M).
    weak: Vec<bool>,
    /// The phasors e^{j psi_j} (T, M), real and imaginary parts, over the lanes of a row.
    phasors: [Vec<f32>; 2],
}

impl ComplexWeights {
    /// Takes the phases of a field (T, M), and weights at which each point's own wave has the requested strength.
    pub(super) fn of(frames: &Frames, field: &[Vec<f32>; 2]) -> Self {
        let weight = |(target, reach): (&f32, &f32)| if *target > 0.0 { target / (reach * reach) } else { 0.0 };
        let mut weights = Self {
            weights: frames.targets.iter().zip(&frames.reach).map(weight).collect(),
            paces: vec![0.0; frames.targets.len()],
            weak: vec![false; frames.targets.len()],
            phasors: [(); 2].map(|()| vec![0.0; frames.lanes()]),
        };
        weights.read(frames, field);
        weights.paces.fill(1.0);
        weights
    }

    /// Updates phases and weights from a field; every frame counts equally.
    pub(super) fn read(&mut self, frames: &Frames, [re, im]: &[Vec<f32>; 2]) {
        for first in (0..self.weights.len()).step_by(frames.points) {
            let there = (first..first + frames.points).filter(|&k| frames.targets[k] > 0.0);
            let modulus = |k: usize| sqrtf(re[k] * re[k] + im[k] * im[k]);
            let parts = there.clone().map(|k| modulus(k) / frames.targets[k]);
            let level = parts.sum::<f32>() / there.clone().count() as f32;
            let mut sum = 0.0;
            for k in there.clone() {
                let modulus = modulus(k);
                if modulus > 0.0 {
                    let [old_re, old_im] = [self.phasors[0][k], self.phasors[1][k]];
                    let (re, im) = unit(re[k] / modulus - ECHO * old_re, im[k] / modulus - ECHO * old_im);
                    (self.phasors[0][k], self.phasors[1][k]) = (re, im);
                    let change = (level * frames.targets[k] / modulus).clamp(1.0 / MOST_CHANGE, MOST_CHANGE);
                    let turned = usize::from((change > 1.0) != self.weak[k]);
                    self.paces[k] = (self.paces[k] * PACES[turned]).min(1.0);
                    self.weak[k] = change > 1.0;
                    self.weights[k] *= 1.0 + self.paces[k] * (change - 1.0);
                }
                sum += self.weights[k] * frames.targets[k];
            }
            if level > 0.0 {
                there.for_each(|k| self.weights[k] /= sum * level);
            }
        }
    }

    /// Returns w_j e^{j psi_j}, over the lanes of a row.
    fn pull(&self) -> [Vec<f32>; 2] {
        self.phasors.each_ref().map(|plane| {
            let mut pull = vec![0.0; plane.len()];
            pull.iter_mut().zip(plane).zip(&self.weights).for_each(|((pull, part), weight)| *pull = part * weight);
            pull
        })
    }
}

/// Writes the best tracks for the requested pressures to `codes` (N, T); returns their field (T, M).
pub(super) fn follow(
    frames: &Frames,
    weights: &ComplexWeights,
    circle: &Circle,
    ends: Ends,
    codes: &mut [u16],
    control: &mut Control,
) -> Result<[Vec<f32>; 2]> {
    let [pull_re, pull_im] = &weights.pull();
    let worker = || (Tracker::new(circle, frames.count, frames.set()), [(); 2].map(|()| vec![0.0; frames.count]));
    frames.gather(
        codes,
        &worker,
        &|(tracker, waves), Visit { row: [re, im], codes, sum }, control| {
            for frame in 0..frames.count {
                let mut wave = [0.0_f32; 2];
                for k in frame * frames.points..(frame + 1) * frames.points {
                    wave[0] += re[k] * pull_re[k] + im[k] * pull_im[k];
                    wave[1] += re[k] * pull_im[k] - im[k] * pull_re[k];
                }
                (waves[0][frame], waves[1][frame]) = (wave[0], wave[1]);
            }
            tracker.follow([&waves[0], &waves[1]], ends, codes, control)?;
            play(frames, circle, Visit { row: [re, im], codes, sum });
            Ok(())
        },
        control,
    )
}

/// Returns the field (T, M) of given `codes` (N, T).
pub(super) fn field(
    frames: &Frames,
    circle: &Circle,
    codes: &mut [u16],
    control: &mut Control,
) -> Result<[Vec<f32>; 2]> {
    frames.gather(
        codes,
        &|| (),
        &|(), visit, _| {
            play(frames, circle, visit);
            Ok(())
        },
        control,
    )
}

/// Adds the pressures of one transducer's codes at the points of all frames.
fn play(frames: &Frames, circle: &Circle, Visit { row: [re, im], codes, sum: [sum_re, sum_im] }: Visit<'_>) {
    for (frame, &code) in codes.iter().enumerate() {
        let [qr, qi] = circle.drive(code);
        for k in frame * frames.points..(frame + 1) * frames.points {
            sum_re[k] += re[k] * qr - im[k] * qi;
            sum_im[k] += re[k] * qi + im[k] * qr;
        }
    }
}
