//! Parts of the output of a batch, one for each worker.

use crate::session::batch::Outcome;
use crate::solvers::prelude::*;

/// Where the solutions of consecutive problems are written.
pub(super) struct Part<'a> {
    /// The index of the first problem in the batch.
    pub(super) first: usize,
    drives: &'a mut [Complex32],
    pressures: &'a mut [Complex32],
    outcomes: &'a mut [Outcome],
}

impl Part<'_> {
    /// The number of problems.
    pub(super) fn len(&self) -> usize {
        self.outcomes.len()
    }

    /// Sets the drives of the part's problems from `k` on to 0.
    pub(super) fn silence(&mut self, k: usize) {
        let transducers = self.drives.len() / self.len();
        self.drives[k * transducers..].fill(Complex32::ZERO);
    }

    /// Stores the solution of the part's problem `k`.
    pub(super) fn keep(&mut self, k: usize, solution: &Solution, outcome: Outcome) {
        let (transducers, points) = (solution.drive.len(), solution.pressures.len());
        self.drives[k * transducers..(k + 1) * transducers].copy_from_slice(&solution.drive);
        self.pressures[k * points..(k + 1) * points].copy_from_slice(&solution.pressures);
        self.outcomes[k] = outcome;
    }
}

/// Splits the drives, pressures and outcomes of the problems `range` into parts of `share` problems.
pub(super) fn parts<'a>(
    drives: &'a mut [Complex32],
    pressures: &'a mut [Complex32],
    outcomes: &'a mut [Outcome],
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
