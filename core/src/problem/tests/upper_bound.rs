//! Tests of `upper_bound`.

use super::*;

#[test]
fn the_largest_eigenvalue_is_bounded_from_above() {
    // The matrix u u^H + 0.5: the largest eigenvalue is |u|^2 + 0.5, the others are 0.5.
    for size in 1..=20 {
        let u: Vec<Complex64> = (0..size).map(|j| Complex64::new(1.0 + j as f64, 3.0 - j as f64)).collect();
        let mut matrix = vec![Complex64::ZERO; size * size];
        for j in 0..size {
            for k in 0..size {
                matrix[j * size + k] = u[j] * u[k].conj() + if j == k { 0.5 } else { 0.0 };
            }
        }
        let exact = u.iter().map(Complex64::norm_sqr).sum::<f64>() + 0.5;
        let bound = largest_eigenvalue(&matrix, size, &mut Control::none()).expect("no stop");
        assert!(bound >= exact * (1.0 - 1e-12) && bound <= exact * (1.0 + 2e-6), "{size}: {bound}");
        // With a NaN in the matrix the bound must be NaN.
        matrix[0] = Complex64::new(f64::NAN, 0.0);
        assert!(largest_eigenvalue(&matrix, size, &mut Control::none()).expect("no stop").is_nan());
    }
}
