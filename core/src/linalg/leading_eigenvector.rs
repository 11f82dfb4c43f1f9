//! The leading eigenvector of a Hermitian matrix, by the Lanczos method.

use crate::kernels;
use crate::kernels::InstructionSet;
use crate::linalg::{Planar, times};
use crate::prelude::*;
use crate::workspace::Workspace;

/// Number of Lanczos vectors in a cycle: enough for every eigenvalue gap in trials within a few cycles.
const CYCLE: usize = 24;

/// Replaces `vector` by the unit eigenvector of the largest eigenvalue of a Hermitian positive semidefinite matrix,
/// which is stored conjugated. The iteration starts from `vector`. It is restarted Lanczos with full
/// reorthogonalisation.
pub(crate) fn leading_eigenvector<'w>(
    set: InstructionSet,
    matrix: &Planar,
    vector: &mut Planar<'w>,
    count: usize,
    work: &'w Workspace,
    control: &mut Control,
) -> Result<()> {
    let lanes = matrix.lanes;
    let steps = CYCLE.min(count);
    let mut basis = Planar::zeros(steps, lanes, work);
    let mut next = Planar::zeros(1, lanes, work);
    for _ in 0..40 {
        let mut diagonal = [0.0_f64; CYCLE];
        let mut beside = [0.0_f64; CYCLE];
        if !normalise(set, vector) {
            break;
        }
        let mut used = 0;
        for step in 0..steps {
            let [re, im] = basis.row_mut(step);
            re.copy_from_slice(&vector.re);
            im.copy_from_slice(&vector.im);
            times(set, matrix, vector, &mut next, control)?;
            used = step + 1;
            // Two rounds make the new vector orthogonal up to rounding.
            for round in 0..2 {
                for k in 0..used {
                    let [re, im] = kernels::correlate(set, basis.row(k), next.row(0), count);
                    if round == 0 && k == step {
                        diagonal[step] = f64::from(re);
                    }
                    let [next_re, next_im] = [&mut next.re, &mut next.im];
                    kernels::accumulate(set, basis.row(k), [-re, -im], next_re, next_im);
                }
            }
            let length = norm(set, &next);
            beside[step] = f64::from(length);
            if step + 1 == steps || f64::from(length) <= 1e-6 * diagonal[0] {
                break;
            }
            core::mem::swap(vector, &mut next);
            normalise(set, vector);
        }
        let ritz = top_of_tridiagonal(&diagonal[..used], &beside[..used]);
        vector.re.fill(0.0);
        vector.im.fill(0.0);
        for (k, weight) in ritz.iter().enumerate().take(used) {
            kernels::accumulate(set, basis.row(k), [*weight as f32, 0.0], &mut vector.re, &mut vector.im);
        }
        // The residual of the Ritz vector, relative to the size of the eigenvalue.
        if (beside[used - 1] * ritz[used - 1]).abs() <= 1e-6 * diagonal[0] {
            break;
        }
    }
    normalise(set, vector);
    Ok(())
}

fn norm(set: InstructionSet, vector: &Planar) -> f32 {
    sqrtf(kernels::dot(set, &vector.re, &vector.re) + kernels::dot(set, &vector.im, &vector.im))
}

fn normalise(set: InstructionSet, vector: &mut Planar) -> bool {
    let length = norm(set, vector);
    if length > 0.0 {
        vector.re.iter_mut().chain(&mut vector.im).for_each(|x| *x /= length);
    }
    length > 0.0
}

/// Returns the unit eigenvector of the largest eigenvalue of a small symmetric tridiagonal matrix. It bisects by the
/// number of negative pivots, then iterates with the inverse from just above, where all pivots are positive.
fn top_of_tridiagonal(diagonal: &[f64], beside: &[f64]) -> [f64; CYCLE] {
    let n = diagonal.len();
    let off = |k: usize| if k < n - 1 { beside[k] } else { 0.0 };
    let radius = |k: usize| off(k) + if k > 0 { off(k - 1) } else { 0.0 };
    let mut high = (0..n).map(|k| diagonal[k] + radius(k)).fold(f64::MIN, f64::max);
    let mut low = diagonal.iter().copied().fold(f64::MIN, f64::max);
    let above = |x: f64| {
        let mut pivot = x - diagonal[0];
        (0..n).all(|k| {
            if k > 0 {
                pivot = x - diagonal[k] - off(k - 1) * off(k - 1) / pivot;
            }
            pivot > 0.0
        })
    };
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if above(middle) { high = middle } else { low = middle }
    }
    let shift = high + 1e-14 * high.abs() + f64::MIN_POSITIVE;
    let mut x = [0.0; CYCLE];
    x[..n].fill(1.0);
    for _ in 0..3 {
        let mut pivots = [0.0; CYCLE];
        pivots[0] = shift - diagonal[0];
        for k in 1..n {
            let ratio = off(k - 1) / pivots[k - 1];
            pivots[k] = shift - diagonal[k] - ratio * off(k - 1);
            x[k] += ratio * x[k - 1];
        }
        for k in (0..n).rev() {
            let below = if k + 1 < n { off(k) * x[k + 1] } else { 0.0 };
            x[k] = (x[k] + below) / pivots[k];
        }
        let length = sqrt(x[..n].iter().map(|x| x * x).sum());
        x[..n].iter_mut().for_each(|x| *x /= length);
    }
    x
}

#[cfg(test)]
#[path = "tests/leading_eigenvector.rs"]
mod tests;
