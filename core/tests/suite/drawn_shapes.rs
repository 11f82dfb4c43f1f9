//! Tests of common drawings with dense points: lines, rings, discs, grids and pictures, solved by `uniform`, `best` and
//! `descent`.

use std::f64::consts::TAU;

use midair::solvers::{Best, Descent, Uniform};
use midair::{Aim, Array, Control, Problem, Solution, Solve, Status, Workspace};

use crate::scenes::{problem, scene};

fn solved(problem: &Problem, solver: &dyn Solve) -> Solution {
    midair::solve(problem, solver, true, &mut Workspace::new(), &mut Control::none()).expect("an answer")
}

fn line(length: f64, step: f64) -> Vec<[f64; 3]> {
    let count = (length / step).round() as usize + 1;
    (0..count).map(|k| [k as f64 * step - 0.5 * length, 0.0, 0.15]).collect()
}

fn ring(count: usize, radius: f64) -> Vec<[f64; 3]> {
    let at = |k: usize| TAU * k as f64 / count as f64;
    (0..count).map(|k| [radius * at(k).cos(), radius * at(k).sin(), 0.15]).collect()
}

/// Returns a square grid of `across` x `across` points.
fn grid(across: usize, pitch: f64) -> Vec<[f64; 3]> {
    let at = |k: usize| (k as f64 - 0.5 * (across - 1) as f64) * pitch;
    (0..across * across).map(|k| [at(k % across), at(k / across), 0.15]).collect()
}

fn disc(radius: f64, pitch: f64) -> Vec<[f64; 3]> {
    let inside = |p: &[f64; 3]| p[0].hypot(p[1]) <= radius + 1e-9;
    grid(2 * (radius / pitch) as usize + 1, pitch).into_iter().filter(inside).collect()
}

/// Returns point sources at the positions of four AUTD3 boards.
fn array() -> Array {
    Array::new(Array::preset("autd3", [2, 2]).expect("a preset").positions().to_vec(), None).expect("positions")
}

/// Returns a problem where all points have the target `factor` times the balanced level.
fn requested(points: Vec<[f64; 3]>, factor: f64) -> Problem {
    let reach = problem(&scene(array(), points.clone(), None)).targets_in_pascals()[0];
    let pressures = vec![factor * reach; points.len()];
    problem(&scene(array(), points, Some(pressures)))
}

#[test]
#[ignore = "slow"]
fn dense_sets_are_met_up_to_the_balanced_level_and_by_a_board_too() {
    let sets = [line(0.08, 2.5e-3), line(0.022, 2e-3), ring(126, 0.04), disc(0.025, 4e-3), line(0.08, 5e-4)];
    for points in sets {
        let count = points.len();
        for factor in [0.5, 1.0] {
            let solution = solved(&requested(points.clone(), factor), &Uniform::default());
            let metrics = solution.metrics();
            assert_eq!(solution.status, Status::Done, "{count} points");
            assert!(metrics.residual.sqrt() <= 2e-3 && metrics.sigma <= 1e-3, "{count} points: {metrics:?}");
        }
    }
}

#[test]
#[ignore = "slow"]
fn discs_that_are_finer_than_the_field_are_met_and_loud() {
    // A start from random phases, or with all transducers in phase, would leave zeros between the points and errors of 0.02 to
    // 0.1.
    meet(disc(0.02, 2e-3));
    let loudest = solved(&requested(disc(0.02, 2e-3), 1.0).with_aim(Aim::Max), &Uniform::default()).metrics();
    assert!(loudest.uniformity >= 0.99 && loudest.level >= 1.65, "{loudest:?}");
}

#[test]
#[ignore = "slow"]
fn larger_discs_are_met_at_length() {
    meet(disc(0.03, 3e-3));
    meet(disc(0.05, 4e-3));
}

fn meet(points: Vec<[f64; 3]>) {
    let count = points.len();
    let solution = solved(&requested(points, 1.0), &Uniform::default());
    let metrics = solution.metrics();
    assert_eq!(solution.status, Status::Done, "{count} points");
    assert!(metrics.residual.sqrt() <= 2e-3 && metrics.sigma <= 1e-3, "{count} points: {metrics:?}");
}

#[test]
#[ignore = "slow"]
fn dense_sets_are_nearly_as_loud_as_the_best_that_is_known() {
    reach(&line(0.08, 2.5e-3), 1.34);
    reach(&disc(0.025, 4e-3), 1.38);
}

#[test]
#[ignore = "slow"]
fn a_dense_ring_is_nearly_as_loud_at_length() {
    reach(&ring(126, 0.04), 1.60);
}

/// Compares with the highest level, relative to the balanced level, that long runs of L-BFGS in f64 found.
fn reach(points: &[[f64; 3]], known: f64) {
    let highest = |solver: &dyn Solve| {
        let solution = solved(&requested(points.to_vec(), 1.0).with_aim(Aim::Max), solver);
        let metrics = solution.metrics();
        assert!(metrics.uniformity >= 0.99, "{metrics:?}");
        metrics.level * metrics.uniformity / known
    };
    let (usual, best) = (highest(&Uniform::default()), highest(&Best::default()));
    assert!(usual >= 0.93 && best >= 0.965 && best >= 0.999 * usual, "{} points: {usual} {best}", points.len());
}

