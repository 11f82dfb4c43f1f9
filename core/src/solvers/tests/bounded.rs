use alloc::vec;
use alloc::vec::Vec;

use num_complex::Complex64;

use super::Bounded;
use crate::control::Control;
use crate::math::phasor;
use crate::problem::{Problem, Setup, Solution, Status};
use crate::propagation::Propagation;
use crate::rng::Rng;
use crate::scene::Request;
use crate::solvers::solve::solve;
use crate::workspace::Workspace;

/// Returns a matrix of unit waves, `count` x `transducers`, and targets of random phases at `part` of sum |G| /
/// sqrt(M).
fn scene(count: usize, transducers: usize, part: f64, seed: u64) -> (Vec<Complex64>, Vec<Complex64>) {
    let mut rng = Rng::new(seed);
    let mut wave = || phasor(core::f64::consts::TAU * rng.uniform());
    let matrix = (0..count * transducers).map(|_| wave()).collect();
    let level = part * transducers as f64 / (count as f64).sqrt();
    (matrix, (0..count).map(|_| wave() * level).collect())
}

fn answer(matrix: &[Complex64], request: &Request, solver: &Bounded) -> Solution {
    let propagation = Propagation::from_matrix(matrix, request.pressures.as_ref().expect("pressures").len());
    let problem = Problem::with_propagation(propagation.expect("a matrix"), Setup::default(), request);
    solve(&problem.expect("a problem"), solver, false, &mut Workspace::new(), &mut Control::none()).expect("an answer")
}

/// Returns the least relative error, found by projected gradients with momentum and restarts, in plain loops.
fn least_error(matrix: &[Complex64], targets: &[Complex64], weights: &[f64]) -> f64 {
    let count = targets.len();
    let transducers = matrix.len() / count;
    let residual = |q: &[Complex64]| -> Vec<Complex64> {
        let field = |j: usize| (0..transducers).map(|i| matrix[j * transducers + i] * q[i]).sum::<Complex64>();
        (0..count).map(|j| targets[j] - field(j)).collect()
    };
    let heaviest = weights.iter().copied().fold(0.0, f64::max);
    let length = 1.0 / (heaviest * matrix.iter().map(Complex64::norm_sqr).sum::<f64>());
    let (mut q, mut ahead, mut momentum) =
        (vec![Complex64::ZERO; transducers], vec![Complex64::ZERO; transducers], 1.0);
    for _ in 0..4000 {
        let r = residual(&ahead);
        let next = |i: usize| {
            let pull = |j: usize| matrix[j * transducers + i].conj() * r[j] * weights[j];
            let moved = ahead[i] + (0..count).map(pull).sum::<Complex64>() * length;
            moved / moved.norm().max(1.0)
        };
        let next: Vec<Complex64> = (0..transducers).map(next).collect();
        let uphill: f64 = (0..transducers).map(|i| ((ahead[i] - next[i]).conj() * (next[i] - q[i])).re).sum();
        let later = if uphill > 0.0 { 1.0 } else { f64::midpoint(1.0, f64::sqrt(1.0 + 4.0 * momentum * momentum)) };
        let carry = if uphill > 0.0 { 0.0 } else { (momentum - 1.0) / later };
        ahead = (0..transducers).map(|i| next[i] + (next[i] - q[i]) * carry).collect();
        (q, momentum) = (next, later);
    }
    let norm = |values: &[Complex64]| values.iter().zip(weights).map(|(z, w)| w * z.norm_sqr()).sum::<f64>();
    (norm(&residual(&q)) / norm(targets)).sqrt()
}

#[test]
fn the_error_is_the_least_one_within_its_tolerance() {
    for (count, transducers, part, seed) in
        [(1, 5, 1.3, 1), (3, 8, 1.3, 2), (6, 20, 1.0, 3), (12, 40, 1.0, 4), (20, 9, 1.0, 5)]
    {
        let (matrix, targets) = scene(count, transducers, part, seed);
        let mut request = Request::of_complex(&targets);
        for weighted in [false, true] {
            let weights: Vec<f64> = (0..count).map(|j| if weighted { 1.0 + j as f64 } else { 1.0 }).collect();
            request.weights = weighted.then(|| weights.clone());
            let solution = answer(&matrix, &request, &Bounded::default());
            assert_ne!(solution.status, Status::OutOfSteps);
            let (error, least) = (solution.complex_error().expect("phases"), least_error(&matrix, &targets, &weights));
            assert!(least > 0.002, "M = {count} is too easy: {least}");
            // The reference itself is accurate to 1e-5; the solution is rounded to f32.
            assert!(error < 1.0011 * least && error > 0.9999 * least, "M = {count}: {error} for {least}");
        }
    }
}

#[test]
fn targets_within_reach_are_met() {
    for (count, transducers) in [(1, 3), (4, 60), (16, 200)] {
        let (matrix, targets) = scene(count, transducers, 0.3, 7);
        let solution = answer(&matrix, &Request::of_complex(&targets), &Bounded::default());
        assert_ne!(solution.status, Status::OutOfSteps);
        assert!(solution.complex_error().expect("phases") < 2e-5);
        for (p, target) in solution.pressures.iter().zip(&targets) {
            let p = Complex64::new(f64::from(p.re), f64::from(p.im));
            assert!((p - target).norm() < 1e-4 * target.norm(), "{p} for {target}");
        }
    }
}

#[test]
fn too_few_steps_are_reported_and_all_steps_stay_finite() {
    let (matrix, targets) = scene(12, 40, 1.0, 8);
    let with = |steps, tolerance| answer(&matrix, &Request::of_complex(&targets), &Bounded { steps, tolerance });
    assert_eq!(with(2, 1e-3).status, Status::OutOfSteps);
    let (usual, long) = (with(100, 1e-3), with(300, 0.0));
    assert_ne!(long.status, Status::OutOfSteps);
    assert_eq!(long.steps, 300);
    let [usual, long] = [usual, long].map(|solution| solution.complex_error().expect("phases"));
    assert!(long <= usual && usual < 1.001 * long, "{usual} and {long}");
}

#[test]
fn opposite_targets_in_one_place_give_pressures_of_0() {
    let matrix = [Complex64::ONE; 8];
    let targets = [Complex64::new(1.0, 0.0), Complex64::new(-1.0, 0.0)];
    let solution = answer(&matrix, &Request::of_complex(&targets), &Bounded::default());
    assert_eq!(solution.status, Status::Missed);
    assert!(solution.pressures.iter().all(|p| p.norm() < 1e-6), "{:?}", solution.pressures);
}
