//! The last frame, stored by a solver that follows moving points.

use crate::prelude::*;
use crate::workspace::Workspace;

/// Returns q/|q| for a q that is 0 or has modulus 1 except for rounding, by one step of Newton's method.
pub(crate) fn settled(q: Complex32) -> Complex32 {
    q * (1.5 - 0.5 * q.norm_sqr())
}

/// The state that a solver stores from frame to frame; empty before the first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Last {
    /// Drives (N,) at full amplitude as the solver found them, before they were rounded to a board's grid.
    pub(crate) wave: Vec<Complex32>,
    /// The drives (N,) that were played. The phases of the next frame may differ from these at most by the bound.
    pub(crate) played: Vec<Complex32>,
    /// The transducers' envelopes (N,) for drives at full amplitude.
    pub(crate) envelope: Vec<Complex32>,
    /// Weights of the points.
    pub(crate) weights: Vec<f32>,
    /// The unevenness of the points after the last change of codes.
    pub(crate) unevenness: f32,
    /// For traps: places (M, 3) in m, and once they are known velocities in m/s and accelerations in m/s^2.
    pub(crate) motion: Vec<[f64; 3]>,
    /// Known places of the points in other frames, (2 M, 3), and a number n: the places n frames before the next frame,
    /// then n frames after it.
    pub(crate) around: (Vec<[f64; 3]>, usize),
}

impl Last {
    /// Creates a last frame from the results of [`Last::parts`] and [`Last::motion`].
    pub fn restore(
        [wave, played, envelope]: [Vec<Complex32>; 3],
        weights: Vec<f32>,
        unevenness: f32,
        motion: Vec<[f64; 3]>,
    ) -> Self {
        Self { wave, played, envelope, weights, unevenness, motion, ..Self::default() }
    }

    /// Removes the frame; the memory is kept.
    pub fn clear(&mut self) {
        for drives in [&mut self.wave, &mut self.played, &mut self.envelope] {
            drives.clear();
        }
        self.weights.clear();
        self.unevenness = 0.0;
        self.motion.clear();
        self.around.0.clear();
    }

    /// Creates an empty state in the memory of a workspace.
    pub(crate) fn taken(work: &Workspace, transducers: usize, points: usize) -> Self {
        let [wave, played, envelope] = [(); 3].map(|()| work.complexes.empty(transducers));
        Self { wave, played, envelope, weights: work.floats.empty(points), ..Self::default() }
    }

    /// Returns the memory to the workspace.
    pub(crate) fn recycle(self, work: &Workspace) {
        for list in [self.wave, self.played, self.envelope] {
            work.complexes.give(list);
        }
        work.floats.give(self.weights);
    }

    /// Turns off transducers that reach no point. Turns on, at phase 0, transducers that were off and reach a point
    /// again.
    pub(crate) fn reach(&mut self, reaches: impl Fn(usize) -> bool) {
        for (i, (played, wave)) in self.played.iter_mut().zip(&mut self.wave).enumerate() {
            match (reaches(i), *played == Complex32::ZERO) {
                (true, true) => (*played, *wave) = (Complex32::ONE, Complex32::ONE),
                (false, false) => (*played, *wave) = (Complex32::ZERO, Complex32::ZERO),
                _ => {}
            }
        }
    }

    /// Starts with full drives that have been played for a long time.
    pub(crate) fn begin(&mut self, drives: impl Iterator<Item = Complex32>) {
        let around = core::mem::take(&mut self.around);
        self.clear();
        self.around = around;
        self.played.extend(drives);
        self.wave.extend_from_slice(&self.played);
        self.envelope.extend_from_slice(&self.played);
    }
}

getters! {
    Last:

    /// Returns whether there is a last frame.
    pub is_empty(self) -> bool = self.played.is_empty();

    /// Returns the frame's drives (N,) at full amplitude before and after rounding, the envelopes (N,), and the weights
    /// and the unevenness of the points. Together with [`Last::motion`] they are the arguments of [`Last::restore`].
    pub parts(self) -> ([&[Complex32]; 3], &[f32], f32) =
        ([&self.wave, &self.played, &self.envelope], &self.weights, self.unevenness);

    /// Returns, for traps, places (M, 3) in m, and once they are known velocities in m/s and accelerations in m/s^2.
    pub motion(self) -> &[[f64; 3]] = &self.motion;
}