#[test]
fn regular_sets_are_as_loud_as_the_best_of_many_starts() {
    let rings = (3..13).flat_map(|count| [0.01, 0.02, 0.03].map(|radius| ring(count, radius)));
    let grids = (2..5).flat_map(|across| [0.01, 0.02, 0.03].map(|pitch| grid(across, pitch)));
    let lines = (3..8).map(|count| line(0.015 * f64::from(count - 1), 0.015));
    let (mut sum, mut count) = (0.0, 0);
    for points in rings.chain(grids).chain(lines) {
        let level = |solver: &dyn Solve| {
            let metrics = solved(&requested(points.clone(), 1.0).with_aim(Aim::Max), solver).metrics();
            metrics.level * metrics.uniformity
        };
        let part = level(&Uniform::default()) / level(&Best::default());
        assert!((0.94..1.001).contains(&part), "{part} of {points:?}");
        (sum, count) = (sum + part, count + 1);
    }
    assert!(sum / f64::from(count) >= 0.99, "{sum} of {count}");
}

/// Returns a picture: a round spot with a bright diagonal. The brightest value is 1.
fn picture(across: usize) -> (Vec<[f64; 3]>, Vec<f64>) {
    let points = grid(across, 0.08 / (across - 1) as f64);
    let bright = |p: &[f64; 3]| {
        let blot = (1.0 - p[0].hypot(p[1]) / 0.04).max(0.0);
        if (p[0] - p[1]).abs() < 4e-3 { (blot + 0.3) / 1.3 } else { blot / 1.3 }
    };
    let values = points.iter().map(bright).collect();
    (points, values)
}

/// The relative error || |p| - target || / || target || over all points, including dark ones.
fn error(solution: &Solution) -> f64 {
    let pairs = || solution.pressures.iter().map(|p| f64::from(p.norm())).zip(solution.targets());
    let miss: f64 = pairs().map(|(p, target)| (p - target) * (p - target)).sum();
    (miss / pairs().map(|(_, target)| target * target).sum::<f64>()).sqrt()
}

#[test]
fn pictures_end_where_long_descents_end_and_the_default_takes_them_to_descent() {
    let (points, values) = picture(21);
    let ratios = problem(&scene(array(), points.clone(), Some(values.clone())));
    let factor = ratios.balance();
    let pressures = values.iter().map(|value| value * factor).collect();
    let problem = problem(&scene(array(), points, Some(pressures)));
    let (own, usual) = (solved(&problem, &Descent::default()), solved(&problem, &Uniform::default()));
    // For comparison, L-BFGS in f64 on the moduli reaches 0.038 to 0.058, with two seconds for each of ten starts.
    assert!(error(&own) <= 0.055, "{}", error(&own));
    assert_eq!(own.drive, usual.drive);
    // The status of missed targets is not `Done`.
    assert_eq!(usual.status, Status::Missed);
}

/// Returns points on the surface of a sphere of 12 mm.
fn shell(count: usize) -> Vec<[f64; 3]> {
    let turn = core::f64::consts::PI * (1.0 + 5.0_f64.sqrt());
    let on = |i: usize| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let (radius, angle) = ((1.0 - z * z).sqrt(), turn * (i as f64 + 0.5));
        [0.012 * radius * angle.cos(), 0.012 * radius * angle.sin(), 0.15 + 0.012 * z]
    };
    (0..count).map(on).collect()
}

#[test]
fn below_the_balanced_level_amplitudes_meet_what_phases_miss() {
    let chequers = |p: &[f64; 3]| 1.0 - ((p[0] + p[1]) / 4.25e-3).round().rem_euclid(2.0);
    let half = disc(0.02, 4.25e-3);
    let (picture, values) = picture(20);
    let scenes = [
        // For comparison, least squares over phases and amplitudes in f64, from four starts, reaches 0, 0.020 and 0.001.
        (half.clone(), half.iter().map(chequers).collect(), 0.9, 0.003),
        (shell(100), vec![1.0; 100], 0.9, 0.022),
        (picture, values, 0.3, 0.008),
    ];
    for (points, ratios, part, most) in scenes {
        let factor = part * problem(&scene(array(), points.clone(), Some(ratios.clone()))).balance();
        let pressures = ratios.iter().map(|ratio: &f64| ratio * factor).collect();
        let solution = solved(&problem(&scene(array(), points, Some(pressures))), &Uniform::default());
        let miss = error(&solution);
        assert!(miss <= most, "{miss} of {part}, at most {most}");
        assert_eq!(solution.status == Status::Missed, miss > 0.01, "{miss} {}", solution.status);
    }
}

#[test]
fn a_descent_lowers_the_error_to_what_can_be_met_and_hears_a_stop() {
    let problem = requested(disc(0.048, 4e-3), 1.0);
    let solution = solved(&problem, &Descent::default());
    assert!(error(&solution) <= 2e-3, "{}", error(&solution));
    let mut steps = 0;
    let mut stop = |_: midair::Progress<'_>| {
        steps += 1;
        if steps < 7 { core::ops::ControlFlow::Continue(()) } else { core::ops::ControlFlow::Break(()) }
    };
    let mut control = Control::watched(&mut stop);
    let stopped = midair::solve(&problem, &Descent::default(), true, &mut Workspace::new(), &mut control);
    let stopped = stopped.expect("an answer");
    assert_eq!((stopped.status, stopped.steps), (Status::Stopped, 7));
    assert!(error(&stopped) < 1.0, "{}", error(&stopped));
}
