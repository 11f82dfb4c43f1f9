//! Laws: what every registered solver guarantees. These tests name no solver, so a new one is tested as soon as it is
//! registered.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use midair::solvers::{Configured, Entry, SOLVERS};
use midair::{
    Array, Complex32, Complex64, Control, Error, Medium, Metrics, Options, Problem, Progress, Request, Scene, Solution,
    Start, Status, Transducer, Workspace,
};

use crate::oracle;
use crate::scenes::{preset, problem, propagation, random_points, scene, widen};

fn made(entry: &Entry) -> Configured {
    entry.configure(&Options::new()).expect("defaults")
}

fn solved(entry: &Entry, problem: &Problem, balance: bool) -> Solution {
    midair::solve(problem, &*made(entry).solver, balance, &mut Workspace::new(), &mut Control::none())
        .unwrap_or_else(|error| panic!("{}: {error}", entry.info.name))
}

fn raw(entry: &Entry, scene: &Scene) -> Solution {
    solved(entry, &problem(scene), false)
}

fn assert_usable(name: &str, solution: &Solution) {
    for (i, q) in solution.drive.iter().enumerate() {
        assert!(q.norm() <= 1.0 + 1e-6, "{name}: drive[{i}] is {q}");
        let (amplitude, phase) = (solution.amplitude(i), solution.phase(i));
        assert!((0.0..=1.0).contains(&amplitude) && (0.0..TAU).contains(&phase), "{name}: {amplitude} at {phase}");
    }
    assert!(solution.pressures.iter().all(|p| p.norm().is_finite()), "{name}: {:?}", solution.pressures);
    let Metrics { accuracy, sigma, uniformity, level, residual, leak } = solution.metrics();
    let metrics = [accuracy, sigma, uniformity, level, residual, leak];
    assert!(metrics.iter().all(|metric| metric.is_finite()), "{name}: {metrics:?}");
}

/// Returns `count` points that are at least 10 mm apart, more than a focal width.
fn apart(count: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for candidate in random_points(1000, 0.07, seed) {
        let near = |point: &[f64; 3]| (point[0] - candidate[0]).hypot(point[1] - candidate[1]) < 0.01;
        if points.len() < count && !points.iter().any(near) {
            points.push(candidate);
        }
    }
    points
}

fn request(pressures: &[f64]) -> Request {
    Request { pressures: Some(pressures.to_vec()), ..Request::default() }
}

