//! Many problems at once: each as if it were alone, over all threads.

use alloc::boxed::Box;
use alloc::format;
use alloc::vec;
use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::Error;
use crate::problem::metrics::Metrics;
use crate::problem::solution::{Solution, Status};
use crate::problem::{Aim, Problem, Start};
use crate::propagation::Model;
use crate::scene::Request;
use crate::solvers::common::interleaved;
use crate::solvers::{Solve, solve, solve_together};
use crate::workspace::Workspace;

/// Problems that a thread makes and solves together.
const TOGETHER: usize = 16;

/// Entries of G that a thread goes through between two calls of the control: some 100 us of `fast`, many times what it
/// costs to wake a thread.
const STRETCH: usize = 1 << 17;

/// What one problem of a batch asks for.
#[derive(Clone, Debug, Default)]
#[allow(clippy::exhaustive_structs, reason = "what a session is asked, in one piece")]
pub struct Ask {
    /// Points (M, 3) in m.
    pub points: Vec<[f64; 3]>,
    /// Pressures and weights.
    pub request: Request,
    /// Where an iterative method begins.
    pub start: Option<Start>,
    /// The level that a method that uses one aims at.
    pub aim: Option<Aim>,
}

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

/// What a thread keeps from problem to problem.
#[derive(Default)]
struct Worker {
    ask: Ask,
    problems: Vec<Problem>,
    work: Workspace,
}

/// What all problems of a batch share.
struct Task<'a> {
    model: &'a Model,
    points: usize,
    ask: &'a (dyn Fn(usize, &mut Ask) -> Result<(), Error> + Sync),
    solver: &'a (dyn Solve + Sync),
    balance: bool,
}

/// Solves B = `count` problems of one array, of M = `points` points each. `ask` is called with a problem's index and
/// writes down what that problem asks for, over what an earlier one did; its drive is then written into its row of
/// `drives` (B, N). Each is bit for bit what [`solve`] makes of it alone, whatever the number of threads. Memory: the
/// output, and a workspace and 16 problems a thread; where all weights are above 0 and `ask` writes into the memory it
/// is given, a further problem allocates nothing.
///
/// `control` is called after every few problems (its residual is the mean so far); once it says stop, the
/// problems not yet begun keep a drive of 0 and the status [`Status::Stopped`].
///
/// # Errors
/// `drives` of another length; the first problem that is refused or asks for another number of points, named by its
/// index.
///
/// ```
/// use midair::{Array, Ask, Complex32, Control, InstructionSet, Medium, Model, solve_batch, solvers};
///
/// let model = Model::new(&Array::preset("paper20", [1, 1])?, Medium::default(), InstructionSet::best())?;
/// let mut drives = vec![Complex32::ZERO; 100 * 400];
/// let ask = |k: usize, ask: &mut Ask| {
///     ask.points.clear();
///     ask.points.extend([[0.0, 0.0, 0.15], [1e-3 * k as f64, 0.05, 0.15]]);
///     Ok(())
/// };
/// let fast = solvers::Fast::default();
/// let batch = solve_batch(&model, 100, 2, &ask, &fast, true, &mut drives, &mut Control::none())?;
/// assert!(batch.metrics.iter().all(|metrics| metrics.accuracy > 0.8));
/// # Ok::<(), midair::Error>(())
/// ```
#[allow(clippy::too_many_arguments, reason = "what a session is asked, and how many times")]
pub fn solve_batch(
    model: &Model,
    count: usize,
    points: usize,
    ask: &(dyn Fn(usize, &mut Ask) -> Result<(), Error> + Sync),
    solver: &(dyn Solve + Sync),
    balance: bool,
    drives: &mut [Complex32],
    control: &mut Control,
) -> Result<Batch, Error> {
    if count == 0 || points == 0 {
        return Err(Error::invalid("batch", count, "give at least one problem and one point"));
    }
    let transducers = model.array().len();
    if drives.len() != count * transducers {
        let cure = format!("give {count} times {transducers}");
        return Err(Error::invalid("drives", format!("{} values", drives.len()), cure));
    }
    let mut batch = Batch {
        pressures: vec![Complex32::ZERO; count * points],
        metrics: vec![Metrics::of(core::iter::empty()); count],
        scale: vec![1.0; count],
        status: vec![Status::Stopped; count],
        steps: vec![0; count],
    };
    let task = Task { model, points, ask, solver, balance };
    let mut workers: Vec<Worker> = (0..threads()).map(|_| Worker::default()).collect();
    let share = TOGETHER * (STRETCH / (TOGETHER * transducers * points)).max(1);
    let mut done = 0;
    while done < count {
        let end = count.min(done + share * workers.len());
        let parts = parts(&mut batch, drives, done..end, share);
        each(parts, &mut workers, &|part, worker| worker.run(part, &task))?;
        done = end;
        let mean = || batch.metrics[..done].iter().map(|metrics| metrics.residual).sum::<f64>() / done as f64;
        if control.step(done, count, mean).is_break() {
            drives[done * transducers..].fill(Complex32::ZERO);
            break;
        }
    }
    Ok(batch)
}

