//! Track: the phases of one transducer over all frames that serve a given wave best, none far from the one before.
//!
//! For waves S(t) that the transducer is to follow, the sum over t of Re(conj(S(t)) q(t)) is largest for the track that
//! dynamic programming finds (Viterbi, IEEE Trans. Inf. Theory 13(2), 1967): of every phase, the best that a track ending
//! there can have reached; then back from the best end. No search is better, whatever its start.

use alloc::vec;
use alloc::vec::Vec;

use crate::control::Control;
use crate::error::Error;
use crate::kernels::InstructionSet;
use crate::kernels::track::{advance, advance_floats};
use crate::math::phasor;

/// A device's phases 2 pi l / L, and how many of them a transducer may move from one frame to the next.
pub(super) struct Circle {
    pub(super) levels: usize,
    /// The largest change, in phases.
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

    /// q of a phase.
    pub(super) fn drive(&self, code: u16) -> [f32; 2] {
        [self.cos[usize::from(code)], self.sin[usize::from(code)]]
    }

    /// `code` moved by `steps` of less than a whole turn.
    pub(super) fn moved(&self, code: u16, steps: isize) -> u16 {
        (usize::from(code) + self.levels).wrapping_add_signed(steps).rem_euclid(self.levels) as u16
    }

    /// The number of phases between two codes, the shorter way round.
    pub(super) fn between(&self, a: u16, b: u16) -> usize {
        let apart = usize::from(a.abs_diff(b));
        apart.min(self.levels - apart)
    }
}

/// The bounds of tracks at their ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::exhaustive_enums, reason = "a sequence has no more ends")]
pub enum Ends {
    /// Neither the first frame nor the last is bound.
    Open,
    /// The last frame is followed by the first, within the bound.
    Closed,
    /// The first frame stays as it is, and the others go on from there.
    Held,
}

/// The memory in which tracks are found.
pub(super) struct Tracker<'a> {
    circle: &'a Circle,
    set: InstructionSet,
    /// The best of tracks that end in each phase, frame by frame.
    best: Vec<f32>,
    memory: Vec<f32>,
}

impl<'a> Tracker<'a> {
    pub(super) fn new(circle: &'a Circle, frames: usize, set: InstructionSet) -> Self {
        let memory = vec![0.0; advance_floats(circle.levels, circle.reach.min(circle.levels))];
        Self { circle, set, best: vec![0.0; frames * circle.levels], memory }
    }

    /// Writes the best track along the waves (T,). With [`Ends::Held`] it begins at `codes`. One that is closed comes
    /// back to where it began: it begins as a track of two laps goes through their middle, and is the best of all that begin
    /// there.
    pub(super) fn follow(
        &mut self,
        waves: [&[f32]; 2],
        ends: Ends,
        codes: &mut [u16],
        control: &mut Control,
    ) -> Result<(), Error> {
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

    /// The best phase of a frame.
    fn end(&self, frame: usize) -> u16 {
        let best = &self.best[frame * self.circle.levels..][..self.circle.levels];
        (0..best.len()).fold(0, |end, l| if best[l] > best[end] { l } else { end }) as u16
    }

    /// Adds the gain of each phase in a frame to the best before it.
    fn meet(&mut self, [re, im]: [&[f32]; 2], frame: usize) {
        let own = &mut self.best[frame * self.circle.levels..][..self.circle.levels];
        for ((best, cos), sin) in own.iter_mut().zip(&self.circle.cos).zip(&self.circle.sin) {
            *best += re[frame] * cos + im[frame] * sin;
        }
    }

    /// All frames after the first, each from the one before.
    fn lap(&mut self, waves: [&[f32]; 2], base: usize, control: &mut Control) -> Result<(), Error> {
        for frame in 1..waves[0].len() {
            control.pulse()?;
            self.step(waves, frame - 1, frame, base);
        }
        Ok(())
    }

    /// One frame from another, all relative to the best that ends in the phase `base` there: sums stay small.
    fn step(&mut self, [re, im]: [&[f32]; 2], from: usize, to: usize, base: usize) {
        let Circle { levels, reach, cos, sin } = self.circle;
        let rows = self.best.get_disjoint_mut([from * levels..(from + 1) * levels, to * levels..(to + 1) * levels]);
        let [from, out] = rows.expect("two frames");
        let gain = (from[base], [re[to], im[to]], [&cos[..], &sin[..]]);
        advance(self.set, from, *reach, gain, &mut self.memory, out);
    }

    /// The best phase of a frame within reach of another; of equals the nearest.
    fn near(&self, frame: usize, code: u16) -> u16 {
        let levels = self.circle.levels;
        let best = &self.best[frame * levels..(frame + 1) * levels];
        let most = self.circle.reach.min(levels / 2) as isize;
        let steps = (1..=most).flat_map(|step| [-step, step]);
        steps
            .map(|step| self.circle.moved(code, step))
            .fold(code, |kept, other| if best[usize::from(other)] > best[usize::from(kept)] { other } else { kept })
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
