//! Even fields at the highest common level: starts, sweeps, even, path, grid.
//!
//! 1. *Starts* ([`starts`]): point phases that reinforce each other; `best` has more of them.
//! 2. *Sweeps* ([`sweeps`]): weighted Gerchberg-Saxton with |q| = 1 raises the weakest points.
//! 3. *Even* ([`even`]): the shortest steps to |P_j| = s t_j, the level s free.
//! 4. *Path* ([`path`]): the loudest field from uneven to even, if these steps lost level. For crowded points
//!    ([`Regime`]) it is a [`race`] from several starts. Targets among crowded quiet points ([`quiet`]), and the field of
//!    least squares, have an [`ascent`] instead.
//! 5. *Lift to the target*, if the steps with a free level ended below it.
//! 6. *Stiffen*, if the points are [`traps`].
//! 7. *Grid* ([`grid`]): rounds to the board's phases and amplitudes, and reduces to the targets.
//!
//! If this misses the targets, crowded and quiet points get the drive of least squares ([`nearest`]). Pictures get it
//! without a search for an even field.
//!
//! Rows of G are divided by their targets, so that all points request the same pressure; the quiet points come last.

mod ascent;
mod even;
pub(crate) mod grid;
pub(crate) mod nearest;
pub(crate) mod newton;
mod path;
pub(crate) mod quiet;
mod race;
pub(crate) mod run;
mod starts;
mod sweeps;
pub(crate) mod traps;

use crate::prelude::*;
use crate::problem::{Problem, Solution, Status};
use crate::scene::Aim;
use crate::solvers::common::least_squares::Task;
use crate::solvers::common::tiled::Rows;
use crate::solvers::even_field::ascent::Pace;
use crate::solvers::even_field::even::{MOST_STEPS, Manner};
use crate::solvers::even_field::grid::Answer;
use crate::solvers::even_field::quiet::Silence;
use crate::solvers::even_field::race::{Found, Search};
use crate::solvers::even_field::run::{Plan, Run, TOO_MANY};
use crate::solvers::even_field::starts::Foci;
use crate::workspace::Workspace;

/// Dependence of the points of a scene on each other. It decides which steps make their field even.
#[derive(Clone, Copy, PartialEq)]
enum Regime {
    /// Independent points: the shortest steps to an even field keep the level.
    Separate,
    /// A few targets among crowded quiet points, whose equations are linear: a short ascent from each start.
    Silent,
    /// Points too close to be independent, or too many to be even: the shortest steps would lose the level.
    Crowded,
}

/// Returns the drive that meets the targets or is nearest to them. This is the drive of the even field, unless it
/// misses the targets and another drive is nearer.
///
/// # Errors
/// More memory than allowed is needed, or a stop came before the first drive.
pub(crate) fn meet(
    problem: &Problem,
    plans: &[Plan],
    work: &Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    if nearest::is_picture(problem) {
        return nearest::nearest(problem, nearest::for_picture(problem), work, control);
    }
    let Even { solution, regime, reached } = even(problem, plans, work, control)?;
    let quiet = f64::from(plans[0].quiet);
    let loud = || problem.targets()[..problem.propagation().points()].iter().all(|&target| target > 0.0);
    let leaks = problem.leaks(quiet, &solution).is_some();
    let missed = leaks || problem.missed(Some(quiet), &solution).is_some();
    // For separate points the highest common level is the solution, even if it is below the targets. For other points
    // it is the solution only if it reaches them.
    let highest = loud() && regime == Some(Regime::Separate) || reached && !leaks;
    if highest || !missed || problem.aim() == Aim::Max || solution.status == Status::Stopped {
        return Ok(solution);
    }
    let task = Task { before: solution.steps, ..nearest::USUAL };
    let nearest = nearest::nearest(problem, task, work, control)?;
    let uneven = leaks || matches!(regime, None | Some(Regime::Crowded));
    let mut found = nearest::nearer(problem, quiet, [solution, nearest], uneven, work, control)?;
    if plans.len() == 1 || problem.has_start() || found.status == Status::Stopped {
        return Ok(found);
    }
    // The loudest of several even fields may be farther from targets on a board than that of the first plan alone.
    match meet(problem, &plans[..1], work, control) {
        Ok(first) if problem.miss(&first, quiet) < problem.miss(&found, quiet) => {
            found.recycle(work);
            return Ok(first);
        }
        Ok(first) => {
            if first.status == Status::Stopped {
                found.status = Status::Stopped;
            }
            first.recycle(work);
        }
        Err(error) if error.is_stop() => found.status = Status::Stopped,
        Err(error) => return Err(error),
    }
    Ok(found)
}

/// Returns the best even drive that any of the plans finds, at the level that the problem aims at.
///
/// # Errors
/// More memory than allowed is needed, or a stop came before the first drive.
pub(crate) fn solve(
    problem: &Problem,
    plans: &[Plan],
    work: &Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    even(problem, plans, work, control).map(|even| even.solution)
}

/// The solution of an even field.
struct Even {
    solution: Solution,
    /// Dependence of the points on each other; `None` if the field is not even.
    regime: Option<Regime>,
    /// Whether the field is even and reaches the targets, before a board's amplitudes reduce it.
    reached: bool,
}

