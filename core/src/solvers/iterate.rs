//! The loop of the iterative methods.

use crate::control::Control;
use crate::problem::solution::Status;

/// Steps until a step says that the tolerance is met, somebody stops them, or they are `steps`: how they ended, and how
/// many they were. A tolerance of 0 asks for all steps, which is then no shortage of them.
///
/// `control` is told `residual` after each step but the last: that one's is the answer's own, which
/// [`crate::Solution::tell`] tells.
pub(super) fn iterate<T>(
    (steps, tolerance): (u32, f64),
    state: &mut T,
    control: &mut Control,
    mut step: impl FnMut(&mut T) -> bool,
    residual: impl Fn(&T) -> f64,
) -> (Status, usize) {
    let steps = steps as usize;
    for done in 1..=steps {
        if step(state) {
            return (Status::Done, done);
        }
        if done < steps && control.step(done, steps, || residual(state)).is_break() {
            return (Status::Stopped, done);
        }
    }
    (if tolerance > 0.0 { Status::OutOfSteps } else { Status::Done }, steps)
}

/// The largest change of a |p| relative to its target.
pub(super) fn largest_change(now: &[f32], before: &[f32], targets: &[f32]) -> f64 {
    let changes = now.iter().zip(before).zip(targets).filter(|(_, target)| **target > 0.0);
    f64::from(changes.fold(0.0, |most, ((now, was), target)| f32::max(most, (now - was).abs() / target)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::ops::ControlFlow;

    #[test]
    fn steps_end_at_the_tolerance_a_stop_or_their_number() {
        // Steps, tolerance, the step that meets it and the one after which a stop is asked for; how it ends, and what was told.
        for (steps, tolerance, met, stop, want, told) in [
            (5, 0.0, 9, 9, (Status::Done, 5), 4),
            (5, 1e-3, 9, 9, (Status::OutOfSteps, 5), 4),
            (5, 1e-3, 3, 9, (Status::Done, 3), 2),
            (5, 1e-3, 5, 9, (Status::Done, 5), 4),
            (5, 0.0, 9, 2, (Status::Stopped, 2), 2),
            (1, 0.0, 9, 1, (Status::Done, 1), 0),
        ] {
            let mut observer = |progress: crate::Progress| {
                if progress.step == stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let mut control = Control::watched(&mut observer).traced();
            let mut count = 0;
            let step = |count: &mut usize| {
                *count += 1;
                *count == met
            };
            let ended = iterate((steps, tolerance), &mut count, &mut control, step, |&count| count as f64);
            assert_eq!((ended, count), (want, want.1));
            let trace = control.into_trace().expect("a trace");
            assert_eq!(trace.len(), told);
            assert!(trace.iter().zip(1..).all(|(residual, step)| *residual == f64::from(step)));
        }
    }

    #[test]
    fn the_largest_change_is_relative_to_the_target_and_passes_quiet_points_over() {
        assert_eq!(largest_change(&[1.0, 2.0, 9.0], &[1.5, 4.0, 0.0], &[1.0, 8.0, 0.0]), 0.5);
    }
}
