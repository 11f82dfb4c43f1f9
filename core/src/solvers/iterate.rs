//! The iterative loop: step, tolerance, stop request, report.

use crate::control::Control;
use crate::error::Error;
use crate::problem::{Problem, Status};

/// Makes steps until a step meets the tolerance, a caller stops them, or they are `steps`; returns the status and
/// their number. A tolerance of 0 asks for all steps, which is then no shortage of them.
///
/// `control` gets `residual` after each step but the last: the last one's is the answer's own, which
/// [`crate::Solution::new`] reports. A step may itself hear of a stop: it then counts for nothing.
pub(super) fn iterate<T>(
    (steps, tolerance): (u32, f64),
    state: &mut T,
    control: &mut Control,
    mut step: impl FnMut(&mut T, &mut Control) -> Result<bool, Error>,
    residual: impl Fn(&T) -> f64,
) -> Result<(Status, usize), Error> {
    let steps = steps as usize;
    for done in 1..=steps {
        match step(state, control) {
            Ok(true) => return Ok((Status::Done, done)),
            Ok(false) => {}
            Err(Error::Stopped) => return Ok((Status::Stopped, done - 1)),
            Err(error) => return Err(error),
        }
        if done < steps && control.step(done, steps, || residual(state)).is_break() {
            return Ok((Status::Stopped, done));
        }
    }
    Ok((if tolerance > 0.0 { Status::OutOfSteps } else { Status::Done }, steps))
}

/// Steps at most, and the tolerance, of a projection back and forth: to a single point the first step is the last, what
/// further ones change is rounding.
pub(super) fn projections(problem: &Problem, steps: u32, tolerance: f64) -> (u32, f64) {
    if problem.propagation().points() == 1 { (1, 0.0) } else { (steps, tolerance) }
}

/// The largest change of a |p| relative to its target.
pub(super) fn largest_change(now: &[f32], before: &[f32], targets: &[f32]) -> f64 {
    let changes = now.iter().zip(before).zip(targets).filter(|(_, target)| **target > 0.0);
    f64::from(changes.fold(0.0, |most, ((now, was), target)| f32::max(most, (now - was).abs() / target)))
}

#[cfg(test)]
#[path = "tests/iterate.rs"]
mod tests;
