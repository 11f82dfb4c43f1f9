//! Tests of `cover`: the start for a square of points and for a single point.

use num_complex::{Complex32, Complex64};

use crate::control::Control;
use crate::kernels::InstructionSet;
use crate::problem::Problem;
use crate::scene::{Array, Medium, Request, Scene};
use crate::solvers::common::cover::{Side, cover};
use crate::workspace::Workspace;

/// Returns the problem of 7 x 7 points, 4 mm apart, 15 cm above a square array.
fn square() -> Problem {
    let at = |k: usize| (k as f64 - 3.0) * 4e-3;
    let points = (0..49).map(|k| [at(k % 7), at(k / 7), 0.15]).collect();
    let array = Array::grid(16, 16, 1e-2).expect("a grid");
    Problem::of_scene(
        &Scene::new(array, Medium::default(), points, Request::default()).expect("a scene"),
        InstructionSet::best(),
        &mut Control::none(),
    )
    .expect("a problem")
}

/// Returns |p| of a drive at point j, in Pa.
fn pressure(problem: &Problem, drive: &[Complex32], j: usize) -> f64 {
    let term = |(i, q): (usize, &Complex32)| {
        problem.propagation().exact(j, i) * Complex64::new(f64::from(q.re), f64::from(q.im))
    };
    drive.iter().enumerate().map(term).sum::<Complex64>().norm()
}

#[test]
fn the_field_is_strong_at_every_point() {
    let (problem, work) = (square(), Workspace::new());
    let balanced = problem.targets_in_pascals()[0];
    for side in [Side::Behind, Side::Front] {
        let drive = cover(&problem, side, &work).expect("places are known");
        assert!(drive.iter().all(|q| (q.norm() - 1.0).abs() < 1e-6));
        for j in 0..49 {
            let pressure = pressure(&problem, &drive, j);
            assert!(pressure > 0.3 * balanced, "point {j}: {pressure} of {balanced} Pa");
        }
    }
}

#[test]
fn over_one_point_the_cone_is_its_focus() {
    let array = Array::grid(4, 4, 1e-2).expect("a grid");
    let scene = Scene::new(array, Medium::default(), vec![[0.0, 0.0, 0.1]], Request::default()).expect("a scene");
    let problem = Problem::of_scene(&scene, InstructionSet::best(), &mut Control::none()).expect("a problem");
    let drive = cover(&problem, Side::Front, &Workspace::new()).expect("places are known");
    let alone = (0..16).map(|i| problem.propagation().exact(0, i).norm()).sum::<f64>();
    assert!((pressure(&problem, &drive, 0) / alone - 1.0).abs() < 1e-6);
}
