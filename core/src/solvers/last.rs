//! The last frame, as a solver that follows moving points remembers it.

use alloc::vec::Vec;

use num_complex::Complex32;

use crate::workspace::Workspace;

/// q/|q| of a q that is 1 but for rounding, or 0: a step of Newton's for the root.
pub(crate) fn settled(q: Complex32) -> Complex32 {
    q * (1.5 - 0.5 * q.norm_sqr())
}

/// The state that a solver keeps from frame to frame; empty before the first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Last {
    /// Drives (N,) at full amplitude as they were found, before a board's grid.
    pub(crate) wave: Vec<Complex32>,
    /// The drives as they were played: the next frame's phases may differ from them by the bound.
    pub(crate) played: Vec<Complex32>,
    /// The transducers' envelopes (N,), of drives at full amplitude.
    pub(crate) envelope: Vec<Complex32>,
    /// Weights of the points.
    pub(crate) weights: Vec<f32>,
    /// The unevenness of the points after the last new codes.
    pub(crate) unevenness: f32,
    /// Of traps, places (M, 3) in m, and once they are known their velocities in m/s and accelerations in m/s^2.
    pub(crate) motion: Vec<[f64; 3]>,
    /// Of the points (M, 3) of the frame to be solved, where they are known: places this many frames before, then as many after.
    pub(crate) around: (Vec<[f64; 3]>, usize),
}

impl Last {
    /// Whether there is a last frame.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.played.is_empty()
    }

    /// The frame's drives (N,) at full amplitude, before and after rounding, the envelopes (N,), and the weights and
    /// the unevenness of the points: with [`Last::motion`] what [`Last::restore`] goes on from.
    #[must_use]
    pub fn parts(&self) -> ([&[Complex32]; 3], &[f32], f32) {
        ([&self.wave, &self.played, &self.envelope], &self.weights, self.unevenness)
    }

    /// Of traps, places (M, 3) in m, and once they are known velocities in m/s and accelerations in m/s^2.
    #[must_use]
    pub fn motion(&self) -> &[[f64; 3]] {
        &self.motion
    }

    /// A last frame of [`Last::parts`].
    #[must_use]
    pub fn restore(
        [wave, played, envelope]: [Vec<Complex32>; 3],
        weights: Vec<f32>,
        unevenness: f32,
        motion: Vec<[f64; 3]>,
    ) -> Self {
        Self { wave, played, envelope, weights, unevenness, motion, ..Self::default() }
    }

    /// Forgets it; the memory is kept.
    pub fn clear(&mut self) {
        for drives in [&mut self.wave, &mut self.played, &mut self.envelope] {
            drives.clear();
        }
        self.weights.clear();
        self.unevenness = 0.0;
        self.motion.clear();
        self.around.0.clear();
    }

    /// One in the memory of a workspace.
    pub(crate) fn taken(work: &Workspace, transducers: usize, points: usize) -> Self {
        let [wave, played, envelope] = [(); 3].map(|()| work.complexes.empty(transducers));
        Self { wave, played, envelope, weights: work.floats.empty(points), ..Self::default() }
    }

    /// Gives that back.
    pub(crate) fn recycle(self, work: &Workspace) {
        for list in [self.wave, self.played, self.envelope] {
            work.complexes.give(list);
        }
        work.floats.give(self.weights);
    }

    /// Turns transducers off that reach no point, and on, at any phase, those that reach one again.
    pub(crate) fn reach(&mut self, reaches: impl Fn(usize) -> bool) {
        for (i, (played, wave)) in self.played.iter_mut().zip(&mut self.wave).enumerate() {
            match (reaches(i), *played == Complex32::ZERO) {
                (true, true) => (*played, *wave) = (Complex32::ONE, Complex32::ONE),
                (false, false) => (*played, *wave) = (Complex32::ZERO, Complex32::ZERO),
                _ => {}
            }
        }
    }

    /// Begins with full drives that have been played for long.
    pub(crate) fn begin(&mut self, drives: impl Iterator<Item = Complex32>) {
        let around = core::mem::take(&mut self.around);
        self.clear();
        self.around = around;
        self.played.extend(drives);
        self.wave.extend_from_slice(&self.played);
        self.envelope.extend_from_slice(&self.played);
    }
}
