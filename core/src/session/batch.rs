//! Batch: the results of many problems: pressures, metrics, scale, status and steps of each.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use num_complex::Complex32;

use crate::problem::{Metrics, Problem, Solution, Status};
use crate::solvers::method::Solve;
use crate::solvers::remark::{Remark, harmonic, weak_part};

/// The results of [`crate::Session::solve_batch`] besides the drives, for B problems of M points.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "a binding stores the lists and makes the batch from them")]
pub struct Batch {
    /// Complex pressures (B, M) in Pa (peak).
    pub pressures: Vec<Complex32>,
    /// The metrics of each problem (B,).
    pub metrics: Vec<Metrics>,
    /// The factor (B,) that supply or modulation must apply to each drive, see [`crate::Solution::scale`].
    pub scale: Vec<f64>,
    /// The status of each problem (B,).
    pub status: Vec<Status>,
    /// The number of steps of each problem (B,).
    pub steps: Vec<usize>,
    /// Whether a target of each problem exceeds the pressure that the array can give there (B,).
    pub beyond: Vec<bool>,
    /// Whether each problem was solved without balancing although its targets are below half the balanced level (B,).
    pub weak: Vec<bool>,
    /// Warnings about the solutions: one line for each kind, with the number of problems.
    pub remarks: Vec<String>,
}

impl Batch {
    /// Collects the results of all problems.
    pub(super) fn of(pressures: Vec<Complex32>, outcomes: &[Outcome]) -> Self {
        Self {
            pressures,
            metrics: outcomes.iter().map(|outcome| outcome.metrics).collect(),
            scale: outcomes.iter().map(|outcome| outcome.scale).collect(),
            status: outcomes.iter().map(|outcome| outcome.status).collect(),
            steps: outcomes.iter().map(|outcome| outcome.steps).collect(),
            beyond: outcomes.iter().map(|outcome| outcome.excess > 0.0).collect(),
            weak: outcomes.iter().map(|outcome| outcome.weak < 1.0).collect(),
            remarks: remarks(outcomes),
        }
    }
}

/// Returns the warnings, one line for each kind of warning, with the number of problems and the worst problem.
fn remarks(outcomes: &[Outcome]) -> Vec<String> {
    let worst = |badness: fn(&Outcome) -> f64| {
        let bad = outcomes.iter().map(badness).enumerate().filter(|(_, badness)| *badness > 1.0);
        let (worst, _) = bad.clone().reduce(|most, next| if next.1 > most.1 { next } else { most })?;
        Some((format!("in {} of {} problems", bad.count(), outcomes.len()), worst))
    };
    let beyond = worst(|outcome| outcome.excess).map(|(many, k)| {
        let excess = outcomes[k].excess;
        format!("{many} a pressure is beyond reach, in problems[{k}] {excess:.2} times what the array gives there: reach() of a Scene tells what it can do")
    });
    let missed = worst(|outcome| f64::from(outcome.missed > 0.0) + outcome.missed)
        .map(|(many, k)| format!("{many} targets are missed; problems[{k}]: {}", Remark::Missed(outcomes[k].missed)));
    let weak = worst(|outcome| 1.0 / outcome.weak)
        .map(|(many, k)| format!("{many} targets are weak; problems[{k}]: {}", Remark::Weak(outcomes[k].weak)));
    let scaled = worst(|outcome| 1.0 / outcome.scale).map(|(many, k)| {
        let scale = outcomes[k].scale;
        format!("{many} the device has no such amplitude: scale the drives by supply or modulation, those of problems[{k}] by {scale:.4} (batch.scale)")
    });
    let harmonic = worst(|outcome| outcome.harmonic.map_or(0.0, |(share, _)| 1.0 + share)).and_then(|(many, k)| {
        let (share, pressure) = outcomes[k].harmonic?;
        Some(format!("{many} harmonics count; problems[{k}]: {}", Remark::Harmonic { share, pressure }))
    });
    let unused = outcomes.iter().filter(|outcome| outcome.phases_unused).count();
    let unused = (unused > 0).then(|| format!("in {unused} of {} problems {}", outcomes.len(), Remark::PhasesUnused));
    [beyond, missed, weak, unused, scaled, harmonic].into_iter().flatten().collect()
}

/// The results of one problem.
#[derive(Clone, Copy)]
pub(super) struct Outcome {
    pub(super) metrics: Metrics,
    scale: f64,
    status: Status,
    steps: usize,
    /// The largest ratio of a target to its reach, if it is above 1; else 0.
    excess: f64,
    /// The relative error of the pressures, if the targets are reported as missed; else 0.
    missed: f64,
    /// The level of weak targets as a part of the balanced level; 1 if they are not weak.
    weak: f64,
    /// Whether the targets have phases that the solver ignores.
    phases_unused: bool,
    /// The share of the second harmonic and |p| in Pa, if the share is large.
    harmonic: Option<(f64, f64)>,
}

impl Default for Outcome {
    /// The result of a problem that was not solved: the all-zero drive.
    fn default() -> Self {
        let metrics = Metrics { residual: 1.0, ..Metrics::default() };
        let (scale, status, steps, phases_unused, harmonic) = (1.0, Status::Stopped, 0, false, None);
        Self { metrics, scale, status, steps, excess: 0.0, missed: 0.0, weak: 1.0, phases_unused, harmonic }
    }
}

impl Outcome {
    pub(super) fn of(problem: &Problem, solver: &dyn Solve, balance: bool, solution: &Solution) -> Self {
        Self {
            metrics: solution.metrics(),
            scale: solution.scale,
            status: solution.status,
            steps: solution.steps,
            excess: problem.excess(),
            missed: problem.missed(solver.meets_targets(), solver.quiet(), solution).unwrap_or(0.0),
            weak: weak_part(problem, solver, balance).unwrap_or(1.0),
            phases_unused: Remark::phases_unused(problem, solver).is_some(),
            harmonic: harmonic(problem, solution),
        }
    }
}
