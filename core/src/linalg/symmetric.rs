//! Eigenvalues and eigenvectors of a real symmetric 3 x 3 matrix, by Jacobi's rotations (Golub and Van Loan, section 8.5).

use crate::math::sqrt;

/// Number of sweeps over the three entries beside the diagonal: each squares their remaining size.
const SWEEPS: usize = 8;

/// Returns the eigenvalues, in no order, and the eigenvector of each, of length 1.
pub(crate) fn eigen(mut a: [[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        for [p, q] in [[0, 1], [0, 2], [1, 2]] {
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
            for k in 0..3 {
                (a[p][k], a[q][k]) = (cosine * a[p][k] - sine * a[q][k], sine * a[p][k] + cosine * a[q][k]);
                let (x, y) = (vectors[p][k], vectors[q][k]);
                (vectors[p][k], vectors[q][k]) = (cosine * x - sine * y, sine * x + cosine * y);
            }
        }
    }
    ([a[0][0], a[1][1], a[2][2]], vectors)
}

#[cfg(test)]
#[path = "tests/symmetric.rs"]
mod tests;
