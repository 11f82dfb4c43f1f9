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
pub(crate) mod run;
pub(crate) mod weighted_sweeps;

use crate::control::Control;
use crate::error::Error;
use crate::linalg::Planar;
use crate::problem::{Problem, Solution, Status};
use crate::scene::Aim;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::common_level::Polish;
use crate::solvers::even_field::point_phases::{Foci, Starts};
use crate::solvers::even_field::run::{Plan, Run};
use crate::workspace::Workspace;

/// Points are crowded where this part of them, or more, depends on others, ...
const DEPENDENT: f32 = 0.2;

/// ... and the steps to an even field left less than this part of the level. Of separate points, a tenth depends on others,
/// and .97 or more of the level is kept.
const KEPT: f32 = 0.97;

/// Crowded points are even where none is off by more than this part of the level, if no field is more so.
const NEARLY: f32 = 5e-3;

/// An even drive, at the level that the problem aims at.
///
/// # Errors
/// More memory than allowed; a stop before there is a drive.
pub(crate) fn solve(
    problem: &Problem,
    plan: &Plan,
    work: &Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    let mut rows = Rows::alike(problem, work, control)?;
    let foci = Foci::of(&mut rows, work, control)?;
    let rows = &rows;
    let starts = Starts::new(problem, rows, &foci, plan, work, control)?;
    let moduli = work.floats.take(problem.propagation().lanes());
    let more = plan.crowded(rows.targeted);
    let steps = starts.count * (1 + plan.sweeps + common_level::MOST_STEPS) + common_level::MOST_STEPS;
    let mut run = Run { problem, rows, plan, work, control, step: 0, steps, stopped: false, moduli };
    let [mut best, mut wave] = [(); 2].map(|()| Wave::new(rows, work));
    let mut reached = (false, -1.0);
    let mut crowded = false;
    for start in 0..starts.count {
        weighted_sweeps::raise(&mut run, &starts, start, &mut wave);
        let before = wave.level(rows);
        let Polish { even, dependent } = common_level::polish(&mut run, None, &mut wave)?;
        crowded |= !even || (dependent >= DEPENDENT && wave.level(rows) < KEPT * before);
        if (even, wave.lowest(rows)) > reached {
            reached = (even, wave.lowest(rows));
            core::mem::swap(&mut best, &mut wave);
        }
        if run.stopped {
            break;
        }
    }
    if crowded && !run.stopped && rows.targeted > 1 {
        run.plan = &more;
        let starts = Starts::new(problem, rows, &foci, &more, work, run.control)?;
        run.steps += starts.count * (1 + more.sweeps + ascent::MOST_STEPS + common_level::MOST_STEPS);
        for start in 0..starts.count {
            weighted_sweeps::raise(&mut run, &starts, start, &mut wave);
            ascent::climb(&mut run, &mut wave)?;
            let level = wave.level(rows);
            common_level::polish(&mut run, Some(level), &mut wave)?;
            let even = wave.unevenness(rows, wave.level(rows)) <= plan.tolerance.max(NEARLY);
            if (even, wave.lowest(rows)) > reached {
                reached = (even, wave.lowest(rows));
                core::mem::swap(&mut best, &mut wave);
            }
            if run.stopped {
                break;
            }
        }
        reached.0 = best.unevenness(rows, best.level(rows)) <= plan.tolerance;
    }
    let wanted = problem.aim() == Aim::Target;
    // With many points the target may lie above the level where free steps end, and still be in reach.
    if wanted && !run.stopped && reached.1 < rows.target && 4 * rows.targeted >= problem.propagation().transducers() {
        wave.copy(&best);
        if common_level::polish(&mut run, Some(rows.target), &mut wave)?.even {
            reached.0 = true;
            core::mem::swap(&mut best, &mut wave);
        }
    }
    let quantization = problem.quantization();
    if let Some(quantization) = quantization
        && !run.stopped
    {
        // At full drive, where the grid is finest.
        let even = reached.0;
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
    let status = match (run.stopped, reached.0) {
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
