//! Even fields at the highest common level: point phases, weighted sweeps, then Gauss-Newton until even enough.
//!
//! Point phases that reinforce one another are found on G, or several on the matrix of couplings ([`point_phases`]); weighted
//! Gerchberg-Saxton sweeps with |q| = 1 raise the weakest points ([`weighted_sweeps`]); Gauss-Newton steps on
//! |P_j| = s p_j, the level s free, make all alike ([`common_level`]).
//!
//! Rows of G are divided by their targets, so that all points ask for the same; the quiet ones come last.

pub(crate) mod ascent;
pub(crate) mod coincident;
pub(crate) mod common_level;
pub(crate) mod on_grid;
pub(crate) mod point_phases;
pub(crate) mod regular;
pub(crate) mod run;
pub(crate) mod search;
pub(crate) mod weighted_sweeps;

use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::Error;
use crate::linalg::Planar;
use crate::problem::{Problem, Solution, Status};
use crate::scene::Aim;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::point_phases::Foci;
use crate::solvers::even_field::run::{Plan, Run};
use crate::solvers::even_field::search::Search;
use crate::workspace::Workspace;

/// Points of which pictures are made: more than can be even in a second.
const PICTURE: usize = 400;

/// Whether a problem has more points than an even field is looked for, with targets to be met.
pub(crate) fn too_many(problem: &Problem) -> bool {
    problem.aim() == Aim::Target && problem.propagation().points() > PICTURE && !problem.has_start()
}

/// The largest part of a target that a drive may be off by for all targets to be still in reach of it.
const NEAR: f32 = 0.3;

/// A drive near by with |q| = 1 that meets every target, if Gauss-Newton steps find one in time.
///
/// # Errors
/// More memory than allowed.
pub(crate) fn met(
    problem: &Problem,
    drive: &[Complex32],
    (step, steps): (usize, usize),
    work: &Workspace,
    control: &mut Control,
) -> Result<Option<Vec<Complex32>>, Error> {
    let propagation = problem.propagation();
    if 2 * propagation.points() > propagation.transducers() {
        return Ok(None);
    }
    let rows = &Rows::alike(problem, work, control)?;
    let plan = &Plan::alone(0, MET);
    let moduli = work.floats.take(propagation.lanes());
    let mut run = Run {
        problem,
        rows,
        plan,
        work,
        control,
        step,
        steps: steps + common_level::MOST_STEPS,
        stopped: false,
        moduli,
    };
    let mut wave = Wave::new(rows, work);
    wave.play_at_full(rows, drive.iter().copied());
    let near = wave.unevenness(rows, rows.target) <= NEAR;
    let met = near && common_level::polish(&mut run, Some(rows.target), &mut wave)?.even;
    Ok(met.then(|| wave.drives(propagation.transducers(), work)))
}

/// Targets are met to this part.
const MET: f64 = 1e-4;

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
    let mut rows = Rows::alike(problem, work, control)?;
    let foci = Foci::of(&mut rows, work, control)?;
    let rows = &rows;
    let moduli = work.floats.take(problem.propagation().lanes());
    // A start that is given is the only one.
    let plans = if problem.has_start() { &plans[plans.len() - 1..] } else { plans };
    let (plan, steps) = (&plans[0], common_level::MOST_STEPS);
    let more = plan.for_regular();
    let denser: Vec<Plan> = plans.iter().map(|plan| plan.for_crowded(rows.targeted)).collect();
    let mut run = Run { problem, rows, plan, work, control, step: 0, steps, stopped: false, moduli };
    let mut search = Search::new(rows, work);
    let symmetric = problem.propagation().control_points().is_some_and(regular::regular);
    let extra = (symmetric && !problem.has_start()).then_some(&more);
    let mut crowded = false;
    for plan in plans.iter().chain(extra) {
        crowded |= search.level(&mut run, &foci, plan)?;
        if run.stopped || crowded {
            break;
        }
    }
    if crowded && !run.stopped {
        for plan in &denser {
            search.climb(&mut run, &foci, plan)?;
        }
    }
    let Search { mut best, mut even, lowest, trial: mut wave } = search;
    let wanted = problem.aim() == Aim::Target;
    // With many points the target may lie above the level where free steps end, and still be in reach.
    if wanted && !run.stopped && lowest < rows.target && 4 * rows.targeted >= problem.propagation().transducers() {
        wave.copy(&best);
        if common_level::polish(&mut run, Some(rows.target), &mut wave)?.even {
            even = true;
            core::mem::swap(&mut best, &mut wave);
        }
    }
    let quantization = problem.quantization();
    if let Some(quantization) = quantization
        && !run.stopped
    {
        // At full drive, where the grid is finest.
        run.stopped = on_grid::round(problem, rows, quantization, even, &mut best, work, run.control).is_err();
    }
    let mut drive = best.drives(problem.propagation().transducers(), work);
    let loudest = best.moduli[..rows.targeted].iter().copied().fold(0.0, f32::max);
    let factor = if wanted && loudest > rows.target { f64::from(rows.target / loudest) } else { 1.0 };
    let (amplitude, scale) = quantization.map_or((factor, 1.0), |quantization| quantization.lowered(factor));
    for q in &mut drive {
        *q *= amplitude as f32;
    }
    let mut field = Planar::zeros(1, problem.propagation().lanes(), work);
    for (field, own) in [&mut field.re, &mut field.im].into_iter().zip(&best.field) {
        for (k, &j) in rows.order.iter().enumerate() {
            field[j as usize] = own[k] / rows.scale[k] * amplitude as f32;
        }
    }
    let status = match (run.stopped, even) {
        (true, _) => Status::Stopped,
        (_, true) => Status::Done,
        _ => Status::OutOfSteps,
    };
    let solution = Solution::of_field(problem, drive, &field, status, run.step, work, run.control)?;
    let mut solution = solution.scaled(scale);
    if !run.stopped && quantization.is_some_and(|quantization| quantization.phases().is_some()) {
        solution = solution.on_grid();
    }
    solution.tell(problem, run.steps, run.control);
    Ok(solution)
}
