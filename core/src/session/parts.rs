//! Parts of a batch's output for the workers.

use alloc::vec::Vec;
use core::ops::Range;

use num_complex::Complex32;

use crate::problem::Solution;
use crate::session::batch::Outcome;

/// Where the solutions of some problems in a row are written.
pub(super) struct Part<'a> {
    /// The first problem's index in the batch.
    pub(super) first: usize,
    drives: &'a mut [Complex32],
    pressures: &'a mut [Complex32],
    outcomes: &'a mut [Outcome],
}

impl Part<'_> {
    /// Number of problems.
    pub(super) fn len(&self) -> usize {
        self.outcomes.len()
    }

    /// Leaves the part's problems from `k` on silent.
    pub(super) fn silence(&mut self, k: usize) {
        let transducers = self.drives.len() / self.len();
        self.drives[k * transducers..].fill(Complex32::ZERO);
    }

    /// Keeps the solution of the part's problem `k`.
    pub(super) fn keep(&mut self, k: usize, solution: &Solution, outcome: Outcome) {
        let (transducers, points) = (solution.drive.len(), solution.pressures.len());
        self.drives[k * transducers..(k + 1) * transducers].copy_from_slice(&solution.drive);
        self.pressures[k * points..(k + 1) * points].copy_from_slice(&solution.pressures);
        self.outcomes[k] = outcome;
    }
}

/// Parts of the whole batch's drives, pressures and outcomes: those of problems `range`, `share` problems a part.
pub(super) fn parts<'a>(
    (drives, pressures, outcomes): (&'a mut [Complex32], &'a mut [Complex32], &'a mut [Outcome]),
    range: Range<usize>,
    share: usize,
) -> Vec<Part<'a>> {
    let (start, end, count) = (range.start, range.end, outcomes.len());
    let (transducers, points) = (drives.len() / count, pressures.len() / count);
    drives[start * transducers..end * transducers]
        .chunks_mut(share * transducers)
        .zip(pressures[start * points..end * points].chunks_mut(share * points))
        .zip(outcomes[range].chunks_mut(share))
        .enumerate()
        .map(|(k, ((drives, pressures), outcomes))| Part { first: start + k * share, drives, pressures, outcomes })
        .collect()
}
