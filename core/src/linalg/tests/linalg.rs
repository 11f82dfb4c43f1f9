//! Tests of `linalg`.

use super::*;
use crate::rng::Rng;
use alloc::vec::Vec;
use num_complex::Complex64;

/// Returns a random Hermitian positive semidefinite matrix of rank at most `rank`, and the same stored conjugated.
pub(crate) fn random(count: usize, rank: usize, work: &Workspace) -> (Vec<Vec<Complex64>>, Planar<'_>) {
    let mut rng = Rng::new((count * 1000 + rank) as u64);
    let mut number = || 2.0 * rng.uniform() - 1.0;
    let columns: Vec<Vec<Complex64>> =
        (0..rank).map(|_| (0..count).map(|_| Complex64::new(number(), number())).collect()).collect();
    let entry = |k: usize, l: usize| columns.iter().map(|g| g[k] * g[l].conj()).sum::<Complex64>();
    let matrix: Vec<Vec<Complex64>> = (0..count).map(|k| (0..count).map(|l| entry(k, l)).collect()).collect();
    let mut stored = Planar::zeros(count, crate::kernels::lanes::padded(count), work);
    for k in 0..count {
        let [re, im] = stored.row_mut(k);
        for l in 0..count {
            (re[l], im[l]) = (matrix[k][l].re as f32, -matrix[k][l].im as f32);
        }
    }
    (matrix, stored)
}

pub(crate) fn entry(vector: &Planar, j: usize) -> Complex64 {
    Complex64::new(f64::from(vector.re[j]), f64::from(vector.im[j]))
}

pub(crate) fn apply(matrix: &[Vec<Complex64>], vector: &Planar, k: usize) -> Complex64 {
    matrix[k].iter().enumerate().map(|(l, entry_)| entry_ * entry(vector, l)).sum()
}

#[test]
fn a_hermitian_system_is_solved_at_every_size() {
    let work = Workspace::new();
    for count in 1..=40 {
        let (matrix, stored) = random(count, 2 * count, &work);
        let solver = Hermitian::new(InstructionSet::best(), &stored, count, 0.5, &work, &mut Control::none())
            .expect("it is not stopped")
            .expect("positive definite");
        let mut x = Planar::zeros(1, crate::kernels::lanes::padded(count), &work);
        for j in 0..count {
            (x.re[j], x.im[j]) = (1.0 + j as f32, 2.0 - j as f32);
        }
        solver.solve(&mut x);
        for k in 0..count {
            let exact = Complex64::new(1.0 + k as f64, 2.0 - k as f64);
            let got = apply(&matrix, &x, k) + 0.5 * entry(&x, k);
            // The solver is backward stable: the allowed error is the rounding times the norms of matrix and solution,
            // which stay below 1e3 here.
            assert!((got - exact).norm() < 1e-3 * count as f64, "{count}: {got} for {exact}");
        }
        assert!(x.re[count..].iter().all(|&x| x == 0.0));
    }
}

#[test]
fn a_matrix_that_is_not_positive_definite_is_rejected() {
    let work = Workspace::new();
    let (_, stored) = random(8, 2, &work);
    assert!(
        Hermitian::new(InstructionSet::best(), &stored, 8, -1.0, &work, &mut Control::none())
            .is_ok_and(|solver| solver.is_none())
    );
    let zeros = Cholesky::new(InstructionSet::best(), work.floats.take(256), 16, &mut Control::none());
    assert!(zeros.is_ok_and(|made| made.is_none()));
}

#[test]
fn a_matrix_that_is_not_finite_is_rejected() {
    let work = Workspace::new();
    let (_, mut stored) = random(8, 16, &work);
    assert!(Hermitian::damped(InstructionSet::best(), &stored, 8, -1.0, &work, &mut Control::none()).is_ok());
    stored.re[3] = f32::NAN;
    assert!(Hermitian::damped(InstructionSet::best(), &stored, 8, 0.5, &work, &mut Control::none()).is_err());
}