/// Does the work of [`solve`].
fn even(problem: &Problem, plans: &[Plan], work: &Workspace, control: &mut Control) -> Result<Even, Error> {
    let silence = Silence::of(problem, plans[0].quiet, work, control)?;
    let mut rows = Rows::alike(problem, &silence.points, work, control)?;
    let foci = Foci::of(&mut rows, work, control)?;
    // If the problem gives a start, it is the only start, so one plan is enough.
    let plans = if problem.has_start() { &plans[plans.len() - 1..] } else { plans };
    let mut run = Run::new(problem, &rows, plans[0], MOST_STEPS, work, control);
    let mut search = Search::new(&rows, work);
    Search::reserve(&mut run)?;
    let expected = if silence.crowded { Regime::Silent } else { Regime::Separate };
    let regime = make_even(&mut run, &mut search, &foci, plans, expected)?;
    if regime == Regime::Crowded
        && !run.stopped
        && let Some(drive) = raise(&mut run, &mut search, &foci, plans)?
    {
        let ended = (Status::OutOfSteps, run.step);
        let solution = Solution::new(problem, drive, ended, run.steps, work, run.control)?;
        return Ok(Even { solution, regime: None, reached: false });
    }
    lift_to_target(&mut run, &mut search)?;
    let Search { mut best, even, .. } = search;
    if !traps::stiffest::stiffen(&mut run, &mut best)? {
        let board = grid::board(&run).filter(|_| plans.iter().any(|plan| plan.wide));
        let free = board.map(|board| (board, best.drives(problem.propagation().transducers(), work)));
        grid::bring(&mut run, even, &mut best);
        if let Some((board, free)) = free
            && !run.stopped
        {
            grid::raise(&mut run, board, &free, &mut best)?;
        }
    }
    let drive = best.drives(problem.propagation().transducers(), work);
    let status = match (run.stopped, even) {
        (true, _) => Status::Stopped,
        (_, true) => Status::Done,
        _ => Status::OutOfSteps,
    };
    let reached = even && best.moduli[..rows.targeted].iter().all(|&modulus| modulus >= rows.target);
    let regime = even.then_some(regime);
    let answer = Answer { drive, status, steps: (run.step, run.steps), mixed: true };
    let solution = answer.brought_down(problem, &rows, &best, work, run.control)?;
    Ok(Even { solution, regime, reached })
}

/// Makes the fields of all starts even with the steps of the `expected` regime. Returns the regime that the points
/// turned out to have.
fn make_even<'w>(
    run: &mut Run<'_, '_, 'w>,
    search: &mut Search<'w>,
    foci: &Foci,
    plans: &[Plan],
    expected: Regime,
) -> Result<Regime, Error> {
    if expected == Regime::Silent {
        for plan in plans {
            search.among_quiet(run, foci, *plan)?;
        }
        return Ok(if search.even { Regime::Silent } else { Regime::Crowded });
    }
    let symmetric = run.problem.propagation().control_points().is_some_and(|points| starts::regular(points, run.work));
    for plan in plans {
        let mut found = search.separate(run, foci, *plan)?;
        if !plan.wide && !run.problem.has_start() && (symmetric || found == Found::Lossy) {
            found = found.max(search.separate(run, foci, plan.again())?);
        }
        if found == Found::Crowded {
            return Ok(Regime::Crowded);
        }
        if run.stopped {
            break;
        }
        if found != Found::Separate && !run.problem.has_start() && !search.finds(run) {
            search.rise(run)?;
        }
    }
    Ok(Regime::Separate)
}

/// Raises the level of crowded points. If no even field reaches the targets, it returns the drive nearest to them
/// instead.
fn raise<'w>(
    run: &mut Run<'_, '_, 'w>,
    search: &mut Search<'w>,
    foci: &Foci,
    plans: &[Plan],
) -> Result<Option<Vec<Complex32>>, Error> {
    let (target, given) = (run.rows.target, run.problem.has_start());
    let nearest = if given { None } else { Some(nearest::approach(run, search)?) };
    // If all targets are nearly met, no other level is searched.
    let wanted = run.problem.aim() == Aim::Target;
    let near = wanted && nearest.as_ref().is_some_and(|nearest| nearest.near);
    let ended = |run: &Run, search: &Search| {
        near || run.stopped || run.rows.equations() > TOO_MANY || wanted && search.reaches(target)
    };
    if let Some(nearest) = &nearest
        && !ended(run, search)
    {
        search.trial.play_at_full(run.rows, nearest.drive.iter().copied());
        search.climb_on(run, Pace::LONG)?;
    }
    // Among quiet points the ascents found what can be found: a race from more starts raised one of 37 scenes by 3 %.
    let alone = run.rows.targeted == run.rows.order.len();
    for plan in plans.iter().filter(|_| alone) {
        if ended(run, search) {
            break;
        }
        // A wide plan goes on from the best field so far.
        let begun = nearest.as_ref().filter(|_| !plan.wide).map(|nearest| &nearest.drive[..]);
        search.race(run, foci, *plan, begun)?;
    }
    let Some(nearest) = nearest else { return Ok(None) };
    // No even field was found, or its level is below the target, which the nearest field meets.
    if wanted && !run.stopped && (!search.even || near && !search.reaches(target)) {
        return Ok(Some(nearest.drive));
    }
    run.work.complexes.give(nearest.drive);
    Ok(None)
}

/// Makes the field even at the target if it ended below. With many points the target may be reachable above the level
/// of the free steps.
fn lift_to_target<'w>(run: &mut Run<'_, '_, 'w>, search: &mut Search<'w>) -> Result<(), Error> {
    let (rows, propagation) = (run.rows, run.problem.propagation());
    let below = run.problem.aim() == Aim::Target && search.lowest < rows.target;
    if below && !run.stopped && 4 * rows.targeted >= propagation.transducers() {
        search.trial.copy(&search.best);
        if even::polish(run, Manner::separate(Some(rows.target)), &mut search.trial)?.even {
            search.even = true;
            core::mem::swap(&mut search.best, &mut search.trial);
        }
    }
    Ok(())
}
