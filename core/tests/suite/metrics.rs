//! Compares the reported metrics with a reference. Golden files only detect changes; these tests show that the values are
//! right.

use std::f64::consts::TAU;

use midair::solvers::{Greedy, Naive};
use midair::{
    Array, Complex32, Complex64, Control, Medium, Metrics, Precision, Problem, Request, Rng, Scene, Solution, Solve,
    Workspace,
};

use crate::oracle;
use crate::scenes::{preset, problem, propagation, random_points, scene, widen};

fn fields(metrics: Metrics) -> [(&'static str, f64); 6] {
    let Metrics { accuracy, sigma, uniformity, level, residual, leak } = metrics;
    [
        ("accuracy", accuracy),
        ("sigma", sigma),
        ("uniformity", uniformity),
        ("level", level),
        ("residual", residual),
        ("leak", leak),
    ]
}

fn assert_metrics(found: Metrics, wanted: oracle::Metrics, allowed: f64) {
    let oracle::Metrics { accuracy, sigma, uniformity, level, residual, leak } = wanted;
    let wanted = [accuracy, sigma, uniformity, level, residual, leak];
    for ((name, found), wanted) in fields(found).into_iter().zip(wanted) {
        assert!((found - wanted).abs() <= allowed * wanted.abs().max(1.0), "{name}: {found} for {wanted}");
    }
}

/// Random |p|, targets and weights of `count` points. About a third of the targets and of the weights are 0, but not those of
/// the first point.
fn readings(count: usize, seed: u64) -> [Vec<f64>; 3] {
    let mut rng = Rng::new(seed);
    [0.0, -1.0, -1.0].map(|low| {
        let mut list: Vec<f64> = (0..count).map(|_| (low + 3.0 * rng.uniform()).max(0.0)).collect();
        list[0] = list[0].max(0.1);
        list
    })
}

fn of(pressures: &[f64], targets: &[f64], weights: &[f64]) -> Metrics {
    let points = pressures.iter().zip(targets).zip(weights);
    Metrics::of(points.map(|((&pressure, &target), &weight)| (pressure, target, weight)))
}

#[test]
fn metrics_are_their_definitions_for_any_targets_and_weights() {
    let (mut quiet, mut uncounted) = (0, 0);
    for seed in 0..400 {
        let [pressures, targets, weights] = readings(1 + seed as usize % 40, seed);
        // The tolerance is for sums of at most 40 numbers in f64, in a different order.
        assert_metrics(of(&pressures, &targets, &weights), oracle::metrics(&pressures, &targets, &weights), 1e-12);
        quiet += targets.iter().filter(|&&target| target == 0.0).count();
        uncounted += weights.iter().filter(|&&weight| weight == 0.0).count();
    }
    assert!(quiet > 1000 && uncounted > 1000, "too few points of target {quiet} or weight {uncounted} 0");
}

#[test]
fn metrics_of_silence_and_of_one_point_are_as_agreed() {
    let silent = of(&[0.0, 0.0], &[1.0, 2.0], &[1.0, 1.0]);
    assert_eq!(fields(silent).map(|(_, value)| value), [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let single = of(&[3.0, 9.0], &[2.0, 9.0], &[1.0, 0.0]);
    assert_eq!(fields(single).map(|(_, value)| value), [1.5, 0.0, 1.0, 1.5, 0.25, 0.0]);
}

#[test]
fn metrics_do_not_depend_on_the_unit() {
    let [pressures, targets, weights] = readings(20, 1);
    let scaled = |list: &[f64], factor: f64| list.iter().map(|x| x * factor).collect::<Vec<_>>();
    let plain = fields(of(&pressures, &targets, &weights));
    // The squares of the first and the last factor exceed the range of f64.
    for factor in [1e-200, 1e-3, 1e3, 1e200] {
        for (pascals, weight) in [(factor, 1.0), (1.0, factor), (factor, factor)] {
            let other = of(&scaled(&pressures, pascals), &scaled(&targets, pascals), &scaled(&weights, weight));
            for ((name, plain), (_, other)) in plain.into_iter().zip(fields(other)) {
                assert!((plain - other).abs() < 1e-12, "{name} by {factor:e}: {other} for {plain}");
            }
        }
    }
}

/// Seven points above an AUTD3 board: one is quiet, one has weight 0, the others are unequal.
fn uneven() -> Scene {
    let pressures = vec![900.0, 300.0, 0.0, 500.0, 700.0, 400.0, 600.0];
    let weights = vec![1.0, 2.0, 3.0, 0.0, 0.5, 1.0, 1.5];
    let request = Request { pressures: Some(pressures), weights: Some(weights), ..Request::default() };
    let medium = Medium { sound_speed: 346.0, density: 1.2, ..Medium::default() };
    Scene::new(preset("autd3"), medium, random_points(7, 0.08, 3), request).expect("a scene")
}

fn solved(solver: &dyn Solve, problem: &Problem) -> Solution {
    solver.solve(problem, &mut Workspace::new(), &mut Control::none()).expect("an answer")
}

#[test]
fn an_answer_reports_the_metrics_and_radiation_of_its_pressures() {
    let problem = problem(&uneven());
    for solver in [&Greedy::default() as &dyn Solve, &Naive::default()] {
        let solution = solved(solver, &problem);
        let moduli: Vec<f64> = widen(&solution.pressures).iter().map(|p| p.norm()).collect();
        let wanted = oracle::metrics(&moduli, problem.targets_in_pascals(), problem.point_weights());
        assert_metrics(solution.metrics(), wanted, 1e-12);
        assert!(solution.metrics().leak > 0.0, "the quiet point must leak, or its metric is not tested");
        for (j, modulus) in moduli.iter().enumerate() {
            let radiation = modulus * modulus / (1.2 * 346.0 * 346.0);
            assert!((solution.radiation(j) - radiation).abs() <= 1e-12 * radiation);
        }
        assert_eq!(solution.targets(), problem.targets_in_pascals());
    }
}

#[test]
fn judge_gives_the_metrics_of_the_exact_field() {
    let scene = uneven();
    let problem = problem(&scene);
    let drive = solved(&Greedy::default(), &problem).drive;
    let moduli: Vec<f64> = oracle::field(&propagation(&scene), &widen(&drive)).iter().map(|p| p.norm()).collect();
    let wanted = oracle::metrics(&moduli, problem.targets_in_pascals(), problem.point_weights());
    // Both lists of metrics are computed in f64; the tolerance is for 249 phases of about 200 rad.
    assert_metrics(
        problem.judge(&drive, Precision::Double, &mut Control::none()).expect("its own drive"),
        wanted,
        1e-11,
    );
    for (bad, start) in [
        (drive[1..].to_vec(), "drive is 248 values"),
        ([&drive[..3], &[Complex32::new(f32::NAN, 0.0)], &drive[4..]].concat(), "drive[3] is"),
        ([&drive[..3], &[Complex32::new(0.8, 0.8)], &drive[4..]].concat(), "drive[3] is"),
    ] {
        let error = problem.judge(&bad, Precision::Double, &mut Control::none()).expect_err(start).to_string();
        assert!(error.starts_with(start) && !error.contains('\n'), "{error}");
    }
}

#[test]
fn amplitude_and_phase_are_the_drives_polar_form() {
    let solution = solved(&Naive::default(), &problem(&uneven()));
    let mut off = 0;
    for (i, q) in widen(&solution.drive).into_iter().enumerate() {
        let (amplitude, phase) = (solution.amplitude(i), solution.phase(i));
        assert!((0.0..=1.0).contains(&amplitude) && (0.0..TAU).contains(&phase));
        // Rounding in f32 may raise the modulus of a full drive above 1; it is reported as 1.
        assert!((Complex64::from_polar(amplitude, phase) - q).norm() < 2e-7, "{amplitude} at {phase} for {q}");
        off += usize::from(amplitude < 0.999);
    }
    assert!(off > 20, "all at full drive: the amplitude is not tested");
}

#[test]
fn balance_is_the_factor_to_the_balanced_level() {
    let scene = uneven();
    let problem = problem(&scene);
    let reach = oracle::reach(&propagation(&scene));
    let wanted = oracle::balanced_factor(&reach, problem.targets_in_pascals(), problem.point_weights());
    // The moduli in f32 are accurate to 2e-6 each.
    assert!((problem.balance() / wanted - 1.0).abs() < 1e-6, "{} for {wanted}", problem.balance());
}

#[test]
fn targets_below_half_the_balanced_level_are_weak() {
    let points = random_points(4, 0.08, 5);
    let level = problem(&scene(preset("autd3"), points.clone(), None)).targets_in_pascals()[0];
    for (share, weak) in [(0.01, true), (0.499, true), (0.501, false), (1.0, false), (100.0, false)] {
        let requested = problem(&scene(preset("autd3"), points.clone(), Some(vec![share * level; 4])));
        assert_eq!(requested.is_weak(), weak, "{share} of the balanced level");
        assert!((requested.balance() * share - 1.0).abs() < 1e-12);
    }
    let alone = scene(Array::grid(3, 3, 1e-2).expect("a grid"), vec![[0.0, 0.0, 0.1]], None);
    assert!(!problem(&alone).is_weak(), "nothing was requested");
}
