//! Tests of `ahead`: the bound in whole codes, evenness and level by eq. (5) in double precision, threads, errors.

use alloc::string::ToString;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};
use core::ops::ControlFlow;

use num_complex::Complex64;

use super::{Ahead, Ends, ahead};
use crate::control::{Control, Progress};
use crate::error::Error;
use crate::kernels::InstructionSet;
use crate::math::phasor;
use crate::problem::Problem;
use crate::propagation::Model;
use crate::scene::{Aim, Array, Medium, Request};
use crate::solvers::{Solve, Uniform};
use crate::workspace::Workspace;

const OPEN: Ahead = Ahead { change: PI / 16.0, phases: 256, ends: Ends::Open, rounds: 6 };
const CLOSED: Ahead = Ahead { ends: Ends::Closed, ..OPEN };

fn model(array: &Array) -> Model {
    Model::new(array, Medium::default(), InstructionSet::best()).expect("a model")
}

fn grid() -> Array {
    Array::grid(16, 16, 10e-3).expect("a grid")
}

/// Returns three points on circles of 4 mm, with a lap in `lap` frames.
fn circles(frames: usize, lap: usize) -> Vec<[f64; 3]> {
    let point = |frame: usize, j: usize| {
        let turn = phasor(TAU * frame as f64 / lap as f64);
        [0.03 * (j as f64 - 1.0) + 4e-3 * turn.re, 0.02 * (j % 2) as f64 + 4e-3 * turn.im, 0.15]
    };
    (0..frames).flat_map(|frame| (0..3).map(move |j| point(frame, j))).collect()
}

fn solved(model: &Model, points: &[[f64; 3]], targets: &[f64], frames: usize, how: &Ahead) -> Vec<u16> {
    ahead(model, points, targets, frames, how, None, &mut Control::none()).expect("codes")
}

/// Returns the largest step between successive frames, in phases.
fn largest_step(codes: &[u16], transducers: usize, how: &Ahead) -> u16 {
    let apart = |a: u16, b: u16| a.abs_diff(b).min(how.phases as u16 - a.abs_diff(b));
    let next = |k: usize| (k + transducers) % codes.len();
    let steps = if how.ends == Ends::Closed { codes.len() } else { codes.len() - transducers };
    (0..steps).map(|k| apart(codes[k], codes[next(k)])).max().expect("steps")
}

/// Returns |P_j| of a frame, by eq. (5) in double precision.
fn moduli(model: &Model, points: &[[f64; 3]], codes: &[u16], phases: u32) -> Vec<f64> {
    let propagation = model.propagation(points).expect("points");
    let drive = |code: u16| Complex64::from_polar(1.0, TAU * f64::from(code) / f64::from(phases));
    let sum = |j: usize| codes.iter().enumerate().map(|(i, &code)| propagation.exact(j, i) * drive(code)).sum();
    (0..points.len()).map(|j| Complex64::norm(sum(j))).collect()
}

/// Returns for each frame min |P_j|/t_j over max |P_j|/t_j, and the mean of |P_j|/t_j over the mean that `uniform`
/// reaches for this frame alone.
fn judged(model: &Model, points: &[[f64; 3]], targets: &[f64], codes: &[u16], phases: u32) -> Vec<[f64; 2]> {
    let (each, transducers) = (3, model.array().len());
    let frames = points.chunks(each).zip(targets.chunks(each)).zip(codes.chunks(transducers));
    frames
        .map(|((points, targets), codes)| {
            let there: Vec<usize> = (0..each).filter(|&j| targets[j] > 0.0).collect();
            let points: Vec<_> = there.iter().map(|&j| points[j]).collect();
            let pressures: Vec<f64> = there.iter().map(|&j| targets[j]).collect();
            let parts = |moduli: &[f64]| -> Vec<f64> { moduli.iter().zip(&pressures).map(|(p, t)| p / t).collect() };
            let shares = parts(&moduli(model, &points, codes, phases));
            let request = Request { pressures: Some(pressures.clone()), ..Request::default() };
            let problem = Problem::of_model(model, &points, &request, &mut Control::none()).expect("a problem");
            let cold =
                Uniform::default().solve(&problem.with_aim(Aim::Max), &mut Workspace::new(), &mut Control::none());
            let cold: Vec<f64> = cold.expect("a field").pressures.iter().map(|p| f64::from(p.norm())).collect();
            let cold = parts(&cold);
            let [least, most] = shares.iter().fold([f64::INFINITY, 0.0], |[a, b], &x| [a.min(x), b.max(x)]);
            [least / most, shares.iter().sum::<f64>() / cold.iter().sum::<f64>()]
        })
        .collect()
}

fn check(judged: &[[f64; 2]], level: f64) {
    let mean = judged.iter().map(|[_, level]| level).sum::<f64>() / judged.len() as f64;
    assert!(judged.iter().all(|[even, _]| *even >= 0.995), "{judged:?}");
    assert!(mean >= level && mean < 1.05, "level {mean}");
}

