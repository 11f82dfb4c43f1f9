//! What comes out of a batch: pressures, metrics, scale, status and steps of each problem.

use alloc::vec;
use alloc::vec::Vec;

use num_complex::Complex32;

use crate::problem::{Metrics, Status};

/// What comes out of [`crate::Session::solve_batch`] beside the drives, for B problems of M points.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Batch {
    /// Complex pressures (B, M) in Pa (peak).
    pub pressures: Vec<Complex32>,
    /// Metrics (B,).
    pub metrics: Vec<Metrics>,
    /// What supply or modulation have to multiply each drive by (B,), see [`crate::Solution::scale`].
    pub scale: Vec<f64>,
    /// How each ended (B,).
    pub status: Vec<Status>,
    /// Steps of each (B,).
    pub steps: Vec<usize>,
}

impl Batch {
    /// `count` problems of `points` points, none of them solved.
    pub(super) fn unsolved(count: usize, points: usize) -> Self {
        Self {
            pressures: vec![Complex32::ZERO; count * points],
            metrics: vec![Metrics::default(); count],
            scale: vec![1.0; count],
            status: vec![Status::Stopped; count],
            steps: vec![0; count],
        }
    }

    /// The mean residual of the first `done` problems.
    pub(super) fn mean_residual(&self, done: usize) -> f64 {
        self.metrics[..done].iter().map(|metrics| metrics.residual).sum::<f64>() / done as f64
    }
}
