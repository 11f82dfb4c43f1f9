//! Tests of `symmetric`.

use super::*;
use crate::rng::Rng;

#[test]
fn eigenvectors_are_stretched_by_their_eigenvalues() {
    let mut rng = Rng::new(4);
    let mut matrices = alloc::vec![[[0.0; 3]; 3], [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, -1.0]], [[1.0; 3]; 3]];
    for scale in [1.0, 1e-9, 1e9] {
        let [a, b, c, d, e, f] = core::array::from_fn(|_| scale * (2.0 * rng.uniform() - 1.0));
        matrices.push([[a, b, c], [b, d, e], [c, e, f]]);
        matrices.push([[a, 1e-9 * b, c], [1e-9 * b, a, 0.0], [c, 0.0, 1e4 * f]]);
    }
    for matrix in matrices {
        let (values, vectors) = eigen(matrix);
        let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        for (value, vector) in values.iter().zip(&vectors) {
            for (row, x) in matrix.iter().zip(vector) {
                let stretched: f64 = row.iter().zip(vector).map(|(a, x)| a * x).sum();
                assert!((stretched - value * x).abs() <= 1e-14 * largest, "{matrix:?}");
            }
            assert!((vector.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14);
        }
        let trace = matrix[0][0] + matrix[1][1] + matrix[2][2];
        assert!((values.iter().sum::<f64>() - trace).abs() <= 1e-14 * largest.max(f64::MIN_POSITIVE));
    }
}