#[test]
fn frames_are_even_and_loud_within_the_bound() {
    let model = model(&grid());
    // The points move by .05 mm a frame: .5 m/s at 10 kHz.
    let points = circles(40, 503);
    for (targets, how) in
        [([1.0, 1.0, 1.0].repeat(40), Ahead { change: PI / 32.0, ..OPEN }), ([200.0, 100.0, 150.0].repeat(40), OPEN)]
    {
        let codes = solved(&model, &points, &targets, 40, &how);
        assert!(largest_step(&codes, 256, &how) <= (how.change * 256.0 / TAU + 1e-9) as u16);
        check(&judged(&model, &points, &targets, &codes, 256), 0.98);
    }
}

#[test]
fn a_closed_curve_has_no_seam() {
    let model = model(&grid());
    let points = circles(48, 48);
    let codes = solved(&model, &points, &[1.0; 144], 48, &CLOSED);
    assert!(largest_step(&codes, 256, &CLOSED) <= 8);
    assert!(largest_step(&codes, 256, &CLOSED) > 4, "the bound is used");
    check(&judged(&model, &points, &[1.0; 144], &codes, 256), 0.95);
    // The cases: few phases; only two frames; only two phases.
    for (phases, frames) in [(16, 48), (256, 2), (2, 3)] {
        let how = Ahead { change: TAU / 16.0, phases, ..CLOSED };
        let codes = solved(&model, &points[..3 * frames], &[1.0; 144][..3 * frames], frames, &how);
        assert!(largest_step(&codes, 256, &how) <= (phases / 16) as u16);
    }
}

#[test]
fn a_bound_of_0_keeps_all_codes_and_a_bound_of_pi_none() {
    let model = model(&grid());
    let points = circles(20, 100);
    let still = Ahead { change: 0.0, ..OPEN };
    let codes = solved(&model, &points, &[1.0; 60], 20, &still);
    assert_eq!(largest_step(&codes, 256, &still), 0);
    let free = Ahead { change: PI, ..OPEN };
    let codes = solved(&model, &points, &[1.0; 60], 20, &free);
    check(&judged(&model, &points, &[1.0; 60], &codes, 256), 0.99);
    let more = Ahead { change: 100.0, ..OPEN };
    assert_eq!(codes, solved(&model, &points, &[1.0; 60], 20, &more));
}

#[test]
fn points_come_and_go_and_dead_transducers_keep_code_0() {
    let mut mask = vec![true; 256];
    mask[17] = false;
    let model = model(&grid().with_mask(Some(mask)).expect("a mask"));
    let mut points = circles(20, 200);
    let mut targets = vec![1.0; 60];
    for frame in 8..14 {
        targets[3 * frame + 1] = 0.0;
        points[3 * frame + 1] = [f64::NAN; 3];
    }
    // Frame 16 has no point.
    targets[48..51].fill(0.0);
    let codes = solved(&model, &points, &targets, 20, &OPEN);
    assert!(codes.iter().skip(17).step_by(256).all(|&code| code == 0));
    assert!(largest_step(&codes, 256, &OPEN) <= 8);
    let judged = |frames: core::ops::Range<usize>| {
        let range = 3 * frames.start..3 * frames.end;
        judged(&model, &points[range.clone()], &targets[range], &codes[256 * frames.start..256 * frames.end], 256)
    };
    // A point that appears suddenly is limited by the frames before and after it.
    check(&[judged(0..5), judged(17..20)].concat(), 0.98);
    check(&[judged(10..12), judged(15..16)].concat(), 0.95);
}

#[test]
fn a_search_continues_from_its_start() {
    let model = model(&grid());
    let points = circles(16, 400);
    let once = solved(&model, &points, &[1.0; 48], 16, &OPEN);
    let how = Ahead { rounds: 1, ..OPEN };
    let again = ahead(&model, &points, &[1.0; 48], 16, &how, Some(&once), &mut Control::none()).expect("codes");
    assert!(largest_step(&again, 256, &how) <= 8);
    let levels = [&once, &again].map(|codes| {
        let judged = judged(&model, &points, &[1.0; 48], codes, 256);
        judged.iter().map(|[_, level]| level).sum::<f64>() / 16.0
    });
    assert!(levels[1] > levels[0] - 2e-3, "{levels:?}");
}

#[test]
fn a_first_frame_is_kept() {
    let model = model(&grid());
    let points = circles(20, 400);
    let once = solved(&model, &points, &[1.0; 60], 20, &OPEN);
    // Start from the tenth frame: the later frames are as loud as before.
    let mut start = once[256 * 10..].to_vec();
    for code in &mut start[256..] {
        *code = 0;
    }
    let how = Ahead { ends: Ends::Held, ..OPEN };
    let again = ahead(&model, &points[30..], &[1.0; 30], 10, &how, Some(&start), &mut Control::none()).expect("codes");
    assert_eq!(again[..256], start[..256]);
    assert!(largest_step(&again, 256, &how) <= 8);
    check(&judged(&model, &points[30..], &[1.0; 30], &again, 256), 0.97);
    // A first frame whose field has nothing to do with the points still bounds the following frames.
    start.fill(7);
    let away = ahead(&model, &points[30..], &[1.0; 30], 10, &how, Some(&start), &mut Control::none()).expect("codes");
    assert!(away[..256].iter().all(|&code| code == 7));
    assert_eq!(largest_step(&away, 256, &how), 8);
}

