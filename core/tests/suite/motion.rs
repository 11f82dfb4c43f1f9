//! Tests of motion, with fields in f64: bounds between consecutive frames, evenness, rest and errors.

use std::f64::consts::PI;

use midair::flight::{Course, Envelope};
use midair::points::Path;
use midair::solvers::{Glide, Last, Method};
use midair::touch::{Pushes, Touch};
use midair::{
    Aim, Array, Complex32, Complex64, Control, Frames, InstructionSet, Medium, Model, Problem, Quantization, Request,
    Session, Solve, SolveRequest, Start, Workspace,
};

use crate::scenes::{preset, problem, random_points, scene};

const SIDE: usize = 16;
const COUNT: usize = 3;

fn array(phases: Option<u32>) -> Array {
    let board = phases.map(|phases| Quantization::new(Some(phases), None).expect("phases"));
    Array::grid(SIDE, SIDE, 10e-3).expect("a grid").with_quantization(board)
}

/// Three points on circles of different radius at 0.5 m/s, with 10,000 frames per second.
fn circles(frames: usize) -> Vec<[f64; 3]> {
    let at = |t: usize, j: usize| {
        let (radius, middle) = (0.01 + 0.003 * j as f64, 0.04 * j as f64 - 0.04);
        let angle = 0.5 / radius * t as f64 / 10e3 + j as f64;
        [middle + radius * angle.cos(), radius * angle.sin(), 0.15]
    };
    (0..frames).flat_map(|t| (0..COUNT).map(move |j| at(t, j))).collect()
}

fn session(array: &Array, glide: Glide) -> Session {
    let model = Model::new(array, Medium::default(), InstructionSet::best()).expect("an array");
    Session::new(model, Box::new(glide) as Box<dyn midair::Solve + Send + Sync>, true)
}

fn followed(session: &mut Session, points: &[[f64; 3]]) -> Vec<Complex32> {
    let mut drives = vec![Complex32::ZERO; points.len() / COUNT * SIDE * SIDE];
    let frames = Frames { points, count: COUNT, ..Frames::default() };
    session.follow(frames, &mut SolveRequest::default(), &mut drives, &mut Control::none()).expect("drives");
    drives
}

/// The moduli |p| of a frame, computed in f64.
fn moduli(array: &Array, points: &[[f64; 3]], drive: &[Complex32]) -> Vec<f64> {
    let wavenumber = 2.0 * PI * 40e3 / Medium::default().sound_speed;
    let pressure = |point: &[f64; 3]| {
        let wave = |(from, q): (&[f64; 3], &Complex32)| {
            let distance = (0..3).map(|x| (point[x] - from[x]).powi(2)).sum::<f64>().sqrt();
            Complex64::cis(wavenumber * distance) / distance * Complex64::new(f64::from(q.re), f64::from(q.im))
        };
        array.positions().iter().zip(drive).map(wave).sum::<Complex64>().norm()
    };
    points.iter().map(pressure).collect()
}

fn change(a: Complex32, b: Complex32) -> f64 {
    f64::from((a * b.conj()).arg()).abs()
}

#[test]
fn points_in_motion_are_even_within_the_bound() {
    let points = circles(60);
    for (phases, even) in [(None, 0.999), (Some(256), 0.998), (Some(32), 0.97)] {
        let array = array(phases);
        let bound = PI / 16.0;
        let drives = followed(&mut session(&array, Glide { change: bound, ..Glide::default() }), &points);
        let frames: Vec<&[Complex32]> = drives.chunks(SIDE * SIDE).collect();
        for pair in frames.windows(2) {
            let largest = pair[0].iter().zip(pair[1]).map(|(a, b)| change(*a, *b)).fold(0.0, f64::max);
            assert!(largest <= bound + 1e-6, "{phases:?}: {largest}");
            if let Some(phases) = phases {
                let codes = largest * f64::from(phases) / (2.0 * PI);
                assert!((codes - codes.round()).abs() < 1e-3, "{codes} codes of {phases}");
            }
        }
        for (t, frame) in frames.iter().enumerate() {
            let received = moduli(&array, &points[t * COUNT..(t + 1) * COUNT], frame);
            let (low, high) = received.iter().fold((f64::MAX, 0.0_f64), |(low, high), &p| (low.min(p), high.max(p)));
            assert!(low / high > even, "{phases:?}, frame {t}: {}", low / high);
        }
    }
}

