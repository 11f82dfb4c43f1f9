//! Tests of `gauss_newton`.

use super::*;
use crate::solvers::common::tiled::tests::{Exact, random, wide};

#[test]
fn a_step_solves_the_damped_system() {
    let work = Workspace::new();
    for points in 1..=20 {
        let (problem, rows, mut wave) = random(points, 37, &work);
        let exact = Exact::new(&problem);
        wave.play_at_full(&rows, exact.drive(&wave).into_iter());
        let drive = exact.drive(&wave);
        let mut dual = Dual::new(&rows, 2 * points, &work, &mut Control::none()).expect("a few numbers");
        dual.factors[1][..points].fill(-1.0);
        dual.factors[0][points..].fill(1.0);
        dual.derive(&rows, &wave, (0..points).chain(0..points), None, &mut Control::none()).expect("it is not stopped");
        // Derivatives of Re P and Im P by the phase of transducer i: dP = j G q d.
        let slope = |e: usize, i: usize| {
            let wave = exact.gain(e % points, i) * wide(drive[i]);
            if e < points { -wave.im } else { wave.re }
        };
        let damping = |e: usize| 1.0 + e as f32;
        let factor = dual.factor(damping, &mut Control::none()).expect("it is not stopped").expect("positive definite");
        let mut y = work.floats.take(dual.lanes());
        (0..2 * points).for_each(|e| y[e] = 1.0 - 0.1 * e as f32);
        factor.solve(&mut y);
        let mut turns = work.floats.take_any(rows.lanes);
        let most = dual.back(&y, &mut turns);
        assert_eq!(most, turns.iter().fold(0.0, |most: f32, turn| most.max(turn.abs())));
        for i in 0..37 {
            let want: f64 = (0..2 * points).map(|e| slope(e, i) * f64::from(y[e])).sum();
            assert!((f64::from(turns[i]) - want).abs() < 1e-5, "{points}: turn {} for {want}", turns[i]);
        }
        for e in 0..2 * points {
            let product: f64 = (0..37).map(|i| slope(e, i) * f64::from(turns[i])).sum();
            let got = product + f64::from(damping(e) * y[e]);
            // The error is f32 rounding times the norm of the matrix, about a hundred.
            assert!((got - (1.0 - 0.1 * e as f64)).abs() < 1e-4, "{points}: equation {e}: {got}");
        }
    }
}
