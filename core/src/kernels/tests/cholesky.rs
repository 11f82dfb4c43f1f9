//! The Cholesky factor and its solutions compared with the matrix, for every instruction set and size.

use alloc::vec;
use alloc::vec::Vec;

use crate::control::Control;
use crate::kernels::cholesky;
use crate::kernels::lanes::{LANES, padded};
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tests::{LENGTHS, numbers, wide};
use crate::rng::Rng;

fn factor(set: InstructionSet, matrix: &mut [f32], size: usize) -> bool {
    cholesky::factor(set, matrix, size, &mut Control::none()).expect("it is not stopped")
}

#[test]
fn a_system_is_solved_at_every_size() {
    for set in InstructionSet::all() {
        for size in LENGTHS {
            let mut rng = Rng::new(size as u64);
            let lanes = padded(size);
            // The matrix A = B B^T + 1 has eigenvalues from 1 to about 4 size / 3.
            let rows: Vec<Vec<f32>> = (0..size).map(|_| numbers(&mut rng, size, -1.0, 1.0)).collect();
            let entry = |k: usize, l: usize| {
                let product: f64 = rows[k].iter().zip(&rows[l]).map(|(a, b)| wide(*a) * wide(*b)).sum();
                product + if k == l { 1.0 } else { 0.0 }
            };
            // Entries below the diagonal are not read.
            let mut matrix = vec![f32::NAN; size * lanes];
            for k in 0..size {
                (k..lanes).for_each(|l| matrix[k * lanes + l] = if l < size { entry(k, l) as f32 } else { 0.0 });
            }
            assert!(factor(set, &mut matrix, size), "{set} {size}");
            let exact = numbers(&mut rng, size, -1.0, 1.0);
            let mut x = exact.clone();
            cholesky::solve(set, &matrix, &mut x);
            for k in 0..size {
                let got: f64 = (0..size).map(|l| entry(k, l) * wide(x[l])).sum();
                // The solver is backward stable. The allowed error is the rounding of f32 times the norm of x and the
                // norm of the matrix, which is about size^2 at most.
                let allowed = 1e-6 * (size * size + 10) as f64;
                assert!((got - wide(exact[k])).abs() <= allowed, "{set} {size}: {got} for {}", exact[k]);
            }
            assert!(x[size..].iter().all(|&x| x == 0.0), "{set} {size}: the padding");
        }
    }
}

#[test]
fn a_matrix_that_is_not_positive_definite_is_rejected() {
    for set in InstructionSet::all() {
        // The matrix is the identity. Later one entry beside the diagonal is 1, too, which makes the matrix singular.
        let mut matrix = vec![0.0; 20 * padded(20)];
        (0..20).for_each(|k| matrix[k * padded(20) + k] = 1.0);
        assert!(factor(set, &mut matrix.clone(), 20));
        matrix[18 * padded(20) + 19] = 1.0;
        assert!(!factor(set, &mut matrix, 20), "{set}: {LANES}");
    }
}
