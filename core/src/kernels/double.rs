//! Dense linear algebra in double precision: complex matrix times vector, products of columns, a Cholesky factor.
//!
//! This module is for systems that are too ill-conditioned for f32. It has plain loops over [`WIDE`] lanes without
//! fused products: every instruction set gives the same bits. The loops use indices, because the compiler does not keep
//! the sums of iterators in registers.

use crate::kernels::prelude::*;

/// Number of lanes; rows are padded to a multiple of it.
pub(crate) const WIDE: usize = 4;

/// Number of lane groups of a row that stay in registers while other rows are added to it.
const BLOCK: usize = 8;

/// Number of lanes that [`divided`] computes at once.
pub(crate) const SPAN: usize = 16;

/// Largest number of rows that [`divided`] accepts.
pub(crate) const MOST_ROWS: usize = 25;

type Group = [f64; WIDE];

#[inline(always)]
fn groups(row: &[f64]) -> &[Group] {
    row.as_chunks().0
}

#[inline(always)]
fn groups_mut(row: &mut [f64]) -> &mut [Group] {
    row.as_chunks_mut().0
}

#[inline(always)]
fn total([a, b, c, d]: Group) -> f64 {
    (a + b) + (c + d)
}

/// out = G q for a complex matrix G and vector q. `rows` has the real and the imaginary rows of G, each as long as q.
pub(crate) fn times(set: InstructionSet, rows: [&[f64]; 2], vector: [&[f64]; 2], out: [&mut [f64]; 2]) {
    dispatch!(set, _s => {
        let lanes = vector[0].len();
        let [re, im] = rows.map(|plane| plane.chunks_exact(lanes));
        let [qr, qi] = vector.map(groups);
        let [out_re, out_im] = out;
        for ((re, im), (out_re, out_im)) in re.zip(im).zip(out_re.iter_mut().zip(out_im)) {
            let (mut real, mut imag) = ([0.0; WIDE], [0.0; WIDE]);
            for ((gr, gi), (qr, qi)) in groups(re).iter().zip(groups(im)).zip(qr.iter().zip(qi)) {
                for lane in 0..WIDE {
                    real[lane] += gr[lane] * qr[lane] - gi[lane] * qi[lane];
                    imag[lane] += gr[lane] * qi[lane] + gi[lane] * qr[lane];
                }
            }
            (*out_re, *out_im) = (total(real), total(imag));
        }
    });
}

/// out = G^H p for a complex matrix G and vector p, with `rows` as in [`times`].
pub(crate) fn times_adjoint(set: InstructionSet, rows: [&[f64]; 2], vector: [&[f64]; 2], out: [&mut [f64]; 2]) {
    dispatch!(set, _s => {
        let [out_re, out_im] = out;
        out_re.fill(0.0);
        out_im.fill(0.0);
        let [re, im] = rows.map(|plane| plane.chunks_exact(out_re.len()));
        for ((re, im), (&pr, &pi)) in re.zip(im).zip(vector[0].iter().zip(vector[1])) {
            let sums = groups_mut(out_re).iter_mut().zip(groups_mut(out_im));
            for ((gr, gi), (real, imag)) in groups(re).iter().zip(groups(im)).zip(sums) {
                for lane in 0..WIDE {
                    real[lane] += gr[lane] * pr + gi[lane] * pi;
                    imag[lane] += gr[lane] * pi - gi[lane] * pr;
                }
            }
        }
    });
}

/// Computes d_i = sqrt(`sum_r c_r row_ri`), no less than `least`, with the factors c. Writes the sum over i of
/// `row_ri/d_i` for each row r to `sums`, and returns the sum of d. The rows have a multiple of [`SPAN`] lanes.
pub(crate) fn divided(set: InstructionSet, rows: &[f64], factors: &[f64], least: f64, sums: &mut [f64]) -> f64 {
    dispatch!(set, _s => {
        let lanes = rows.len() / factors.len();
        let mut parts = [[0.0; SPAN]; MOST_ROWS];
        let mut whole = [0.0; SPAN];
        for at in 0..lanes / SPAN {
            let span = |r: usize| rows[r * lanes + at * SPAN..].first_chunk::<SPAN>().expect("a span");
            let mut d = [0.0; SPAN];
            for (r, factor) in factors.iter().enumerate() {
                let row = span(r);
                for lane in 0..SPAN {
                    d[lane] += factor * row[lane];
                }
            }
            let mut inverse = [0.0; SPAN];
            for lane in 0..SPAN {
                let square = if d[lane] > least * least { d[lane] } else { least * least };
                let root = sqrt(square);
                whole[lane] += root;
                inverse[lane] = 1.0 / root;
            }
            for (r, part) in parts.iter_mut().take(factors.len()).enumerate() {
                let row = span(r);
                for lane in 0..SPAN {
                    part[lane] += row[lane] * inverse[lane];
                }
            }
        }
        let all = |parts: [f64; SPAN]| parts.as_chunks().0.iter().map(|group| total(*group)).sum::<f64>();
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum = all(part));
        all(whole)
    })
}

