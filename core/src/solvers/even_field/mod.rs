//! Even fields at the highest common level: point phases, weighted sweeps, then Gauss-Newton until even enough.
//!
//! Point phases that reinforce one another are found on G, or several on the matrix of couplings ([`point_phases`]); weighted
//! Gerchberg-Saxton sweeps with |q| = 1 raise the weakest points ([`weighted_sweeps`]); Gauss-Newton steps on
//! |P_j| = s p_j, the level s free, make all alike ([`common_level`]).
//!
//! Rows of G are divided by their targets, so that all points ask for the same; the quiet ones come last.

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
use crate::solvers::even_field::point_phases::Starts;
use crate::solvers::even_field::run::{Plan, Run};
use crate::workspace::Workspace;

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
    let starts = Starts::new(problem, &mut rows, plan, work, control)?;
    let moduli = work.floats.take(problem.propagation().lanes());
    let steps = starts.count * (1 + plan.sweeps + common_level::MOST_STEPS) + common_level::MOST_STEPS;
    let rows = &rows;
    let mut run = Run { problem, rows, plan, work, control, step: 0, steps, stopped: false, moduli };
    let [mut best, mut wave] = [(); 2].map(|()| Wave::new(rows, work));
    let mut reached = (false, -1.0);
    for start in 0..starts.count {
        weighted_sweeps::raise(&mut run, &starts, start, &mut wave);
        let even = common_level::polish(&mut run, None, &mut wave)?;
        if (even, wave.lowest(rows)) > reached {
            reached = (even, wave.lowest(rows));
            core::mem::swap(&mut best, &mut wave);
        }
        if run.stopped {
            break;
        }
    }
    let wanted = problem.aim() == Aim::Target;
    // With many points the target may lie above the level where free steps end, and still be in reach.
    if wanted && !run.stopped && reached.1 < rows.target && 4 * rows.targeted >= problem.propagation().transducers() {
        wave.copy(&best);
        if common_level::polish(&mut run, Some(rows.target), &mut wave)? {
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
    solution.tell(problem, steps, run.control);
    Ok(solution)
}
