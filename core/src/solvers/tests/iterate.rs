//! Tests of `iterate`.

use super::*;
use core::ops::ControlFlow;

#[test]
fn steps_end_at_the_tolerance_a_stop_or_their_number() {
    // Each case: the steps, the tolerance, the step that meets it, the step after which a stop is requested; the expected
    // status and number of steps, and the expected number of reports.
    for (steps, tolerance, met, stop, want, reported) in [
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
        let step = |count: &mut usize, _: &mut Control| {
            *count += 1;
            Ok(*count == met)
        };
        let ended = iterate((steps, tolerance), &mut count, &mut control, step, |&count| count as f64).expect("steps");
        assert_eq!((ended, count), (want, want.1));
        let trace = control.into_trace().expect("a trace");
        assert_eq!(trace.len(), reported);
        assert!(trace.iter().zip(1..).all(|(residual, step)| *residual == f64::from(step)));
    }
}

#[test]
fn a_stop_noticed_within_a_step_takes_that_step_back() {
    let step = |count: &mut usize, _: &mut Control| {
        *count += 1;
        if *count == 3 { Err(Error::stopped()) } else { Ok(false) }
    };
    let ended = iterate((5, 0.0), &mut 0, &mut Control::none(), step, |_| 0.0);
    assert_eq!(ended, Ok((Status::Stopped, 2)));
}

#[test]
fn the_largest_change_is_relative_to_targets_and_ignores_quiet_points() {
    assert_eq!(largest_change(&[1.0, 2.0, 9.0], &[1.5, 4.0, 0.0], &[1.0, 8.0, 0.0]), 0.5);
}
