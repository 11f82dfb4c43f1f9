//! Path: the loudest field of points, from uneven to even.
//!
//! ```text
//! maximise F = L (1 - C/2 rho)             L the mean of x_j = |P_j|/t_j, C = sum_j w_j (x_j/L - 1)^2; rho falls
//! y_j = g/M + w_j (L - x_j)/(rho L)        the multipliers dF/dx_j, of sum g = 1 + C/2 rho
//! D_i = Re(q_i sum_j y_j conj(u_j) G_ji)   a rotation d_i of q_i lowers sum_j y_j x_j by D_i d_i^2/2; u_j = P_j/|P_j|
//! (J D^-1 J^T + rho L (1 + tau) W^-1) y' = s - x,  d = D^-1 J^T y'          the step; s from sum y' = g/(1 + tau)
//! ```
//!
//! J are the derivatives of x by the drives' phases. The Hessian of sum_j y_j x_j is J^T (y/x) J - D, so this is a Newton
//! step, with the damping tau, on a quadratic penalty (Nocedal and Wright 2006, chapter 17.1). Its matrix has one row for
//! each point, and rho keeps it regular where points nearly depend on each other. Without a path the shortest steps to an
//! even field ([`crate::solvers::even_field::even`]) then follow the rounding of f32. A quiet point adds its leak
//! above the allowed one to C. C is relative to L, so that a field does not become even by becoming weak.

use crate::prelude::*;
use crate::solvers::common::tiled::Wave;
use crate::solvers::even_field::newton::{LEAST_CURVATURE, Level, Metric, Newton};
use crate::solvers::even_field::run::Run;

/// The values of rho: from the first to the last one by a factor.
#[derive(Clone, Copy)]
pub(super) struct Course {
    from: f32,
    to: f32,
    factor: f32,
}

impl Course {
    /// The first part of a path of crowded points. After it F shows how loud the field will be at the end. With the factor
    /// .7, clouds and spheres of points lose up to half of their level.
    pub(super) const FIRST: Self = Self { from: 3.0, to: CULL, factor: 0.85 };
    /// The rest of the path of crowded points. With a smaller factor they lose some of their level.
    pub(super) const REST: Self = Self { from: CULL, to: 2e-4, factor: 0.75 };
    /// A slow rest, for the field that is even where the other one is not.
    pub(super) const SLOW_REST: Self = Self { factor: 0.85, ..Self::REST };
    /// The path of separate points whose level was lost on the way to an even field.
    pub(super) const SEPARATE: Self = Self { from: 3.0, to: 1e-3, factor: 0.7 };
}

/// rho at the end of the first part.
pub(super) const CULL: f32 = 0.03;

/// Largest number of steps of a course, and at its last rho.
const STEPS: usize = 250;
const LAST_STEPS: usize = 30;

/// The largest change of a phase in rad.
const MOST_ROTATION: f32 = 0.5;

/// A step that gains less than this part of the level is the last one of its rho.
const WORTH: f64 = 1e-4;

/// tau of the first step. A good step divides tau by [`RELIEF`]; a failed one multiplies it by four and adds this. rho
/// falls after a step of less than [`LITTLE`], and without one above [`MOST`].
const TAU: f32 = 0.1;
const RELIEF: f32 = 3.0;
const LITTLE: f32 = 0.05;
const MOST: f32 = 1e4;

/// Takes and returns the memory of a course.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn reserve(run: &mut Run) -> Result<(), Error> {
    let newton = Newton::new(run.problem, run.rows, run.plan.quiet, run.work, run.control)?;
    let matrices = [(); 4].map(|()| run.work.floats.take_any(newton.dual.matrix.len()));
    let vectors = [(); 4].map(|()| run.work.floats.take(newton.dual.lanes()));
    drop((Metric::new(run.rows, LEAST_CURVATURE, run.work), matrices, vectors));
    Ok(())
}

/// Follows a course until no point is off the level by more than the part `close`. Returns the rest of the course.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn follow<'w>(
    run: &mut Run<'_, '_, 'w>,
    course: Course,
    close: f32,
    wave: &mut Wave<'w>,
) -> Result<Course, Error> {
    let (rows, work) = (run.rows, run.work);
    let mut newton = Newton::new(run.problem, rows, run.plan.quiet, work, run.control)?;
    let mut metric = Metric::new(rows, LEAST_CURVATURE, work);
    let mut trial = Wave::new(rows, work);
    let mut multipliers = work.floats.take(newton.dual.lanes());
    let (mut rho, mut tau, mut renew, mut ended) = (course.from, TAU, true, 0);
    run.steps += STEPS;
    for _ in 0..STEPS {
        let level = wave.level(rows);
        if run.stopped || level.is_nan() || level <= 0.0 {
            break;
        }
        let cost = newton.cost(rows, wave, level);
        let sum = 1.0 + cost / (2.0 * f64::from(rho));
        if renew {
            for (k, multiplier) in multipliers.iter_mut().enumerate().take(rows.targeted) {
                let pull = newton.missing(rows, wave, k, level) / (rho * level * newton.ease[k]);
                *multiplier = (sum / rows.targeted as f64) as f32 + pull;
            }
            metric.measure(rows, wave, &multipliers);
            let updated = newton.update(rows, wave, Some(&metric.roots), run.control);
            if run.unless_stopped(updated)?.is_none() {
                break;
            }
        }
        let factored = newton.factored_by(rows, rho * level * (1.0 + tau), run.control);
        let Some(factor) = run.unless_stopped(factored)? else { break };
        let mut gain = -1.0;
        if let Some(factor) = &factor {
            let next = newton.multipliers(rows, wave, factor, Level::Sum(sum / (1.0 + f64::from(tau))));
            if newton.turn(&next, Some(&metric.roots)).is_finite() {
                newton.rotations.iter_mut().for_each(|turn| *turn = turn.clamp(-MOST_ROTATION, MOST_ROTATION));
                trial.rotate(rows, wave, &newton.rotations, 1.0);
                gain = merit(&newton, run, &trial, rho) - f64::from(level) * (2.0 - sum);
            }
        }
        renew = gain > 0.0;
        let little = gain < WORTH * f64::from(level);
        let on;
        if renew {
            core::mem::swap(wave, &mut trial);
            tau /= RELIEF;
            on = tau < LITTLE || little;
            run.report(wave);
            if rho <= course.to {
                ended += 1;
            }
            let done = rho <= course.to && (little || ended == LAST_STEPS);
            if done || wave.unevenness(rows, wave.level(rows), run.plan.quiet) <= close {
                break;
            }
        } else {
            tau = 4.0 * tau + TAU;
            on = tau > MOST;
            if on && rho <= course.to {
                break;
            }
            (tau, renew) = if on { (TAU, true) } else { (tau, false) };
        }
        if on {
            rho = (course.factor * rho).max(course.to);
        }
    }
    Ok(Course { from: rho, ..course })
}

/// Returns F of the module's head.
pub(super) fn merit(newton: &Newton, run: &Run, wave: &Wave, rho: f32) -> f64 {
    let level = wave.level(run.rows);
    f64::from(level) * (1.0 - newton.cost(run.rows, wave, level) / (2.0 * f64::from(rho)))
}
