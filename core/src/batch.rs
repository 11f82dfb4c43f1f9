//! Many problems at once: each as if it were alone, over all threads.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::Error;
use crate::metrics::Metrics;
use crate::problem::Problem;
use crate::solution::{Solution, Status};
use crate::solvers::{Solve, solve, solve_together};
use crate::workspace::Workspace;

/// Problems that a thread solves between two calls of the control.
const TOGETHER: usize = 16;

/// What comes out of [`solve_batch`] beside the drives, for B problems of M points.
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

/// A part of the batch: some problems' places in the output.
struct Part<'a> {
    first: usize,
    drives: &'a mut [Complex32],
    pressures: &'a mut [Complex32],
    metrics: &'a mut [Metrics],
    scale: &'a mut [f64],
    status: &'a mut [Status],
    steps: &'a mut [usize],
}

/// Solves B problems of N transducers and M points each; problem k is made when its turn comes, and its drive is
/// written into row k of `drives` (B, N). Each is bit for bit what [`solve`] makes of it alone, whatever the number
/// of threads. Memory: the output, and a workspace and 16 problems a thread.
///
/// `control` is called after every few problems (its residual is the mean so far); once it says stop, the
/// problems not yet begun keep a drive of 0 and the status [`Status::Stopped`].
///
/// # Errors
/// The first problem that is refused, named by its index. `drives` whose length is no multiple of B, a problem of
/// other sizes than the first.
pub fn solve_batch(
    count: usize,
    points: usize,
    problem: &(dyn Fn(usize) -> Result<Problem, Error> + Sync),
    solver: &(dyn Solve + Sync),
    balance: bool,
    drives: &mut [Complex32],
    control: &mut Control,
) -> Result<Batch, Error> {
    let mut batch = Batch {
        pressures: vec![Complex32::ZERO; count * points],
        metrics: vec![Metrics::of(core::iter::empty()); count],
        scale: vec![1.0; count],
        status: vec![Status::Stopped; count],
        steps: vec![0; count],
    };
    if count == 0 || points == 0 || !drives.len().is_multiple_of(count) {
        return Err(Error::invalid("batch", count, "give at least one problem, point and transducer"));
    }
    let transducers = drives.len() / count;
    let mut spaces: Vec<Workspace> = (0..threads()).map(|_| Workspace::new()).collect();
    let stretch = TOGETHER * spaces.len();
    let mut done = 0;
    while done < count {
        let end = count.min(done + stretch);
        let parts = parts(&mut batch, drives, done..end, transducers, points);
        let run =
            |(mut part, work): (Part<'_>, &mut Workspace)| some(&mut part, problem, solver, balance, work);
        each(parts, &mut spaces, &run)?;
        done = end;
        let mean = || batch.metrics[..done].iter().map(|metrics| metrics.residual).sum::<f64>() / done as f64;
        if control.step(done, count, mean).is_break() {
            break;
        }
    }
    Ok(batch)
}

/// The places of some problems, [`TOGETHER`] a part.
fn parts<'a>(
    batch: &'a mut Batch,
    drives: &'a mut [Complex32],
    range: core::ops::Range<usize>,
    transducers: usize,
    points: usize,
) -> Vec<Part<'a>> {
    let (start, end) = (range.start, range.end);
    let lists = drives[start * transducers..end * transducers]
        .chunks_mut(TOGETHER * transducers)
        .zip(batch.pressures[start * points..end * points].chunks_mut(TOGETHER * points))
        .zip(batch.metrics[range.clone()].chunks_mut(TOGETHER))
        .zip(batch.scale[range.clone()].chunks_mut(TOGETHER))
        .zip(batch.status[range.clone()].chunks_mut(TOGETHER))
        .zip(batch.steps[range].chunks_mut(TOGETHER));
    lists
        .enumerate()
        .map(|(k, (((((drives, pressures), metrics), scale), status), steps))| Part {
            first: start + k * TOGETHER,
            drives,
            pressures,
            metrics,
            scale,
            status,
            steps,
        })
        .collect()
}

impl Part<'_> {
    /// Keeps the solution of the part's problem `k`.
    fn keep(&mut self, k: usize, solution: Solution, work: &mut Workspace) -> Result<(), Error> {
        let count = self.metrics.len();
        let (transducers, points) = (self.drives.len() / count, self.pressures.len() / count);
        if solution.drive.len() != transducers || solution.pressures.len() != points {
            let item = alloc::format!("problems[{}]", self.first + k);
            let value = alloc::format!("of {} points", solution.pressures.len());
            return Err(Error::invalid(item, value, "give equal sizes"));
        }
        self.drives[k * transducers..(k + 1) * transducers].copy_from_slice(&solution.drive);
        self.pressures[k * points..(k + 1) * points].copy_from_slice(&solution.pressures);
        self.metrics[k] = solution.metrics();
        self.scale[k] = solution.scale;
        self.status[k] = solution.status;
        self.steps[k] = solution.steps;
        work.recycle(solution);
        Ok(())
    }
}

/// Makes and solves the problems of a part.
fn some(
    part: &mut Part<'_>,
    problem: &dyn Fn(usize) -> Result<Problem, Error>,
    solver: &dyn Solve,
    balance: bool,
    work: &mut Workspace,
) -> Result<(), Error> {
    let first = part.first;
    let named = |k: usize, error| Error::InBatch { index: first + k, error: Box::new(error) };
    let mut made = Ok(());
    let problems: Vec<Problem> = (0..part.metrics.len())
        .map_while(|k| problem(first + k).map_err(|error| made = Err(named(k, error))).ok())
        .collect();
    if let Some(solutions) = solve_together(&problems, solver, balance, work) {
        for (k, solution) in solutions.into_iter().enumerate() {
            part.keep(k, solution, work)?;
        }
        return made;
    }
    for (k, problem) in problems.iter().enumerate() {
        let solution = solve(problem, solver, balance, work, &mut Control::none());
        part.keep(k, solution.map_err(|error| named(k, error))?, work)?;
    }
    // Those before the one that could not be made were to be refused first.
    made
}

#[cfg(feature = "parallel")]
fn threads() -> usize {
    rayon::current_num_threads()
}

#[cfg(not(feature = "parallel"))]
fn threads() -> usize {
    1
}

type Run<'a> = &'a (dyn Fn((Part<'_>, &mut Workspace)) -> Result<(), Error> + Sync);

/// Runs every part in a workspace of its own; the first error by index.
#[cfg(feature = "parallel")]
fn each(parts: Vec<Part<'_>>, spaces: &mut [Workspace], run: Run<'_>) -> Result<(), Error> {
    use rayon::prelude::*;
    let pairs = parts.into_par_iter().zip(spaces.par_iter_mut());
    pairs.map(run).collect::<Vec<_>>().into_iter().collect()
}

#[cfg(not(feature = "parallel"))]
fn each(parts: Vec<Part<'_>>, spaces: &mut [Workspace], run: Run<'_>) -> Result<(), Error> {
    parts.into_iter().zip(spaces).try_for_each(run)
}