#[test]
fn above_the_speed_limit_points_are_still_even() {
    // Sixteen points move at 6 m/s. The largest phase change, pi/32 per frame, is enough for only 1.6 m/s.
    let at = |t: usize, j: usize| {
        let angle = 6.0 / 0.01 * t as f64 / 10e3 + j as f64;
        let middle = [j % 4, j / 4].map(|k| 0.03 * k as f64 - 0.045);
        [middle[0] + 0.01 * angle.cos(), middle[1] + 0.01 * angle.sin(), 0.19]
    };
    let points: Vec<[f64; 3]> = (0..60).flat_map(|t| (0..16).map(move |j| at(t, j))).collect();
    for phases in [None, Some(256)] {
        let array = array(phases);
        let mut drives = vec![Complex32::ZERO; 60 * SIDE * SIDE];
        let mut session = session(&array, Glide { change: PI / 32.0, ..Glide::default() });
        let frames = Frames { points: &points, count: 16, ..Frames::default() };
        session.follow(frames, &mut SolveRequest::default(), &mut drives, &mut Control::none()).expect("drives");
        for (t, frame) in drives.chunks(SIDE * SIDE).enumerate() {
            let received = moduli(&array, &points[16 * t..16 * (t + 1)], frame);
            let (low, high) = received.iter().fold((f64::MAX, 0.0_f64), |(low, high), &p| (low.min(p), high.max(p)));
            assert!(low / high > 0.99, "{phases:?}, frame {t}: {}", low / high);
        }
    }
}

#[test]
fn a_bound_below_a_phase_step_is_reported_once() {
    let remarks = |phases: u32, change: f64| {
        let array = array(Some(phases));
        let mut session = session(&array, Glide { change, ..Glide::default() });
        let frames = (0..2).flat_map(|_| {
            followed(&mut session, &circles(2));
            session.remarks().map(|remark| remark.to_string()).collect::<Vec<_>>()
        });
        frames.collect::<Vec<_>>()
    };
    let reported = remarks(10, PI / 16.0);
    assert!(
        reported.len() == 1 && reported[0].starts_with("change is 0.196 rad a frame, less than a step"),
        "{reported:?}"
    );
    assert!(remarks(10, 0.0).is_empty(), "one of 0 asks for it");
    assert!(remarks(10, PI / 5.0).is_empty());
    assert!(remarks(256, PI / 16.0).is_empty());
}

