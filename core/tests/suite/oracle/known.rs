//! Tests of the reference for cases with known results.

use super::*;

/// Returns a square grid of n x n point sources with a pitch of 10 mm, centred in z = 0.
#[cfg(test)]
fn grid(n: usize) -> Model {
    let at = |m: usize| 0.01 * (m as f64 - 0.5 * (n - 1) as f64);
    Model {
        positions: (0..n * n).map(|m| [at(m % n), at(m / n), 0.0]).collect(),
        normals: vec![[0.0, 0.0, 1.0]; n * n],
        response: vec![Complex64::ONE; n * n],
        source_pressure: 1e-3,
        directivity: Directivity::Point,
        frequency: 40e3,
        sound_speed: 340.0,
        absorption: 0.0,
    }
}

#[test]
fn reach_of_known_arrays() {
    for (n, expected) in [(20, 2.36066), (36, 6.40341)] {
        assert!((reach(&propagation(&grid(n), &[[0.0, 0.0, 0.15]]))[0] - expected).abs() < 6e-6);
    }
}

#[test]
fn patterns_have_known_values() {
    for (m, d) in T4010A1.iter().enumerate() {
        let (sin, cos) = (m as f64 * PI / 18.0).sin_cos();
        assert!((pattern(Directivity::T4010a1, 740.0, cos, sin) - d).abs() < 1e-14);
    }
    assert!((pattern(Directivity::Piston(0.005), 740.0, 1.0, 0.0) - 1.0).abs() < 1e-14);
    assert!(pattern(Directivity::Cos(0.0), 740.0, -0.1, 1.0) == 0.0);
    for (x, j1) in [(1.0, 0.440_050_585_744_933_55), (60.0, 0.046_598_383_758_166_224)] {
        assert!((0.5 * x * jinc(x) - j1).abs() < 1e-13);
    }
}

#[test]
fn single_focus() {
    let propagation = propagation(&grid(20), &[[0.013, -0.008, 0.15]]);
    let order: Vec<usize> = (0..400).rev().collect();
    let search = Search {
        propagation: &propagation,
        targets: &[9.0],
        weights: &[1.0],
        phases: 16,
        amplitudes: 2,
        objective: Objective::L2,
        order: &order,
    };
    let (found, wanted) = (search.greedy(), naive(&propagation, &[9e3], AmplitudeLimit::Clamp));
    for (i, row) in propagation.iter().enumerate() {
        let turn = (found[i] * row[0]) * (found[399] * propagation[399][0]).conj();
        assert!(turn.arg().abs() <= TAU / 16.0 + 1e-9);
        assert!((wanted[i] - row[0].conj() / row[0].norm()).norm() < 1e-12);
    }
    assert!(search.regrets(&found).iter().all(|&regret| regret <= 1e-12));
    let worse: Vec<Complex64> = found.iter().map(|q| 0.5 * q).collect();
    assert!(search.regrets(&worse).iter().all(|&regret| regret > 1e-6));
}

#[test]
fn metrics_at_the_edges() {
    let some = metrics(&[1.0, 4.0, 0.5, 7.0], &[2.0, 4.0, 0.0, 1.0], &[1.0, 2.0, 1.0, 0.0]);
    let got = [some.accuracy, some.sigma, some.uniformity, some.level, some.residual, some.leak];
    for (value, expected) in got.iter().zip([5.0 / 6.0, 0.25, 0.5, 0.75, 1.0 / 36.0, 0.125]) {
        assert!((value - expected).abs() < 1e-15);
    }
    let silent = metrics(&[0.0], &[2.0], &[1.0]);
    assert!([silent.sigma, silent.uniformity, silent.level].iter().all(|&x| x == 0.0));
}