#[test]
fn the_number_of_threads_changes_no_code() {
    let model = model(&grid());
    let points = circles(24, 24);
    let with = |threads: usize| {
        let mut control = Control::none().with_threads(threads);
        let closed = ahead(&model, &points, &[1.0; 72], 24, &CLOSED, None, &mut control).expect("codes");
        let fixed = Ahead { ends: Ends::Held, ..OPEN };
        [ahead(&model, &points, &[1.0; 72], 24, &fixed, Some(&closed), &mut control).expect("codes"), closed]
    };
    let alone = with(1);
    assert!([2, 3].into_iter().all(|threads| with(threads) == alone));
}

#[test]
fn a_stop_and_a_lack_of_memory_end_the_search() {
    let model = model(&grid());
    let points = circles(16, 400);
    let mut steps = 0;
    let mut observer = |progress: Progress<'_>| {
        steps = progress.step;
        assert_eq!(progress.steps, 7);
        assert!(progress.residual() < 0.01);
        if steps < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let answer = ahead(&model, &points, &[1.0; 48], 16, &OPEN, None, &mut Control::watched(&mut observer));
    assert_eq!((answer, steps), (Err(Error::stopped()), 3));
    let mut control = Control::none().with_memory(10_000);
    let answer = ahead(&model, &points, &[1.0; 48], 16, &OPEN, None, &mut control);
    assert!(answer.as_ref().is_err_and(|error| error.code == crate::ErrorCode::Memory), "{answer:?}");
}

#[test]
fn meaningless_arguments_are_rejected_by_name() {
    let model = model(&grid());
    let points = circles(4, 400);
    let text = |points: &[[f64; 3]], targets: &[f64], frames: usize, how: Ahead, start: Option<&[u16]>| {
        let answer = ahead(&model, points, targets, frames, &how, start, &mut Control::none());
        answer.expect_err("a refusal").to_string()
    };
    let how = |how: Ahead| text(&points, &[1.0; 12], 4, how, None);
    assert!(how(Ahead { change: -0.1, ..OPEN }).starts_with("change is -0.1: "));
    assert!(how(Ahead { change: f64::NAN, ..OPEN }).starts_with("change is NaN: "));
    assert!(how(Ahead { phases: 1, ..OPEN }).starts_with("phases is 1: "));
    assert!(how(Ahead { phases: 65_537, ..OPEN }).starts_with("phases is 65537: "));
    assert!(how(Ahead { rounds: 0, ..OPEN }).starts_with("rounds is 0: "));
    assert!(text(&points, &[1.0; 12], 1, OPEN, None).starts_with("frames is 1: "));
    assert!(text(&points, &[1.0; 12], 5, OPEN, None).starts_with("points is 12 points: "));
    assert!(text(&[], &[], 4, OPEN, None).starts_with("points is 0 points: "));
    assert!(text(&points, &[1.0; 11], 4, OPEN, None).starts_with("targets is 11 values: "));
    assert!(text(&points, &[0.0; 12], 4, OPEN, None).starts_with("targets is 0 everywhere: "));
    let mut targets = [1.0; 12];
    targets[7] = -1.0;
    assert!(text(&points, &targets, 4, OPEN, None).starts_with("targets[2, 1] is -1.0: "));
    targets[7] = f64::NAN;
    assert!(text(&points, &targets, 4, OPEN, None).starts_with("targets[2, 1] is NaN: "));
    let mut odd = points.clone();
    odd[7][0] = f64::INFINITY;
    assert!(text(&odd, &[1.0; 12], 4, OPEN, None).starts_with("points[2, 1]"), "not finite");
    odd[7] = model.array().positions()[5];
    let error = text(&odd, &[1.0; 12], 4, OPEN, None);
    assert!(error.starts_with("points[2, 1] is 0.000e0 m from transducer 5: "), "{error}");
    assert!(how(Ahead { ends: Ends::Held, ..OPEN }).starts_with("start is left out: "));
    assert!(text(&points, &[1.0; 12], 4, OPEN, Some(&[0; 3])).starts_with("start is 3 codes: "));
    let mut start = [0; 1024];
    start[300] = 256;
    assert!(text(&points, &[1.0; 12], 4, OPEN, Some(&start)).starts_with("start[1, 44] is 256: "));
    let off = self::model(&grid().with_mask(Some(vec![false; 256])).expect("a mask"));
    let error = ahead(&off, &points, &[1.0; 12], 4, &OPEN, None, &mut Control::none()).expect_err("a refusal");
    assert!(error.to_string().starts_with("points[0, 0] is reached by no transducer: "), "{error}");
}
