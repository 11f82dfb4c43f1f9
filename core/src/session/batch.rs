//! What comes out of a batch: pressures, metrics, scale, status and steps of each problem.

use alloc::vec::Vec;

use num_complex::Complex32;

use crate::problem::{Metrics, Solution, Status};

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
    /// The problems' pressures, and how each ended.
    pub(super) fn of(pressures: Vec<Complex32>, outcomes: &[Outcome]) -> Self {
        Self {
            pressures,
            metrics: outcomes.iter().map(|outcome| outcome.metrics).collect(),
            scale: outcomes.iter().map(|outcome| outcome.scale).collect(),
            status: outcomes.iter().map(|outcome| outcome.status).collect(),
            steps: outcomes.iter().map(|outcome| outcome.steps).collect(),
        }
    }
}

/// How a problem ended.
#[derive(Clone, Copy)]
pub(super) struct Outcome {
    pub(super) metrics: Metrics,
    scale: f64,
    status: Status,
    steps: usize,
}

impl Default for Outcome {
    /// Not begun.
    fn default() -> Self {
        Self { metrics: Metrics::default(), scale: 1.0, status: Status::Stopped, steps: 0 }
    }
}

impl Outcome {
    pub(super) fn of(solution: &Solution) -> Self {
        Self { metrics: solution.metrics(), scale: solution.scale, status: solution.status, steps: solution.steps }
    }
}
