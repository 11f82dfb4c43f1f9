//! Even fields at the highest common level: point phases, weighted sweeps, then Gauss-Newton until even enough.
//!
//! Point phases that reinforce one another are found on G, or several on the matrix of couplings ([`point_phases`]); weighted
//! Gerchberg-Saxton sweeps with |q| = 1 raise the weakest points ([`weighted_sweeps`]); Gauss-Newton steps on
//! |P_j| = s p_j, the level s free, make all alike ([`common_level`]).
//!
//! Rows of G are divided by their targets, so that all points ask for the same; the quiet ones come last.

pub(crate) mod answer;
pub(crate) mod ascent;
pub(crate) mod coincident;
pub(crate) mod common_level;
pub(crate) mod on_grid;
pub(crate) mod point_phases;
pub(crate) mod regular;
pub(crate) mod run;
pub(crate) mod search;
pub(crate) mod silence;
pub(crate) mod targets;
pub(crate) mod traps;
pub(crate) mod weighted_sweeps;
pub(crate) mod within;

use crate::control::Control;
use crate::error::Error;
use crate::problem::{Problem, Solution, Status};
use crate::scene::Aim;
use crate::solvers::common::tiled::Rows;
use crate::solvers::even_field::answer::Answer;
use crate::solvers::even_field::ascent::Pace;
use crate::solvers::even_field::common_level::Manner;
use crate::solvers::even_field::point_phases::Foci;
use crate::solvers::even_field::run::{Plan, Run, TOO_MANY};
use crate::solvers::even_field::search::Search;
use crate::solvers::even_field::silence::Silence;
use crate::solvers::even_field::targets::Nearest;
use crate::workspace::Workspace;

/// An even drive, at the level that the problem aims at: the best that any of some plans finds.
///
/// # Errors
/// More memory than allowed; a stop before there is a drive.
pub(crate) fn solve(
    problem: &Problem,
    plans: &[Plan],
    work: &Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    let silence = Silence::of(problem, plans[0].quiet, work, control)?;
    let mut rows = Rows::alike(problem, &silence.points, work, control)?;
    let foci = Foci::of(&mut rows, work, control)?;
    let rows = &rows;
    let moduli = work.floats.take(problem.propagation().lanes());
    // A start that is given is the only one.
    let plans = if problem.has_start() { &plans[plans.len() - 1..] } else { plans };
    let (plan, steps) = (plans[0], common_level::MOST_STEPS);
    let mut run = Run { problem, rows, plan, work, control, step: 0, steps, stopped: false, moduli };
    let mut search = Search::new(rows, work);
    let symmetric = problem.propagation().control_points().is_some_and(|points| regular::regular(points, work));
    let extra = (symmetric && !problem.has_start()).then(|| plan.for_regular());
    let mut crowded = false;
    if silence.crowded {
        for plan in plans {
            search.climb(&mut run, &foci, *plan, (Pace::SILENT, |level| Manner::silent(level, plan.quiet)))?;
        }
        crowded = !search.even;
    } else {
        for plan in plans.iter().copied().chain(extra) {
            crowded |= search.level(&mut run, &foci, plan)?;
            if run.stopped || crowded {
                break;
            }
        }
    }
    let wanted = problem.aim() == Aim::Target;
    let mut nearest = None;
    if crowded && !run.stopped && !problem.has_start() {
        let found = targets::approach(&mut run, &mut search)?;
        // Where all targets are nearly met, no other level is looked for.
        crowded = !(wanted && (found.near || search.reaches(rows.target)));
        if crowded && !run.stopped && rows.equations() <= TOO_MANY {
            search.trial.play_at_full(rows, found.drive.iter().copied());
            search.climb_on(&mut run, (Pace::LOUD, Manner::crowded))?;
        }
        if wanted {
            nearest = Some(found);
        } else {
            work.complexes.give(found.drive);
        }
    }
    if crowded && !run.stopped && rows.equations() <= TOO_MANY && !(wanted && search.reaches(rows.target)) {
        for plan in plans {
            search.race(&mut run, &foci, plan.for_crowded())?;
        }
    }
    if let Some(Nearest { drive, near }) = nearest {
        if !run.stopped && (!search.even || near && !search.reaches(rows.target)) {
            // No even field was found, or one that is weaker: the nearest to the targets, then.
            return Solution::new(problem, drive, (Status::OutOfSteps, run.step), run.steps, work, run.control);
        }
        work.complexes.give(drive);
    }
    let Search { mut best, mut even, lowest, trial: mut wave } = search;
    // With many points the target may lie above the level where free steps end, and still be in reach.
    if wanted && !run.stopped && lowest < rows.target && 4 * rows.targeted >= problem.propagation().transducers() {
        wave.copy(&best);
        if common_level::polish(&mut run, Manner::separate(Some(rows.target)), &mut wave)?.even {
            even = true;
            core::mem::swap(&mut best, &mut wave);
        }
    }
    let stiffened = match if run.stopped { Ok(false) } else { traps::stiffen(&mut run, &mut best) } {
        // The foci are there.
        Err(Error::Stopped) => {
            run.stopped = true;
            false
        }
        stiffened => stiffened?,
    };
    let quantization = problem.quantization();
    if let Some(quantization) = quantization
        && !(run.stopped || stiffened)
    {
        // At full drive, where the grid is finest.
        run.stopped = on_grid::round(problem, rows, quantization, even, &mut best, work, run.control).is_err();
    }
    let drive = best.drives(problem.propagation().transducers(), work);
    let status = match (run.stopped, even) {
        (true, _) => Status::Stopped,
        (_, true) => Status::Done,
        _ => Status::OutOfSteps,
    };
    Answer { drive, status, steps: (run.step, run.steps) }.brought_down(problem, rows, &best, work, run.control)
}
