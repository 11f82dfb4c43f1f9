//! Dense linear algebra in double precision: complex matrix times vector, products of rows, a Cholesky factor.
//!
//! For systems whose condition is beyond f32. Plain loops over [`WIDE`] lanes without fused products: every instruction
//! set gives the same bits.

use crate::control::Control;
use crate::error::Error;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::math::sqrt;

/// Lanes: rows are padded to a multiple of them.
pub(crate) const WIDE: usize = 4;

/// Rows that meet two others, their sums in registers.
const BLOCK: usize = 4;

type Group = [f64; WIDE];

#[inline(always)]
fn groups(row: &[f64]) -> &[Group] {
    row.as_chunks().0
}

#[inline(always)]
fn groups_mut(row: &mut [f64]) -> &mut [Group] {
    row.as_chunks_mut().0
}

/// sum += a b, lane by lane.
#[inline(always)]
fn add(sum: &mut Group, a: &Group, b: &Group) {
    for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
        *sum += a * b;
    }
}

/// sum -= a b, lane by lane.
#[inline(always)]
fn subtract(sum: &mut Group, a: &Group, b: &Group) {
    for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
        *sum -= a * b;
    }
}

#[inline(always)]
fn total([a, b, c, d]: Group) -> f64 {
    (a + b) + (c + d)
}

/// out = G q, G the planar rows over as many lanes as q has.
pub(crate) fn times(set: InstructionSet, rows: [&[f64]; 2], vector: [&[f64]; 2], out: [&mut [f64]; 2]) {
    dispatch!(set, _s => {
        let lanes = vector[0].len();
        let [re, im] = rows.map(|plane| plane.chunks_exact(lanes));
        let [qr, qi] = vector.map(groups);
        let [out_re, out_im] = out;
        for ((re, im), (out_re, out_im)) in re.zip(im).zip(out_re.iter_mut().zip(out_im)) {
            let (mut real, mut imag) = ([0.0; WIDE], [0.0; WIDE]);
            for ((gr, gi), (qr, qi)) in groups(re).iter().zip(groups(im)).zip(qr.iter().zip(qi)) {
                add(&mut real, gr, qr);
                subtract(&mut real, gi, qi);
                add(&mut imag, gr, qi);
                add(&mut imag, gi, qr);
            }
            (*out_re, *out_im) = (total(real), total(imag));
        }
    });
}

/// out = G^H p, likewise.
pub(crate) fn times_adjoint(set: InstructionSet, rows: [&[f64]; 2], vector: [&[f64]; 2], out: [&mut [f64]; 2]) {
    dispatch!(set, _s => {
        let [out_re, out_im] = out;
        out_re.fill(0.0);
        out_im.fill(0.0);
        let [re, im] = rows.map(|plane| plane.chunks_exact(out_re.len()));
        for ((re, im), (pr, pi)) in re.zip(im).zip(vector[0].iter().zip(vector[1])) {
            let (pr, pi) = ([*pr; WIDE], [*pi; WIDE]);
            let sums = groups_mut(out_re).iter_mut().zip(groups_mut(out_im));
            for ((gr, gi), (real, imag)) in groups(re).iter().zip(groups(im)).zip(sums) {
                add(real, gr, &pr);
                add(real, gi, &pi);
                add(imag, gr, &pi);
                subtract(imag, gi, &pr);
            }
        }
    });
}

/// Adds the upper half of R R^T, R of `size` rows (a multiple of [`WIDE`]), to a matrix of as many.
///
/// # Errors
/// A stop, asked for once every few rows.
pub(crate) fn add_products(
    set: InstructionSet,
    rows: &[f64],
    size: usize,
    matrix: &mut [f64],
    control: &mut Control,
) -> Result<(), Error> {
    const PAIR: usize = 2;
    dispatch!(set, _s => {
        let lanes = rows.len() / size;
        let row = |k: usize| groups(&rows[k * lanes..(k + 1) * lanes]);
        for k in (0..size).step_by(BLOCK) {
            control.pulse()?;
            let left = [row(k), row(k + 1), row(k + 2), row(k + 3)];
            for l in (k..size).step_by(PAIR) {
                let right = [row(l), row(l + 1)];
                let mut sums = [[[0.0; WIDE]; PAIR]; BLOCK];
                for at in 0..lanes / WIDE {
                    for (sums, left) in sums.iter_mut().zip(left) {
                        for (sum, right) in sums.iter_mut().zip(right) {
                            add(sum, &left[at], &right[at]);
                        }
                    }
                }
                for (k, sums) in (k..).zip(sums) {
                    for (l, sum) in (l..).zip(sums) {
                        matrix[k * size + l] += total(sum);
                    }
                }
            }
        }
        Ok(())
    })
}

/// Replaces the upper half of a symmetric matrix of `size` rows (a multiple of [`WIDE`]) by its factor U, A = U^T U, with
/// zeros in the lanes before a row's diagonal; `false` if it is not positive definite.
///
/// # Errors
/// A stop, asked for once a row.
pub(crate) fn factor(
    set: InstructionSet,
    matrix: &mut [f64],
    size: usize,
    control: &mut Control,
) -> Result<bool, Error> {
    dispatch!(set, _s => {
        for i in 0..size {
            control.pulse()?;
            let (above, rest) = matrix.split_at_mut(i * size);
            let row = &mut rest[..size];
            // Four groups stay in registers while the rows above are taken from them.
            for (at, own) in (i / WIDE..).step_by(BLOCK).zip(groups_mut(row)[i / WIDE..].chunks_mut(BLOCK)) {
                let mut sums = [[0.0; WIDE]; BLOCK];
                if own.len() == BLOCK {
                    for other in above.chunks_exact(size) {
                        let factor = [other[i]; WIDE];
                        for (sum, other) in sums.iter_mut().zip(&groups(other)[at..at + BLOCK]) {
                            add(sum, &factor, other);
                        }
                    }
                } else {
                    for other in above.chunks_exact(size) {
                        let factor = [other[i]; WIDE];
                        for (sum, other) in sums.iter_mut().zip(&groups(other)[at..]) {
                            add(sum, &factor, other);
                        }
                    }
                }
                own.as_flattened_mut().iter_mut().zip(sums.as_flattened()).for_each(|(own, sum)| *own -= sum);
            }
            let pivot = row[i];
            if pivot.is_nan() || pivot <= 0.0 {
                return Ok(false);
            }
            let root = sqrt(pivot);
            row[i..].iter_mut().for_each(|own| *own /= root);
            row[i / WIDE * WIDE..i].fill(0.0);
        }
        Ok(true)
    })
}

/// Replaces b by A^-1 b.
pub(crate) fn solve(set: InstructionSet, factor: &[f64], b: &mut [f64]) {
    dispatch!(set, _s => {
        let size = b.len();
        for (i, row) in factor.chunks_exact(size).enumerate() {
            b[i] /= row[i];
            let x = b[i];
            b[i + 1..].iter_mut().zip(&row[i + 1..]).for_each(|(b, u)| *b -= x * u);
        }
        for (i, row) in factor.chunks_exact(size).enumerate().rev() {
            let mut sums = [0.0; WIDE];
            let own = core::mem::take(&mut b[i]);
            for (u, b) in groups(row).iter().zip(groups(b)).skip(i / WIDE) {
                add(&mut sums, u, b);
            }
            b[i] = (own - total(sums)) / row[i];
        }
    });
}
