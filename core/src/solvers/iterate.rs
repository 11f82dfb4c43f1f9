//! The loop of iterative methods: step, tolerance, stop request, report.

use crate::solvers::prelude::*;

/// Makes up to `steps` steps, until one meets the tolerance or a caller stops them. Returns the status and the number
/// of steps. A tolerance of 0 requests all steps, so their end then counts as done.
///
/// `control` gets `residual` after each step but the last: that of the last step is the solution's, which
/// [`crate::Solution::new`] reports. A step may itself return a stop; it is then not counted.
pub(super) fn iterate<T>(
    (steps, tolerance): (u32, f64),
    state: &mut T,
    control: &mut Control,
    mut step: impl FnMut(&mut T, &mut Control) -> Result<bool>,
    residual: impl Fn(&T) -> f64,
) -> Result<(Status, usize)> {
    let steps = steps as usize;
    for done in 1..=steps {
        match step(state, control) {
            Ok(true) => return Ok((Status::Done, done)),
            Ok(false) => {}
            Err(error) if error.is_stop() => return Ok((Status::Stopped, done - 1)),
            Err(error) => return Err(error),
        }
        if done < steps && control.step(done, steps, || residual(state)).is_break() {
            return Ok((Status::Stopped, done));
        }
    }
    Ok((if tolerance > 0.0 { Status::OutOfSteps } else { Status::Done }, steps))
}

/// Returns the largest number of steps and the tolerance of alternating projections. With a single point one step
/// suffices: further ones only change the rounding.
pub(super) fn projections(problem: &Problem, steps: u32, tolerance: f64) -> (u32, f64) {
    if problem.propagation().points() == 1 { (1, 0.0) } else { (steps, tolerance) }
}

/// Returns the largest change of |p| relative to its target.
pub(super) fn largest_change(now: &[f32], before: &[f32], targets: &[f32]) -> f64 {
    let changes = now.iter().zip(before).zip(targets).filter(|(_, target)| **target > 0.0);
    f64::from(changes.fold(0.0, |most, ((now, was), target)| f32::max(most, (now - was).abs() / target)))
}

#[cfg(test)]
#[path = "tests/iterate.rs"]
mod tests;
