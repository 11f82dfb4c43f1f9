//! Ascent: raises the level of targets among crowded quiet points, and that of the field of least squares.
//!
//! ```text
//! maximise s subject to |P_j| = s t_j,    with Lagrange multipliers y_j, sum_j y_j = 1
//! (J D^-1 J^T + mu W^-1) y = s t - |P|                         gives the new y; their sum gives s
//! d = D^-1 J^T y                                               the rotations of all drives
//! ```
//!
//! (sequential quadratic programming, Nocedal and Wright 2006, chapter 18; J, D and W as in
//! [`crate::solvers::even_field::newton`].) The equations of quiet points are many and linear. A path of the penalty
//! ([`crate::solvers::even_field::path`]) leaves them too loud. From the field of least squares of crowded points this
//! ascent keeps the level, which the path there loses.

use crate::prelude::*;
use crate::solvers::common::tiled::Wave;
use crate::solvers::even_field::even::{MOST_ROTATION, Manner};
use crate::solvers::even_field::newton::{LEAST_CURVATURE, Level, Metric, Newton};
use crate::solvers::even_field::run::Run;

/// The course of the damping mu, relative to the mean diagonal entry of J D^-1 J^T.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    /// The lower bound of the [`Metric`]. Beside quiet points most transducers are below it: their fields become even
    /// sooner, at a level that is 1 % higher. Crowded targets would lose level.
    curvature: f32,
    /// The damping of the first step.
    damping: f32,
    /// The factor of the damping from step to step.
    shrink: f32,
    /// The least damping. With less damping, a step would follow parts of the field that have no effect, or the noise
    /// of f32.
    least: f32,
    steps: usize,
}

impl Pace {
    /// The pace for a few targets. Beside a disc of 172 quiet points a least damping of 1e-5 loses 4 % of the level. With
    /// 1e-3 the quiet points leak twice as much.
    pub(super) const SHORT: Self = Self { curvature: 2.0, damping: 1e-2, shrink: 0.5, least: 1e-4, steps: 22 };
    /// The pace for many targets.
    pub(super) const LONG: Self =
        Self { curvature: LEAST_CURVATURE, damping: 1.0, shrink: 0.93, least: 1e-5, steps: 160 };

    /// Returns how the field is made even after the ascent, for its level and an allowed leak.
    pub(super) fn manner(self, level: f32, quiet: f32) -> Manner {
        if self.steps == Self::SHORT.steps { Manner::silent(level, quiet) } else { Manner::crowded(level) }
    }
}

/// Raises the level of `wave`, and makes it as even as the last damping allows.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn climb<'w>(run: &mut Run<'_, '_, 'w>, pace: Pace, wave: &mut Wave<'w>) -> Result<(), Error> {
    let (rows, work) = (run.rows, run.work);
    let mut newton = Newton::new(run.problem, rows, run.plan.quiet, work, run.control)?;
    let mut metric = Metric::new(rows, pace.curvature, work);
    let mut trial = Wave::new(rows, work);
    let mut multipliers = work.floats.take(newton.dual.lanes());
    multipliers[..rows.targeted].fill(1.0 / rows.targeted as f32);
    let mut damping = pace.damping;
    run.steps += pace.steps;
    for _ in 0..pace.steps {
        if run.stopped {
            break;
        }
        metric.measure(rows, wave, &multipliers);
        let updated = newton.update(rows, wave, Some(&metric.roots), run.control);
        let factored = updated.and_then(|()| newton.factored(rows, damping, run.control));
        let Some(factor) = run.unless_stopped(factored)? else { break };
        let Some(factor) = factor else {
            damping *= 10.0;
            continue;
        };
        let next = newton.multipliers(rows, wave, &factor, Level::Sum(1.0));
        let longest = newton.turn(&next, Some(&metric.roots));
        if !longest.is_finite() {
            break;
        }
        let part = (MOST_ROTATION / longest).min(1.0);
        trial.rotate(rows, wave, &newton.rotations, part);
        if !trial.level(rows).is_finite() {
            break;
        }
        core::mem::swap(wave, &mut trial);
        for (multiplier, next) in multipliers.iter_mut().zip(&next) {
            *multiplier += part * (next - *multiplier);
        }
        damping = (pace.shrink * damping).max(pace.least);
        run.report(wave);
    }
    Ok(())
}
