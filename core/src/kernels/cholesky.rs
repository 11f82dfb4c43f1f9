//! Cholesky factor U, A = U^T U, of a symmetric matrix A with padded rows, and the solution of A x = b.

use crate::kernels::prelude::*;

/// Number of lane groups of a row that stay in registers while multiples of the rows above are subtracted.
const WIDE: usize = 4;

/// Subtracts `above_ki above_k` of each row k above from a row, in N lane groups from group `at` on.
#[inline(always)]
fn reduce<S: Simd, const N: usize>(s: S, above: &[f32], row: &mut [f32], i: usize, at: usize) {
    let lanes = row.len();
    let part = &mut groups_mut(row)[at..at + N];
    let mut rest = [s.splat(0.0); N];
    for (rest, group) in rest.iter_mut().zip(&*part) {
        *rest = s.load(group);
    }
    for other in above.chunks_exact(lanes) {
        let factor = s.splat(other[i]);
        for (rest, other) in rest.iter_mut().zip(&groups(other)[at..at + N]) {
            *rest = s.fnma(factor, s.load(other), *rest);
        }
    }
    for (rest, group) in rest.into_iter().zip(part) {
        s.store(rest, group);
    }
}

/// Replaces the upper half of a symmetric matrix of `size` padded rows by its factor U. The lanes between the start of
/// the diagonal's lane group and the diagonal become 0. Returns `false` if the matrix is not positive definite in f32.
///
/// # Errors
/// A requested stop, which is checked once a row.
pub(crate) fn factor(set: InstructionSet, matrix: &mut [f32], size: usize, control: &mut Control) -> Result<bool> {
    dispatch!(set, s => {
        let lanes = padded(size);
        for i in 0..size {
            control.pulse()?;
            let (above, rest) = matrix.split_at_mut(i * lanes);
            let row = &mut rest[..lanes];
            let mut at = i / LANES;
            while at + WIDE <= lanes / LANES {
                reduce::<_, WIDE>(s, above, row, i, at);
                at += WIDE;
            }
            while at < lanes / LANES {
                reduce::<_, 1>(s, above, row, i, at);
                at += 1;
            }
            let pivot = row[i];
            if pivot.is_nan() || pivot <= 0.0 {
                return Ok(false);
            }
            let inverse = s.splat(1.0 / sqrtf(pivot));
            for group in &mut groups_mut(row)[i / LANES..] {
                s.store(s.mul(inverse, s.load(group)), group);
            }
            row[i / LANES * LANES..i].fill(0.0);
        }
        Ok(true)
    })
}

/// Replaces the padded vector b by the solution x of A x = b, given the factor U of A.
pub(crate) fn solve(set: InstructionSet, factor: &[f32], b: &mut [f32]) {
    dispatch!(set, s => {
        let lanes = b.len();
        for (i, row) in factor.chunks_exact(lanes).enumerate() {
            let x = b[i] / row[i];
            let value = s.splat(x);
            for (b, row) in groups_mut(b).iter_mut().zip(groups(row)).skip(i / LANES) {
                s.store(s.fnma(value, s.load(row), s.load(b)), b);
            }
            b[i] = x;
        }
        for (i, row) in factor.chunks_exact(lanes).enumerate().rev() {
            let rest = core::mem::take(&mut b[i]);
            let mut sum = s.splat(0.0);
            for (b, row) in groups(b).iter().zip(groups(row)).skip(i / LANES) {
                sum = s.fma(s.load(row), s.load(b), sum);
            }
            b[i] = (rest - s.reduce_add(sum)) / row[i];
        }
    });
}
