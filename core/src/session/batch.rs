//! Batch: the results of many problems: pressures, metrics, scale, status and steps of each.

use core::cmp::Reverse;

use crate::problem::Metrics;
use crate::solvers::prelude::*;
use crate::solvers::remark::{KINDS, Remark};

/// The results of [`crate::Session::solve_batch`] besides the drives, for B problems of M points.
#[derive(Clone, Debug, PartialEq)]
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
    pub(super) fn of(pressures: Vec<Complex32>, outcomes: &[Outcome], tally: &Tally) -> Self {
        Self {
            pressures,
            metrics: outcomes.iter().map(|outcome| outcome.metrics).collect(),
            scale: outcomes.iter().map(|outcome| outcome.scale).collect(),
            status: outcomes.iter().map(|outcome| outcome.status).collect(),
            steps: outcomes.iter().map(|outcome| outcome.steps).collect(),
            beyond: outcomes.iter().map(|outcome| outcome.beyond).collect(),
            weak: outcomes.iter().map(|outcome| outcome.weak).collect(),
            remarks: tally.lines(outcomes.len()),
        }
    }
}

/// For each kind of remark, the number of problems that have it, and the worst remark with the index of its problem.
#[derive(Clone, Copy, Default)]
pub(super) struct Tally([(usize, Option<(usize, Remark)>); KINDS]);

impl Tally {
    /// Counts the remarks about a problem.
    pub(super) fn add(&mut self, index: usize, remarks: &[Option<Remark>; KINDS]) {
        self.merge(&Self(remarks.map(|remark| (usize::from(remark.is_some()), remark.map(|remark| (index, remark))))));
    }

    /// Adds the counts of other problems. Of equally bad problems the one of lower index stays.
    pub(super) fn merge(&mut self, other: &Self) {
        let order = |(index, remark): &(usize, Remark)| (remark.severity(), Reverse(*index));
        for ((count, worst), (others, other)) in self.0.iter_mut().zip(&other.0) {
            *count += others;
            if other.as_ref().is_some_and(|other| worst.as_ref().is_none_or(|worst| order(worst) < order(other))) {
                *worst = *other;
            }
        }
    }

    /// Returns one line for each kind of remark.
    fn lines(&self, problems: usize) -> Vec<String> {
        let line = |&(count, worst): &(usize, Option<(usize, Remark)>)| {
            let (index, remark) = worst?;
            Some(format!("in {count} of {problems} problems, worst in problems[{index}]: {remark}"))
        };
        self.0.iter().filter_map(line).collect()
    }
}

/// The results of one problem.
#[derive(Clone, Copy)]
pub(super) struct Outcome {
    pub(super) metrics: Metrics,
    scale: f64,
    status: Status,
    steps: usize,
    beyond: bool,
    weak: bool,
}

impl Default for Outcome {
    /// The result of a problem that was not solved: the all-zero drive.
    fn default() -> Self {
        let metrics = Metrics { residual: 1.0, ..Metrics::default() };
        Self { metrics, scale: 1.0, status: Status::Stopped, steps: 0, beyond: false, weak: false }
    }
}

impl Outcome {
    pub(super) fn of(solution: &Solution, remarks: &[Option<Remark>]) -> Self {
        let has = |kind: fn(&Remark) -> bool| remarks.iter().flatten().any(kind);
        Self {
            metrics: solution.metrics(),
            scale: solution.scale,
            status: solution.status,
            steps: solution.steps,
            beyond: has(|remark| matches!(remark, Remark::Beyond(_))),
            weak: has(|remark| matches!(remark, Remark::Weak(_))),
        }
    }
}
