//! Nearest: the drive whose field is nearest to the targets, where points cannot be even or miss their targets.
//!
//! 1. *Phases* of least squares ([`least_squares`]) at the balanced level, or at the targets if these are higher: all
//!    power goes to the targets.
//! 2. *Meet* the targets by Gauss-Newton steps if all are nearly met ([`met`]).
//! 3. *Phases and amplitudes* at the targets ([`with_amplitudes`]), if these are not met and the board has amplitudes.
//!    Below the balanced level separate amplitudes are a freedom that one common amplitude does not use.
//!
//! Crowded points start the search of an even field from such a drive, too ([`approach`]).

use crate::device::quantization::Quantization;
use crate::prelude::*;
use crate::problem::{Problem, Solution, Status};
use crate::scene::Aim;
use crate::solvers::common::least_squares::{LeastSquares, Task, least_squares, with_amplitudes};
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::even::{MOST_STEPS, Manner, polish};
use crate::solvers::even_field::quiet::Silence;
use crate::solvers::even_field::race::{NEARLY, Search};
use crate::solvers::even_field::run::{Plan, QUIET, Run};
use crate::workspace::Workspace;

/// A problem of more points than this is a picture: an even field of them would take seconds.
const PICTURE: usize = 400;

/// A problem of more points than this is a picture if targets differ: an even field would be far below the targets.
const UNLIKE: usize = 150;

/// A picture has at least this many points with a target; fewer are a few points in a quiet zone.
const LIT: usize = 32;

/// Number of steps for points of equal targets. Their error continues to fall when that of a picture would no longer
/// fall.
const STEPS_ALIKE: usize = 1500;

/// A board with fewer amplitudes than this plays all transducers at one common amplitude.
const AMPLITUDES: usize = 16;

/// An even solution is replaced only by one whose error is at most this part of its error.
const MUCH: f64 = 0.33;

/// A new error must be below this part of the old: rounding decides smaller gains.
const BETTER: f64 = 0.999;

/// An error below this needs no free amplitudes.
const MET: f64 = 1e-3;

/// Limits of the usual search.
pub(super) const USUAL: Task = Task { steps: 500, tolerance: 5e-4, starts: 3, seed: 0, factor: 1.0, before: 0 };

/// Returns whether all targets are equal.
fn alike(problem: &Problem) -> bool {
    problem.targets()[..problem.propagation().points()].windows(2).all(|pair| pair[0] == pair[1])
}

/// Returns whether a problem is a picture with targets to be met: for so many points no even field is searched.
pub(super) fn is_picture(problem: &Problem) -> bool {
    let points = problem.propagation().points();
    let lit = problem.targets().iter().filter(|&&target| target > 0.0).count();
    let many = points > PICTURE || points > UNLIKE && !alike(problem);
    many && lit >= LIT && problem.aim() == Aim::Target && !problem.has_start()
}

/// Returns the limits of the search for a picture.
pub(super) fn for_picture(problem: &Problem) -> Task {
    Task { steps: if alike(problem) { STEPS_ALIKE } else { USUAL.steps }, ..USUAL }
}

/// Returns the drive nearest to the targets.
///
/// # Errors
/// More memory than allowed is needed, or a stop came before the first drive.
pub(crate) fn nearest(
    problem: &Problem,
    task: Task,
    work: &Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    let factor = problem.balance().max(1.0) as f32;
    let LeastSquares { mut drive, mut status, steps } =
        least_squares(problem, &Task { factor, ..task }, work, control)?;
    if status != Status::Stopped
        && let Some(even) = met(problem, &drive, factor, steps, work, control)?
    {
        work.complexes.give(core::mem::replace(&mut drive, even));
        status = Status::Done;
    }
    let amplitude = 1.0 / f64::from(factor);
    let few = problem.quantization().filter(|_| !has_amplitudes(problem));
    let (amplitude, scale) = few.map_or((amplitude, 1.0), |board| board.lowered(amplitude));
    for q in &mut drive {
        *q *= amplitude as f32;
    }
    if status == Status::Stopped || !has_amplitudes(problem) {
        return Ok(Solution::new(problem, drive, (status, steps.0), steps.1, work, control)?.scaled(scale));
    }
    let alone = Solution::new(problem, drive, (status, steps.0), steps.1, work, control)?;
    if alone.status == Status::Stopped || problem.miss(&alone, 0.0) <= MET {
        return Ok(alone);
    }
    let LeastSquares { drive, status, steps } = with_amplitudes(problem, &alone.drive, steps, work, control)?;
    let both = Solution::new(problem, drive, (status, steps.0), steps.1, work, control)?;
    nearer(problem, 0.0, [alone, both], true, work, control)
}