#[test]
fn points_at_rest_leave_every_code_where_it_is() {
    let points: Vec<[f64; 3]> = circles(1).into_iter().cycle().take(40 * COUNT).collect();
    let drives = followed(&mut session(&array(Some(256)), Glide::default()), &points);
    let frames: Vec<&[Complex32]> = drives.chunks(SIDE * SIDE).collect();
    assert!(frames[20..].windows(2).all(|pair| pair[0] == pair[1]));
    // With many points, the level that the search finds rises slowly from frame to frame. The phases remain those of
    // the first frame whose level was high enough.
    let many: Vec<[f64; 3]> = (0..4).flat_map(|t| circles(4)[t * COUNT..][..COUNT].to_vec()).collect();
    let spread = |j: usize, [x, y, z]: [f64; 3]| [x + 0.02 * (j / COUNT) as f64 - 0.03, y + 0.015 * (j % 5) as f64, z];
    let many: Vec<[f64; 3]> = many.iter().enumerate().map(|(j, &point)| spread(j, point)).collect();
    let points: Vec<[f64; 3]> = many.iter().copied().cycle().take(80 * many.len()).collect();
    let mut drives = vec![Complex32::ZERO; 80 * SIDE * SIDE];
    let frames = Frames { points: &points, count: many.len(), ..Frames::default() };
    let mut session = session(&array(Some(256)), Glide::default());
    session.follow(frames, &mut SolveRequest::default(), &mut drives, &mut Control::none()).expect("drives");
    let frames: Vec<&[Complex32]> = drives.chunks(SIDE * SIDE).collect();
    assert!(frames[20..].windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn no_change_keeps_the_drive_and_a_half_turn_frees_it() {
    let points = circles(30);
    let array = array(None);
    let kept = followed(&mut session(&array, Glide { change: 0.0, ..Glide::default() }), &points);
    assert!(kept.chunks(SIDE * SIDE).all(|frame| frame.iter().zip(&kept).all(|(a, b)| change(*a, *b) < 1e-3)));
    let free = |change: f64| followed(&mut session(&array, Glide { change, ..Glide::default() }), &points);
    assert_eq!(free(PI), free(10.0));
}

#[test]
fn a_frame_goes_on_from_a_drive_and_refuses_one_without_a_phase() {
    let array = array(None);
    let points = circles(2);
    let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("an array");
    let problem = |t: usize| {
        let own = &points[t * COUNT..(t + 1) * COUNT];
        Problem::of_model(&model, own, &Request::default(), &mut Control::none()).expect("a problem").with_aim(Aim::Max)
    };
    let solve = |problem: &Problem| {
        midair::solve(problem, &Glide::default(), true, &mut Workspace::new(), &mut Control::none())
    };
    let first = solve(&problem(0)).expect("a drive").drive;
    let after = |start: Vec<Complex32>| {
        solve(&problem(1).with_start(Start::Drive(start)).expect("a start")).expect("a drive").drive
    };
    let next = after(first.clone());
    // Only the phases of a start matter, even if the squares of its drives underflow.
    assert_eq!(after(first.iter().map(|q| q * 0.5_f32.powi(76)).collect()), next);
    assert!(first.iter().zip(&next).all(|(a, b)| change(*a, *b) <= PI / 16.0 + 1e-6));
    let mut off = first;
    off[7] = Complex32::ZERO;
    let refused = solve(&problem(1).with_start(Start::Drive(off)).expect("a start")).expect_err("no phase");
    assert!(refused.to_string().starts_with("start[7] is 0"), "{refused}");
}

#[test]
fn a_drive_to_begin_with_that_is_not_on_the_grid_ends_on_it() {
    let board = array(Some(8));
    let begun: Vec<Complex32> = (0..SIDE * SIDE).map(|i| Complex32::from_polar(0.3, i as f32)).collect();
    let request = Request { pressures: Some(vec![10.0; COUNT]), ..Request::default() };
    let model = Model::new(&board, Medium::default(), InstructionSet::best()).expect("an array");
    let problem = Problem::of_model(&model, &circles(1), &request, &mut Control::none()).expect("a problem");
    let problem = problem.with_start(Start::Drive(begun)).expect("a start");
    for change in [0.0, 0.1, PI / 4.0, PI] {
        let glide = Glide { change, ..Glide::default() };
        let solved =
            midair::solve(&problem, &glide, false, &mut Workspace::new(), &mut Control::none()).expect("drives");
        let eighths = |q: &Complex32| f64::from(q.arg()) / (PI / 4.0);
        assert!(solved.drive.iter().all(|q| (eighths(q) - eighths(q).round()).abs() < 1e-5), "{change}");
    }
}

#[test]
fn a_sequence_stopped_and_gone_on_with_has_the_same_bits() {
    let (points, array) = (circles(30), array(Some(256)));
    let glide = || Glide { tau: 2e-4, change: PI / 8.0, ..Glide::default() };
    let whole = followed(&mut session(&array, glide()), &points);
    let mut first = session(&array, glide());
    let begun = followed(&mut first, &points[..10 * COUNT]);
    let mut other = session(&array, glide());
    *other.last() = first.last().clone();
    let rest = followed(&mut other, &points[10 * COUNT..]);
    assert_eq!(whole, [begun, rest].concat());
}

#[test]
fn options_out_of_range_are_refused() {
    let refused = |name: &str, value: f64| {
        let options = midair::Options::from([(name.into(), midair::Value::Real(value))]);
        midair::solvers::find("glide").expect("glide").configure(&options).err().expect("refused").to_string()
    };
    assert!(refused("change", -0.1).starts_with("change is -0.1"));
    assert!(refused("tau", 1.0).starts_with("tau is 1: give at most 1e-1 s"), "{}", refused("tau", 1.0));
    assert!(refused("rate", 0.0).starts_with("rate is 0"));
}

#[test]
fn a_rate_of_frames_has_the_same_bounds_everywhere() {
    let (place, start) = ([[0.0, 0.0, 0.1]; 2], vec![Complex64::ONE]);
    let still = Path::still(&place, 1e4, None).expect("a path longer than any frame");
    let envelope = |rate: f64| Envelope { rate, tau: 2e-4, linear: false };
    for rate in [1e-300, 9.9e-3, 1.01e7, 1e300, f64::NAN, -1.0] {
        let refused = [
            midair::frame_rate(rate).err(),
            Path::through(place.to_vec(), 1, rate, false, None).err(),
            still.frames(rate).err(),
            midair::Pace { rate, change: Some(1.0), ..midair::Pace::default() }.bound().err(),
            Glide { rate, ..Glide::default() }.check().err(),
            Course::new(&place, 1, 8e-3, envelope(rate), false, start.clone()).err(),
            Pushes::new(9, rate, 1, &Control::none()).err(),
            Touch::of_frames(9000, rate, &[[0.0; 3]; 4], &mut |_| Ok(vec![0.0; 4]), &mut Control::none()).err(),
        ];
        let said = refused.map(|error| error.expect("refused").to_string());
        assert!(said[0].starts_with("rate is ") && said.iter().all(|text| text == &said[0]), "{said:?}");
    }
    for rate in [0.01, 1e7] {
        assert_eq!(midair::frame_rate(rate), Ok(rate));
    }
}

#[test]
fn frames_that_do_not_fit_and_points_that_are_not_there() {
    let array = array(None);
    let mut session = session(&array, Glide::default());
    let points = circles(2);
    let mut drives = vec![Complex32::ONE; 2 * SIDE * SIDE];
    let mut follow = |points: &[[f64; 3]], targets: Option<&[f64]>| {
        let frames = Frames { points, targets, count: COUNT, margin: 0, first: 0 };
        session.follow(frames, &mut SolveRequest::default(), &mut drives, &mut Control::none()).map(|()| drives.clone())
    };
    assert!(follow(&points[1..], None).is_err());
    let targets = [500.0, 0.0, 500.0, 0.0, 0.0, 0.0];
    let found = follow(&points, Some(&targets)).expect("drives");
    assert!(found[..SIDE * SIDE].iter().any(|q| q.norm() > 0.0));
    assert!(found[SIDE * SIDE..].iter().all(|q| *q == Complex32::ZERO), "a frame without points is silent");
    let mut lost = points.clone();
    lost[4] = [0.0, 0.0, f64::NAN];
    let error = follow(&lost, None).expect_err("not a number");
    assert!(error.to_string().starts_with("frames[1]: "), "{error}");
}

/// Points and pressures of a frame.
type Points<'a> = &'a dyn Fn(usize) -> (Vec<[f64; 3]>, Vec<f64>);

/// A point that appears, vanishes, jumps or gets another pressure: 30 frames later the field is as even as a cold solve's.
#[test]
fn a_field_is_even_again_after_any_change_of_points() {
    let array = preset("autd3").with_quantization(Some(Quantization::new(Some(256), None).expect("phases")));
    for (count, seed) in [(2, 1), (3, 2), (4, 3), (8, 4), (16, 5)] {
        let [before, after] = [0, 100].map(|more| random_points(count, 0.06, seed + more));
        let appears = |frame: usize| {
            let visible = |j: usize| if frame < 20 && j == count - 1 { 0.0 } else { 2000.0 };
            (before.clone(), (0..count).map(visible).collect::<Vec<f64>>())
        };
        let jumps = |frame: usize| (if frame < 20 { before.clone() } else { after.clone() }, vec![2000.0; count]);
        let differs = |frame: usize| {
            let pressure = |j: usize| if frame >= 20 && j.is_multiple_of(2) { 500.0 } else { 2000.0 };
            (before.clone(), (0..count).map(pressure).collect::<Vec<f64>>())
        };
        let joins = |frame: usize| {
            let known = if frame < 20 { count - 1 } else { count };
            (before[..known].to_vec(), vec![2000.0; known])
        };
        for (name, points) in
            [("appears", &appears as Points), ("jumps", &jumps), ("differs", &differs), ("joins", &joins)]
        {
            for bound in [PI / 16.0, PI / 8.0] {
                let glide = Glide { change: bound, ..Glide::default() };
                let (mut last, mut drive) = (Last::default(), Vec::new());
                for frame in 0..50 {
                    let (points, pressures) = points(frame);
                    let problem = problem(&scene(array.clone(), points, Some(pressures))).with_aim(Aim::Max);
                    let solution = glide
                        .follow(&problem, &mut last, &mut Workspace::new(), &mut Control::none())
                        .expect("a frame");
                    let most = solution.drive.iter().zip(&drive).map(|(q, last)| change(*q, *last)).fold(0.0, f64::max);
                    assert!(most <= bound + 1e-3, "{name}, M = {count}, frame {frame}: {most}");
                    drive.clone_from(&solution.drive);
                    let uniformity = solution.metrics().uniformity;
                    assert!(frame < 49 || uniformity > 0.99, "{name}, M = {count}, {bound}: {uniformity}");
                }
            }
        }
    }
}