#[test]
fn odd_scenes_get_finite_answers() {
    let small = || Array::grid(4, 4, 10e-3).expect("a grid");
    let at = |z: f64| vec![[0.0, 0.0, z], [0.01, 0.0, z], [0.01, 0.0, z]];
    let pair = vec![[0.0, 0.0, 0.1], [0.02, 0.0, 0.1]];
    let beside = Request { weights: Some(vec![1.0, 0.0]), ..Request::default() };
    let scenes = [
        ("N = 1", Array::grid(1, 1, 1e-2).expect("a grid"), at(0.1), Request::default()),
        ("M = 1", small(), vec![[0.0, 0.01, 0.12]], Request::default()),
        ("N = M = 1", Array::grid(1, 1, 1e-2).expect("a grid"), vec![[0.0, 0.0, 0.1]], request(&[1e3])),
        ("M > N", small(), random_points(40, 0.05, 3), Request::default()),
        ("coincident points", small(), at(0.1), request(&[100.0, 200.0, 300.0])),
        ("a quiet point", small(), at(0.12), request(&[100.0, 0.0, 50.0])),
        ("points behind", small(), at(-0.1), request(&[100.0, 200.0, 100.0])),
        ("weight 0 on a transducer", small(), vec![[0.0, 0.0, 0.1], [0.005, 0.005, 0.0]], beside.clone()),
        ("far too strong", small(), pair.clone(), request(&[1e6, 1e6])),
        ("far too weak", small(), pair.clone(), request(&[1e-6, 1e-6])),
        ("one a billion times the other", small(), pair, request(&[1e-3, 1e6])),
    ];
    for (what, array, points, request) in scenes {
        let scene = Scene::new(array, Medium::default(), points, request).expect("a scene");
        for entry in SOLVERS {
            for balance in [false, true] {
                assert_usable(&format!("{}, {what}", entry.info.name), &solved(entry, &problem(&scene), balance));
            }
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let scene = scene(preset("paper20"), random_points(9, 0.1, 4), None);
    for entry in SOLVERS {
        let mut work = Workspace::new();
        let mut again = || {
            let solver = made(entry).solver;
            midair::solve(&problem(&scene), &*solver, false, &mut work, &mut Control::none()).expect("an answer")
        };
        let first = again();
        assert_eq!(first.drive, again().drive, "{}", entry.info.name);
    }
}

#[test]
fn scaling_source_pressure_and_pressures_changes_no_drive() {
    let points = random_points(6, 0.1, 5);
    let scaled = |factor: f64| {
        let own = Transducer { source_pressure: 4.386 * factor, ..Transducer::default() };
        let array = Array::grid(12, 12, 10e-3).and_then(|array| array.with_transducer(own)).expect("an array");
        let pressures = (0..6).map(|j| 100.0 * factor * f64::from(j)).collect();
        problem(&scene(array, points.clone(), Some(pressures)))
    };
    for entry in SOLVERS {
        for balance in [false, true] {
            let (one, thousand) = (solved(entry, &scaled(1.0), balance), solved(entry, &scaled(1000.0), balance));
            assert_eq!(one.drive, thousand.drive, "{}", entry.info.name);
        }
    }
}

#[test]
fn one_strong_focus_gets_the_conjugate_phases() {
    let scene = scene(preset("paper20"), vec![[0.013, -0.021, 0.15]], Some(vec![2.0 * 2.4]));
    for entry in SOLVERS {
        let solution = raw(entry, &scene);
        // The phases may differ by a common phase: q_i G_i is compared with the phase of the whole field.
        let total: Complex64 = propagation(&scene).iter().zip(widen(&solution.drive)).map(|(g, q)| g[0] * q).sum();
        // Drives with few phases may be wrong by one step; others by the method's remaining error.
        let turns = (0..solution.drive.len()).map(|i| (solution.phase(i) / TAU * 65536.0).round() as i64 % 65536);
        let phases = turns.collect::<BTreeSet<_>>().len();
        let allowed = if phases <= 16 { TAU / phases as f64 } else { 0.01 };
        for (i, (g, q)) in propagation(&scene).iter().zip(widen(&solution.drive)).enumerate() {
            let off = (g[0] * q / total).arg().abs();
            // The phase of a drive of 0 would not be defined.
            assert!(q.norm() > 0.0, "{}: transducer {i} is left off", entry.info.name);
            assert!(off <= allowed, "{}: transducer {i} is {off} rad off", entry.info.name);
        }
    }
}

#[test]
fn reported_pressures_are_the_field_of_the_drive() {
    let crooked = scene(preset("autd3"), random_points(7, 0.1, 6), Some(vec![700.0; 7]));
    for entry in SOLVERS {
        for balance in [false, true] {
            let solution = solved(entry, &problem(&crooked), balance);
            let field = oracle::field(&propagation(&crooked), &widen(&solution.drive));
            let loudest = field.iter().map(|p| p.norm()).fold(0.0, f64::max);
            for (ours, theirs) in widen(&solution.pressures).iter().zip(&field) {
                // The tolerance is for 249 rows with phases accurate to 1e-4 rad and errors of random sign.
                assert!((ours - theirs).norm() < 1e-4 * loudest, "{}: {ours} for {theirs}", entry.info.name);
            }
        }
    }
}

#[test]
fn no_answer_is_worse_than_silence_where_all_can_be_had() {
    for seed in 0..5 {
        let scene = scene(Array::grid(14, 14, 10e-3).expect("a grid"), apart(8, seed), None);
        for entry in SOLVERS {
            let residual = raw(entry, &scene).metrics().residual;
            assert!(residual <= 1.0, "{}: residual {residual}", entry.info.name);
        }
    }
}

#[test]
fn a_stop_request_gives_a_usable_answer() {
    let scene = scene(preset("paper20"), random_points(5, 0.1, 7), None);
    for entry in SOLVERS {
        for stop in [1, 3] {
            let mut calls = 0;
            let mut observer = |progress: Progress| {
                calls += 1;
                assert!(progress.step <= progress.steps && progress.residual().is_finite());
                if progress.step >= stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let mut control = Control::watched(&mut observer);
            let made = made(entry);
            let solution = midair::solve(&problem(&scene), &*made.solver, false, &mut Workspace::new(), &mut control);
            let solution = solution.expect("an answer");
            assert_usable(entry.info.name, &solution);
            assert!(calls > 0, "{} never asks", entry.info.name);
            // A method with fewer steps ends by itself.
            if calls == stop {
                assert_eq!(solution.status, Status::Stopped, "{}", entry.info.name);
                assert_eq!(solution.steps, stop, "{}", entry.info.name);
            }
        }
    }
}

#[test]
fn a_trace_ends_in_the_residual_of_the_answer() {
    let weak = scene(preset("paper20"), random_points(5, 0.1, 8), Some(vec![0.1; 5]));
    for entry in SOLVERS {
        for balance in [false, true] {
            let mut control = Control::none().traced();
            let made = made(entry);
            let solution = midair::solve(&problem(&weak), &*made.solver, balance, &mut Workspace::new(), &mut control);
            let solution = solution.expect("an answer");
            let trace = control.into_trace().expect("a trace");
            assert_eq!(trace.len(), solution.steps, "{}", entry.info.name);
            let (last, residual) = (trace[trace.len() - 1], solution.metrics().residual);
            // The residual from the solver's own field may differ from one computed again in f32.
            assert!((last - residual).abs() < 1e-4 * residual.max(1.0), "{}: {last} for {residual}", entry.info.name);
        }
    }
}

#[test]
fn balancing_keeps_weak_foci_as_good_as_strong_ones() {
    let points = apart(6, 9);
    let strong = scene(preset("paper20"), points.clone(), None);
    let level = problem(&strong).targets_in_pascals()[0];
    let weak = scene(preset("paper20"), points, Some(vec![0.01 * level; 6]));
    assert!(problem(&weak).is_weak() && !problem(&strong).is_weak());
    for entry in SOLVERS {
        let (strong, weak) = (raw(entry, &strong).metrics(), solved(entry, &problem(&weak), true).metrics());
        // The drive is lowered to the targets. Rounding of the targets to f32 may change a choice that is nearly a tie.
        assert!((1.0 - weak.accuracy).abs() < 0.02, "{}: {strong:?} {weak:?}", entry.info.name);
        assert!(weak.sigma < strong.sigma + 0.02, "{}: {strong:?} {weak:?}", entry.info.name);
    }
}

#[test]
fn a_point_of_weight_0_and_a_common_factor_of_weights_change_no_bit() {
    let points = random_points(5, 0.1, 10);
    let with = |points: &[[f64; 3]], weights: Vec<f64>| {
        let request =
            Request { pressures: Some(vec![0.5; points.len()]), weights: Some(weights), ..Request::default() };
        problem(&Scene::new(preset("paper20"), Medium::default(), points.to_vec(), request).expect("a scene"))
    };
    let weights = vec![1.0, 2.0, 0.5, 1.0, 3.0];
    let padded = [&points[..2], &[[0.005, 0.005, 0.0]], &points[2..]].concat();
    for entry in SOLVERS {
        let plain = solved(entry, &with(&points, weights.clone()), false);
        let scaled = solved(entry, &with(&points, weights.iter().map(|w| 8.0 * w).collect()), false);
        assert_eq!(plain.drive, scaled.drive, "{}", entry.info.name);
        let padding = solved(entry, &with(&padded, vec![1.0, 2.0, 0.0, 0.5, 1.0, 3.0]), false);
        assert_eq!(plain.drive, padding.drive, "{}", entry.info.name);
        assert_eq!(plain.metrics(), padding.metrics(), "{}", entry.info.name);
        assert_eq!(padding.pressures.len(), 6);
    }
}

#[test]
fn dead_transducers_are_not_driven() {
    let mut response = vec![Complex64::from_polar(0.8, PI / 3.0); 400];
    for i in [0, 17, 399] {
        response[i] = Complex64::ZERO;
    }
    let array = preset("paper20").with_response(Some(response)).expect("responses");
    let scene = scene(array, random_points(4, 0.1, 11), None);
    for entry in SOLVERS {
        let drive = raw(entry, &scene).drive;
        for (i, q) in drive.iter().enumerate() {
            assert_eq!([0, 17, 399].contains(&i), *q == Complex32::ZERO, "{}: drive[{i}] = {q}", entry.info.name);
        }
    }
    // If all transducers are in phase at the start, the first drive may be the final one.
    let mask = Some(vec![false, true, true, true]);
    let array = Array::grid(2, 2, 10e-3).and_then(|array| array.with_mask(mask)).expect("a mask");
    let requested = problem(&self::scene(array, vec![[0.0, 0.0, 0.1]], None));
    for entry in SOLVERS {
        let start = Start::Drive(vec![Complex32::ONE; 4]);
        for requested in [requested.clone(), requested.clone().with_start(start).expect("a start")] {
            let drive = solved(entry, &requested, false).drive;
            assert!(drive[0] == Complex32::ZERO && drive[1] != Complex32::ZERO, "{}: {drive:?}", entry.info.name);
        }
    }
}

#[test]
fn what_cannot_be_answered_is_refused_before_any_solver() {
    let refused = |array: Array, points: Vec<[f64; 3]>, item: &str| {
        let error = Scene::new(array, Medium::default(), points, Request::default()).and_then(|s| Problem::new(&s));
        let error: Error = error.map(|_| ()).expect_err(item);
        let text = error.to_string();
        assert!(text.contains(item) && !text.contains('\n'), "{text}");
    };
    let grid = || Array::grid(4, 4, 10e-3).expect("a grid");
    let baffled = || {
        let directivity = midair::Directivity::T4010A1;
        grid().with_transducer(Transducer { directivity, ..Transducer::default() }).expect("a transducer")
    };
    refused(grid(), vec![], "points");
    refused(grid(), vec![[0.0, 0.0, f64::NAN]], "points[0].position");
    refused(grid(), vec![[0.0, 0.0, 0.1], [0.0, f64::INFINITY, 0.1]], "points[1].position");
    refused(grid(), vec![[0.0, 0.0, 0.1], [0.005, 0.005, 1e-6]], "points[1] is 1.000e-6 m from transducer 10");
    let dead = grid().with_response(Some(vec![Complex64::ZERO; 16])).expect("an array, if a useless one");
    refused(dead, vec![[0.0, 0.0, 0.1]], "points[0] is reached by no transducer");
    refused(baffled(), vec![[0.0, 0.0, 0.1], [0.0, 0.0, -0.1]], "points[1] is reached by no transducer");
    refused(grid(), vec![[0.0, 0.0, 1e9]], "points[0].position");
}

#[test]
fn phases_of_the_targets_change_the_answers_of_those_who_use_them() {
    let (points, level) = (apart(5, 12), 1.0);
    let requested = |phases: Option<Vec<f64>>| {
        let request = Request { pressures: Some(vec![level; 5]), phases, weights: None };
        problem(&Scene::new(preset("paper20"), Medium::default(), points.clone(), request).expect("a scene"))
    };
    let phases: Vec<f64> = (0..5).map(|j| 1.0 + f64::from(j * j)).collect();
    for entry in SOLVERS {
        let name = entry.info.name;
        let [free, zero, given, later] =
            [None, Some(vec![0.0; 5]), Some(phases.clone()), Some(phases.iter().map(|phase| phase + 0.7).collect())]
                .map(|phases| solved(entry, &requested(phases), false));
        assert!(free.complex_error().is_none() && given.complex_error().is_some(), "{name}");
        if !entry.uses_phases() {
            assert_eq!(free.drive, given.drive, "{name}");
            continue;
        }
        // Targets without phases are solved as targets of phase 0. A common phase added to all targets rotates all
        // drives by this phase.
        assert_eq!(free.drive, zero.drive, "{name}");
        assert!(free.drive != given.drive, "{name}");
        let errors = [&given, &later].map(|solution| solution.complex_error().expect("phases"));
        assert!(errors[0] < 0.5 && (errors[0] - errors[1]).abs() < 1e-3, "{name}: {errors:?}");
        for (own, later) in widen(&given.drive).iter().zip(widen(&later.drive)) {
            let turned = own * Complex64::cis(0.7);
            assert!((turned - later).norm() < 0.02, "{name}: {turned} and {later}");
        }
    }
}
