//! Tests of `leading_eigenvector`.

use super::*;
use crate::linalg::tests::{apply, entry, random};
use alloc::vec::Vec;
use num_complex::Complex64;

#[test]
fn the_leading_eigenvector_is_found_at_every_size() {
    let work = Workspace::new();
    for count in 1..=60 {
        for rank in [1, 2 * count] {
            let (matrix, stored) = random(count, rank, &work);
            let mut vector = Planar::zeros(1, crate::kernels::lanes::padded(count), &work);
            vector.re[..count].fill(1.0);
            leading_eigenvector(InstructionSet::best(), &stored, &mut vector, count, &work, &mut Control::none())
                .expect("it is not stopped");
            let value = (0..count).map(|k| (entry(&vector, k).conj() * apply(&matrix, &vector, k)).re).sum::<f64>();
            let residual = (0..count).map(|k| (apply(&matrix, &vector, k) - value * entry(&vector, k)).norm_sqr());
            // The error is that of f32 products of vectors of length 1, relative to the eigenvalue.
            assert!(residual.sum::<f64>().sqrt() < 2e-5 * value, "{count}, rank {rank}");
            // No other direction has a larger Rayleigh quotient: a hundred products from another start find none.
            let mut other: Vec<Complex64> = (0..count).map(|j| Complex64::new(1.0, j as f64 - 3.0)).collect();
            for _ in 0..100 {
                let image = matrix.iter().map(|row| row.iter().zip(&other).map(|(a, b)| a * b).sum::<Complex64>());
                let image: Vec<Complex64> = image.collect();
                let length = image.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
                other = image.into_iter().map(|z| z / length.max(1e-300)).collect();
            }
            let image = matrix.iter().map(|row| row.iter().zip(&other).map(|(a, b)| a * b).sum::<Complex64>());
            let quotient = image.zip(&other).map(|(a, b)| (b.conj() * a).re).sum::<f64>();
            assert!(quotient <= value * (1.0 + 1e-5), "{count}: {quotient} above {value}");
        }
    }
}