/// Returns N lane groups, from group `at` on, of `sum_r row_ri row_r` over rows of `size` numbers.
#[inline(always)]
fn combined<const N: usize>(rows: &[f64], size: usize, i: usize, at: usize) -> [Group; N] {
    let mut sums = [[0.0; WIDE]; N];
    for row in rows.chunks_exact(size) {
        let factor = row[i];
        let part: &[Group; N] = groups(row)[at..].first_chunk().expect("as many groups");
        for k in 0..N {
            for lane in 0..WIDE {
                sums[k][lane] += factor * part[k][lane];
            }
        }
    }
    sums
}

/// Adds `sign sum_r row_ri row_r` to a row, from the lane group of entry `i` on.
#[inline(always)]
fn add_combined(rows: &[f64], i: usize, sign: f64, to: &mut [f64]) {
    let size = to.len();
    let to = groups_mut(to);
    let mut at = i / WIDE;
    while at + BLOCK <= to.len() {
        let sums = combined::<BLOCK>(rows, size, i, at);
        for k in 0..BLOCK {
            for lane in 0..WIDE {
                to[at + k][lane] += sign * sums[k][lane];
            }
        }
        at += BLOCK;
    }
    for at in at..to.len() {
        let [sum] = combined::<1>(rows, size, i, at);
        for lane in 0..WIDE {
            to[at][lane] += sign * sum[lane];
        }
    }
}

/// Adds the upper half of C^T C to a matrix of `size` rows. `rows` are the rows of C, each of `size` numbers, a
/// multiple of [`WIDE`].
///
/// # Errors
/// A requested stop, which is checked once a row.
pub(crate) fn add_products(
    set: InstructionSet,
    rows: &[f64],
    size: usize,
    matrix: &mut [f64],
    control: &mut Control,
) -> Result<()> {
    dispatch!(set, _s => {
        for (i, to) in matrix.chunks_exact_mut(size).enumerate() {
            control.pulse()?;
            add_combined(rows, i, 1.0, to);
        }
        Ok(())
    })
}

/// Replaces the upper half of a symmetric matrix A of `size` rows (a multiple of [`WIDE`]) by its factor U, A = U^T U.
/// The lanes before the diagonal in its lane group become 0. Returns `false` if A is not positive definite.
///
/// # Errors
/// A requested stop, which is checked once a row.
pub(crate) fn factor(set: InstructionSet, matrix: &mut [f64], size: usize, control: &mut Control) -> Result<bool> {
    dispatch!(set, _s => {
        for i in 0..size {
            control.pulse()?;
            let (above, rest) = matrix.split_at_mut(i * size);
            let row = &mut rest[..size];
            row[i / WIDE * WIDE..i].fill(0.0);
            add_combined(above, i, -1.0, row);
            let pivot = row[i];
            if pivot.is_nan() || pivot <= 0.0 {
                return Ok(false);
            }
            let root = sqrt(pivot);
            row[i..].iter_mut().for_each(|entry| *entry /= root);
            row[i / WIDE * WIDE..i].fill(0.0);
        }
        Ok(true)
    })
}

/// Replaces b by the solution x of A x = b, given the factor U of A.
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
            let x = core::mem::take(&mut b[i]);
            for (u, b) in groups(row).iter().zip(groups(b)).skip(i / WIDE) {
                for lane in 0..WIDE {
                    sums[lane] += u[lane] * b[lane];
                }
            }
            b[i] = (x - total(sums)) / row[i];
        }
    });
}
