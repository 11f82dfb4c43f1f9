//! Track: the phases of one transducer over all frames that follow a wave best, with bounded changes.
//!
//! For waves S(t) that the transducer is to follow, the best track has the largest sum over t of Re(conj(S(t)) q(t)).
//! Dynamic programming finds it (Viterbi, IEEE Trans. Inf. Theory 13(2), 1967): frame by frame, for every phase, the
//! largest sum of a track that ends there; then the track back from the best end. No other search gives a better track.

use crate::kernels::track::{Gain, advance, advance_floats};
use crate::math::{phase, phasor, round};
use crate::solvers::prelude::*;

/// A device's phases 2 pi l / L, and the largest change of a transducer's phase from one frame to the next.
pub(super) struct Circle {
    pub(super) levels: usize,
    /// The largest change, as a number of phases.
    pub(super) reach: usize,
    cos: Vec<f32>,
    sin: Vec<f32>,
}

impl Circle {
    pub(super) fn new(levels: usize, reach: usize) -> Self {
        let angle = |l: usize| core::f64::consts::TAU * l as f64 / levels as f64;
        let (cos, sin) = (0..levels).map(|l| phasor(angle(l))).map(|q| (q.re as f32, q.im as f32)).unzip();
        Self { levels, reach, cos, sin }
    }

    /// Returns the drive of a code l, e^{j 2 pi l/L}: real and imaginary part.
    pub(super) fn drive(&self, code: u16) -> [f32; 2] {
        [self.cos[usize::from(code)], self.sin[usize::from(code)]]
    }

    /// Returns the drive of a code as a complex number.
    pub(super) fn phasor(&self, code: u16) -> Complex32 {
        let [re, im] = self.drive(code);
        Complex32::new(re, im)
    }

    /// Returns the code of the phase nearest to that of a drive; 0 for a drive of 0.
    pub(super) fn nearest(&self, q: Complex32) -> u16 {
        nearest_code(q, self.levels)
    }

    /// Returns `code` changed by `steps`, which is less than a whole turn.
    pub(super) fn moved(&self, code: u16, steps: isize) -> u16 {
        (usize::from(code) + self.levels).wrapping_add_signed(steps).rem_euclid(self.levels) as u16
    }

    /// Returns the number of phases between two codes, the shorter way round.
    pub(super) fn between(&self, a: u16, b: u16) -> usize {
        let apart = usize::from(a.abs_diff(b));
        apart.min(self.levels - apart)
    }
}

/// Returns the code l of the phase 2 pi l/L that is nearest to that of a drive, for L = `levels`; 0 for a drive of 0.
pub(crate) fn nearest_code(q: Complex32, levels: usize) -> u16 {
    (round(phase(q) / TAU * levels as f64) as usize % levels) as u16
}

/// The bounds of tracks at the first and the last frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Neither the first frame nor the last is bound.
    Open,
    /// The first frame follows the last, within the bound.
    Closed,
    /// The first frame is given and stays as it is; the other frames follow it within the bound.
    Held,
}

/// Working memory in which tracks are found.
pub(super) struct Tracker<'a> {
    circle: &'a Circle,
    set: InstructionSet,
    /// For each frame and phase, the largest sum of gains of a track that ends in this phase.
    best: Vec<f32>,
    memory: Vec<f32>,
}

impl<'a> Tracker<'a> {
    pub(super) fn new(circle: &'a Circle, frames: usize, set: InstructionSet) -> Self {
        let memory = vec![0.0; advance_floats(circle.levels, circle.reach.min(circle.levels))];
        Self { circle, set, best: vec![0.0; frames * circle.levels], memory }
    }

    /// Writes the best track along the waves (T,). With [`Ends::Held`] it begins at the first of `codes`. A closed
    /// track returns to where it began: it is the best of those that begin at the phase that a track of two laps has in
    /// its middle.
    pub(super) fn follow(
        &mut self,
        waves: [&[f32]; 2],
        ends: Ends,
        codes: &mut [u16],
        control: &mut Control,
    ) -> Result<()> {
        let levels = self.circle.levels;
        if ends != Ends::Held {
            self.best[..levels].fill(0.0);
            self.meet(waves, 0);
            self.lap(waves, 0, control)?;
            if ends == Ends::Closed {
                self.step(waves, codes.len() - 1, 0, 0);
                self.lap(waves, 0, control)?;
            }
            self.back(self.end(codes.len() - 1), codes);
        }
        if ends != Ends::Open {
            let start = codes[0];
            self.best[..levels].fill(f32::NEG_INFINITY);
            self.best[usize::from(start)] = 0.0;
            self.lap(waves, usize::from(start), control)?;
            let last = codes.len() - 1;
            self.back(if ends == Ends::Closed { self.near(last, start) } else { self.end(last) }, codes);
        }
        Ok(())
    }

    /// Returns the best phase of a frame.
    fn end(&self, frame: usize) -> u16 {
        let best = &self.best[frame * self.circle.levels..][..self.circle.levels];
        (0..best.len()).fold(0, |end, l| if best[l] > best[end] { l } else { end }) as u16
    }

    /// Adds the gain of each phase in a frame to the best sum of gains before it.
    fn meet(&mut self, [re, im]: [&[f32]; 2], frame: usize) {
        let row = &mut self.best[frame * self.circle.levels..][..self.circle.levels];
        for ((best, cos), sin) in row.iter_mut().zip(&self.circle.cos).zip(&self.circle.sin) {
            *best += re[frame] * cos + im[frame] * sin;
        }
    }

    /// Computes all frames after the first, each from the one before.
    fn lap(&mut self, waves: [&[f32]; 2], base: usize, control: &mut Control) -> Result<()> {
        for frame in 1..waves[0].len() {
            control.pulse()?;
            self.step(waves, frame - 1, frame, base);
        }
        Ok(())
    }

    /// Computes the sums of one frame from those of another. They are relative to the other frame's sum at the phase
    /// `base`, so that they stay small.
    fn step(&mut self, [re, im]: [&[f32]; 2], from: usize, to: usize, base: usize) {
        let Circle { levels, reach, cos, sin } = self.circle;
        let rows = self.best.get_disjoint_mut([from * levels..(from + 1) * levels, to * levels..(to + 1) * levels]);
        let [from, out] = rows.expect("two frames");
        let gain = Gain { base: from[base], wave: [re[to], im[to]], circle: [cos, sin] };
        advance(self.set, from, *reach, gain, &mut self.memory, out);
    }

    /// Returns the best phase of a frame within reach of another phase; of equally good phases the nearest.
    fn near(&self, frame: usize, code: u16) -> u16 {
        let levels = self.circle.levels;
        let best = &self.best[frame * levels..(frame + 1) * levels];
        let most = self.circle.reach.min(levels / 2) as isize;
        let steps = (1..=most).flat_map(|step| [-step, step]);
        steps.map(|step| self.circle.moved(code, step)).fold(code, |choice, other| {
            if best[usize::from(other)] > best[usize::from(choice)] { other } else { choice }
        })
    }

    /// Writes the track that ends in a phase.
    fn back(&self, end: u16, codes: &mut [u16]) {
        let mut code = end;
        for (frame, out) in codes.iter_mut().enumerate().rev() {
            if frame + 1 < self.best.len() / self.circle.levels {
                code = self.near(frame, code);
            }
            *out = code;
        }
    }
}

#[cfg(test)]
#[path = "tests/track.rs"]
mod tests;
