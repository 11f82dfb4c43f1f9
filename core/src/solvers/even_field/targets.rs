//! Fields that meet their targets, for points too many or too crowded for an even field at the highest level in time.

use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::Error;
use crate::problem::{Problem, Status};
use crate::scene::Aim;
use crate::solvers::common::least_squares::{LeastSquares, Task, least_squares};
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::even::{MOST_STEPS, Manner, polish};
use crate::solvers::even_field::race::{NEARLY, Search};
use crate::solvers::even_field::run::{Plan, QUIET, Run};
use crate::solvers::even_field::silence::Silence;
use crate::workspace::Workspace;

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
    let mut drive = nearest_to(run, 1.0)?.drive;
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

/// Returns the drive of least error at `part` times the targets, or times the balanced level if the targets are below it.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn nearest_to(run: &mut Run, part: f32) -> Result<LeastSquares, Error> {
    let factor = part * run.problem.balance().max(1.0) as f32;
    // The level of a disc of points can be raised to a tenth more after a short descent than after a long one.
    let (steps, tolerance) = if run.problem.aim() == Aim::Max { (300, 1e-3) } else { (1500, 3e-4) };
    let task = Task { steps, tolerance, starts: 2, seed: 0, factor, before: run.step };
    let nearest = least_squares(run.problem, &task, run.work, run.control)?;
    (run.step, run.steps) = (nearest.steps.0, run.steps.max(nearest.steps.1));
    run.stopped |= nearest.status == Status::Stopped;
    Ok(nearest)
}
