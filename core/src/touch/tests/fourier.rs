use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::Complex64;

use super::Fourier;
use crate::math::phasor;
use crate::rng::Rng;

#[test]
fn a_transform_agrees_with_its_definition_and_is_inverted() {
    for length in [1, 2, 8, 64] {
        let mut rng = Rng::new(length as u64);
        let line: Vec<Complex64> = (0..length).map(|_| Complex64::new(rng.uniform() - 0.5, rng.uniform())).collect();
        let mut spectrum = line.clone();
        Fourier::new(length).forward(&mut spectrum);
        for (k, value) in spectrum.iter().enumerate() {
            let turn = |i: usize| phasor(-TAU * (i * k) as f64 / length as f64);
            let exact: Complex64 = line.iter().enumerate().map(|(i, x)| x * turn(i)).sum();
            assert!((value - exact).norm() < 1e-12 * length as f64);
        }
        Fourier::new(length).backward(&mut spectrum);
        for (x, back) in line.iter().zip(&spectrum) {
            assert!((back / length as f64 - x).norm() < 1e-13);
        }
    }
}
