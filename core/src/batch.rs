//! Many problems at once: each as if it were alone, over all threads.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::Error;
use crate::metrics::Metrics;
use crate::problem::Problem;
use crate::solution::Status;
use crate::solvers::{Solve, solve};
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
/// of threads. Memory: the output and a workspace a thread.
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
        let run = |(mut part, work): (Part<'_>, &mut Workspace)| {
            some(&mut part, transducers, points, problem, solver, balance, work)
        };
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

fn some(
    part: &mut Part<'_>,
    transducers: usize,
    points: usize,
    problem: &dyn Fn(usize) -> Result<Problem, Error>,
    solver: &dyn Solve,
    balance: bool,
    work: &mut Workspace,
) -> Result<(), Error> {
    let lists = part.drives.chunks_mut(transducers).zip(part.pressures.chunks_mut(points));
    for (k, (drive, pressures)) in lists.enumerate() {
        let index = part.first + k;
        let solution = problem(index)
            .and_then(|problem| solve(&problem, solver, balance, work, &mut Control::none()))
            .map_err(|error| Error::InBatch { index, error: Box::new(error) })?;
        if solution.drive.len() != transducers || solution.pressures.len() != points {
            let value = alloc::format!("of {} points", solution.pressures.len());
            return Err(Error::invalid(alloc::format!("problems[{index}]"), value, "give equal sizes"));
        }
        drive.copy_from_slice(&solution.drive);
        pressures.copy_from_slice(&solution.pressures);
        part.metrics[k] = solution.metrics();
        part.scale[k] = solution.scale;
        part.status[k] = solution.status;
        part.steps[k] = solution.steps;
        work.recycle(solution);
    }
    Ok(())
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