/// Returns the second of two solutions, unless the first misses less after a board has rounded both. If the first is
/// even (not `uneven`), the second must meet the targets or be much nearer to them.
///
/// # Errors
/// A stop, if it came before the first solution.
pub(super) fn nearer(
    problem: &Problem,
    quiet: f64,
    [mut first, mut second]: [Solution; 2],
    uneven: bool,
    work: &Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    first.quantize(1.0, work, control)?;
    second.quantize(1.0, work, control)?;
    let misses = [&first, &second].map(|solution| problem.miss(solution, quiet));
    if misses[1] <= BETTER * misses[0] && (uneven || misses[1] <= MUCH * misses[0]) {
        first.recycle(work);
        return Ok(second);
    }
    (first.status, first.steps) = (second.status, second.steps);
    second.recycle(work);
    first.correct(problem, control);
    Ok(first)
}

/// Returns whether each transducer may have an amplitude of its own.
fn has_amplitudes(problem: &Problem) -> bool {
    let table = problem.quantization().and_then(Quantization::amplitudes);
    table.is_none_or(|table| table.len() >= AMPLITUDES)
}

/// The largest relative error of a drive's pressures for which all targets count as reachable from it.
const NEAR: f32 = 0.05;

/// Returns a drive with |q| = 1 near `drive` that meets every target times `factor`, if Gauss-Newton steps find one in
/// time. For reports, `step` is the number of steps done before and `steps` the number of all steps so far.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn met(
    problem: &Problem,
    drive: &[Complex32],
    factor: f32,
    (step, steps): (usize, usize),
    work: &Workspace,
    control: &mut Control,
) -> Result<Option<Vec<Complex32>>, Error> {
    let propagation = problem.propagation();
    let plan = Plan::alone(0, f64::from(NEARLY), QUIET);
    let silence = Silence::of(problem, plan.quiet, work, control)?;
    let rows = &Rows::alike(problem, &silence.points, work, control)?;
    if !silence.enough || rows.equations() > propagation.transducers() {
        return Ok(None);
    }
    let mut run = Run { step, ..Run::new(problem, rows, plan, steps + MOST_STEPS, work, control) };
    let mut wave = Wave::new(rows, work);
    wave.play_at_full(rows, drive.iter().copied());
    let level = rows.target * factor;
    let near = wave.unevenness(rows, level, run.plan.quiet) <= NEAR;
    let met = near && polish(&mut run, Manner::crowded(level), &mut wave)?.even;
    Ok(met.then(|| wave.drives(propagation.transducers(), work)))
}

/// The field nearest to the targets, or to the balanced level if the targets are below it.
pub(super) struct Nearest {
    /// The drive of least squares as it was found.
    pub(super) drive: Vec<Complex32>,
    /// Whether every target is nearly met, so that no other level is searched.
    pub(super) near: bool,
}

/// Computes the drive of least error at the targets and returns it. Its field with |q| = 1 is offered to `search`; if
/// it is nearly even, it is made even first.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn approach<'w>(run: &mut Run<'_, '_, 'w>, search: &mut Search<'w>) -> Result<Nearest, Error> {
    let (problem, rows) = (run.problem, run.rows);
    let factor = problem.balance().max(1.0) as f32;
    // The level of a disc of points can be raised to a tenth more after a short descent than after a long one.
    let (steps, tolerance) = if problem.aim() == Aim::Max { (300, 1e-3) } else { (1500, 3e-4) };
    let task = Task { steps, tolerance, starts: 2, seed: 0, factor, before: run.step };
    let LeastSquares { mut drive, status, steps } = least_squares(problem, &task, run.work, run.control)?;
    (run.step, run.steps) = (steps.0, run.steps.max(steps.1));
    run.stopped |= status == Status::Stopped;
    search.trial.play_at_full(rows, drive.iter().copied());
    let level = search.trial.level(rows);
    let near = search.trial.unevenness(rows, rows.target * factor, run.plan.quiet) <= NEAR;
    if !run.stopped && search.trial.unevenness(rows, level, run.plan.quiet) <= NEAR {
        polish(run, Manner::crowded(level), &mut search.trial)?;
    }
    let even =
        search.trial.unevenness(rows, search.trial.level(rows), run.plan.quiet) <= run.plan.tolerance.max(NEARLY);
    search.offer(rows, even);
    for q in &mut drive {
        *q /= factor;
    }
    Ok(Nearest { drive, near })
}
