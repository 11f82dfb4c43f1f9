//! Eigenvalues and eigenvectors of a small real symmetric matrix, by Jacobi's rotations (Golub and Van Loan, section 8.5).

use core::array::from_fn;

use crate::math::sqrt;

/// Number of sweeps over the entries above the diagonal: each squares their remaining size.
const SWEEPS: usize = 8;

/// Returns the eigenvalues, in no order, and the eigenvector of each, of length 1.
pub(crate) fn eigen<const N: usize>(mut a: [[f64; N]; N]) -> ([f64; N], [[f64; N]; N]) {
    let mut vectors = from_fn(|k| from_fn(|l| if k == l { 1.0 } else { 0.0 }));
    for _ in 0..SWEEPS {
        for [p, q] in (0..N).flat_map(|p| (p + 1..N).map(move |q| [p, q])) {
            if a[p][q] == 0.0 {
                continue;
            }
            // Two rotations make a_pq 0. This one has the smaller angle.
            let cotangent = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let tangent = f64::copysign(1.0, cotangent) / (cotangent.abs() + sqrt(cotangent * cotangent + 1.0));
            let cosine = 1.0 / sqrt(tangent * tangent + 1.0);
            let sine = tangent * cosine;
            for row in &mut a {
                (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
            }
            for k in 0..N {
                (a[p][k], a[q][k]) = (cosine * a[p][k] - sine * a[q][k], sine * a[p][k] + cosine * a[q][k]);
                let (x, y) = (vectors[p][k], vectors[q][k]);
                (vectors[p][k], vectors[q][k]) = (cosine * x - sine * y, sine * x + cosine * y);
            }
        }
    }
    (from_fn(|k| a[k][k]), vectors)
}

#[cfg(test)]
#[path = "tests/symmetric.rs"]
mod tests;
