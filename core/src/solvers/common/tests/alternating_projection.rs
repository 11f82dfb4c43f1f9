//! Tests of `alternating_projection`.

use super::*;
use crate::scene::Start;
use crate::solvers::common::tiled::tests::{Exact, random, wide};
use num_complex::Complex64;

/// Returns b_i/|b_i| with b = G^H p, in f64.
fn back(exact: &Exact, wanted: &[Complex64], i: usize) -> Complex64 {
    let sum: Complex64 = wanted.iter().enumerate().map(|(j, p)| exact.gain(j, i).conj() * p).sum();
    sum / sum.norm()
}

#[test]
fn a_projection_keeps_the_phases_and_takes_the_moduli() {
    let work = Workspace::new();
    for points in 1..=20 {
        let (problem, rows, mut wave) = random(points, 37, &work);
        let exact = Exact::new(&problem);
        let mut projector = Projector::new(&rows, &work);
        let moduli: Vec<f32> = (0..points).map(|j| j as f32).collect();
        let field = |j: usize| wide(Complex32::new(wave.field[0][j], wave.field[1][j]));
        let wanted: Vec<Complex64> = (0..points).map(|j| field(j) / field(j).norm() * f64::from(moduli[j])).collect();
        projector.want(&wave, &moduli);
        projector.project(&rows, &mut wave);
        assert!(exact.miss(&rows, &wave) < 1e-4, "{points}");
        // A single point has the modulus 0, so the drive of its projection is arbitrary.
        for (i, q) in exact.drive(&wave).into_iter().enumerate().filter(|_| points > 1) {
            assert!((wide(q) - back(&exact, &wanted, i)).norm() < 1e-4, "{points}: {i}");
        }
    }
}

#[test]
fn a_start_is_a_drive_as_it_is_or_the_projection_of_phases() {
    let work = Workspace::new();
    let (problem, rows, wave) = random(7, 37, &work);
    let given = Exact::new(&problem).drive(&wave);
    let mut projector = Projector::new(&rows, &work);
    assert!(projector.start(&problem, &rows, &work, &mut Control::none()).expect("it is not stopped").is_none());
    let plain = projector.begin(&problem, &rows, &work, &mut Control::none()).expect("it is not stopped");
    assert!(Exact::new(&problem).drive(&plain).iter().all(|q| *q == Complex32::ONE));
    let started = problem.clone().with_start(Start::Drive(given.clone())).expect("a start");
    let wave =
        projector.start(&started, &rows, &work, &mut Control::none()).expect("it is not stopped").expect("a wave");
    assert_eq!(Exact::new(&started).drive(&wave), given);
    let phases: Vec<f64> = (0..7).map(f64::from).collect();
    let started = problem.with_start(Start::Phases(phases.clone())).expect("a start");
    let wave =
        projector.start(&started, &rows, &work, &mut Control::none()).expect("it is not stopped").expect("a wave");
    let exact = Exact::new(&started);
    let wanted: Vec<Complex64> = phases
        .iter()
        .zip(started.targets())
        .map(|(&phase, &target)| Complex64::from_polar(f64::from(target), phase))
        .collect();
    for (i, q) in exact.drive(&wave).into_iter().enumerate() {
        assert!((wide(q) - back(&exact, &wanted, i)).norm() < 1e-4, "{i}");
    }
}