/// The places of some problems, `share` a part.
fn parts<'a>(
    batch: &'a mut Batch,
    drives: &'a mut [Complex32],
    range: core::ops::Range<usize>,
    share: usize,
) -> Vec<Part<'a>> {
    let (start, end) = (range.start, range.end);
    let count = batch.metrics.len();
    let (transducers, points) = (drives.len() / count, batch.pressures.len() / count);
    let lists = drives[start * transducers..end * transducers]
        .chunks_mut(share * transducers)
        .zip(batch.pressures[start * points..end * points].chunks_mut(share * points))
        .zip(batch.metrics[range.clone()].chunks_mut(share))
        .zip(batch.scale[range.clone()].chunks_mut(share))
        .zip(batch.status[range.clone()].chunks_mut(share))
        .zip(batch.steps[range].chunks_mut(share));
    lists
        .enumerate()
        .map(|(k, (((((drives, pressures), metrics), scale), status), steps))| Part {
            first: start + k * share,
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
    fn keep(&mut self, k: usize, solution: &Solution) {
        let (transducers, points) = (solution.drive.len(), solution.pressures.len());
        self.drives[k * transducers..(k + 1) * transducers].copy_from_slice(&solution.drive);
        self.pressures[k * points..(k + 1) * points].copy_from_slice(&solution.pressures);
        self.metrics[k] = solution.metrics();
        self.scale[k] = solution.scale;
        self.status[k] = solution.status;
        self.steps[k] = solution.steps;
    }
}

impl Worker {
    /// Makes and solves the problems of a part.
    fn run(&mut self, mut part: Part<'_>, task: &Task<'_>) -> Result<(), Error> {
        let first = part.first;
        let mut done = 0;
        while done < part.metrics.len() {
            let end = part.metrics.len().min(done + TOGETHER);
            self.some(&mut part, done..end, task)
                .map_err(|(index, error)| Error::InBatch { index: first + index, error: Box::new(error) })?;
            done = end;
        }
        Ok(())
    }

    /// Makes and solves problems `range` of a part; the error has the number of the problem in the part.
    fn some(
        &mut self,
        part: &mut Part<'_>,
        range: core::ops::Range<usize>,
        task: &Task<'_>,
    ) -> Result<(), (usize, Error)> {
        let start = range.start;
        // Those before one that is refused here may be refused later on, and are the first then.
        let (mut count, mut refused) = (range.len(), Ok(()));
        for k in 0..range.len() {
            if let Err(error) = self.place(k, part.first + start + k, task) {
                (count, refused) = (k, Err((start + k, error)));
                break;
            }
        }
        let together = interleaved::measure(&mut self.problems[..count], &mut self.work);
        for (k, problem) in self.problems[..count].iter_mut().enumerate() {
            let measured = if together { Ok(()) } else { problem.measure() };
            if let Err(error) = measured.and_then(|()| problem.level()) {
                (count, refused) = (k, Err((start + k, error)));
                break;
            }
        }
        let problems = &self.problems[..count];
        if let Some(solutions) = solve_together(problems, task.solver, task.balance, &mut self.work) {
            for (k, solution) in solutions.into_iter().enumerate() {
                part.keep(start + k, &solution);
                self.work.recycle(solution);
            }
            return refused;
        }
        for (k, problem) in problems.iter().enumerate() {
            let solution = solve(problem, task.solver, task.balance, &mut self.work, &mut Control::none())
                .map_err(|error| (start + k, error))?;
            part.keep(start + k, &solution);
            self.work.recycle(solution);
        }
        refused
    }

    /// Asks what problem `index` is and writes it over the worker's problem `k`.
    fn place(&mut self, k: usize, index: usize, task: &Task<'_>) -> Result<(), Error> {
        (task.ask)(index, &mut self.ask)?;
        let Ask { points, request, start, aim } = &mut self.ask;
        if points.len() != task.points {
            let cure = format!("give {} as all problems of the batch have", task.points);
            return Err(Error::invalid("points", format!("{} of them", points.len()), cure));
        }
        if k == self.problems.len() {
            self.problems.push(Problem::of(task.model.propagation(points)?));
        }
        let problem = &mut self.problems[k];
        problem.place(points, request)?;
        problem.aim_at(*aim);
        start.take().map_or(Ok(()), |start| problem.begin(start))
    }
}

#[cfg(feature = "parallel")]
fn threads() -> usize {
    rayon::current_num_threads()
}

#[cfg(not(feature = "parallel"))]
fn threads() -> usize {
    1
}

type Run<'a> = &'a (dyn Fn(Part<'_>, &mut Worker) -> Result<(), Error> + Sync);

/// Every part in the hands of a worker; the first error by index.
#[cfg(feature = "parallel")]
fn each(parts: Vec<Part<'_>>, workers: &mut [Worker], run: Run<'_>) -> Result<(), Error> {
    use rayon::prelude::*;
    // For one part no other thread need wake up.
    if parts.len() == 1 {
        return in_turn(parts, workers, run);
    }
    let pairs = parts.into_par_iter().zip(workers.par_iter_mut());
    pairs.map(|(part, worker)| run(part, worker)).collect::<Vec<_>>().into_iter().collect()
}

#[cfg(not(feature = "parallel"))]
fn each(parts: Vec<Part<'_>>, workers: &mut [Worker], run: Run<'_>) -> Result<(), Error> {
    in_turn(parts, workers, run)
}

fn in_turn(parts: Vec<Part<'_>>, workers: &mut [Worker], run: Run<'_>) -> Result<(), Error> {
    parts.into_iter().zip(workers).try_for_each(|(part, worker)| run(part, worker))
}
