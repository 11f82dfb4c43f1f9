//! Around: the force on a small sphere at places in a ball, from the pressure on the ball's surface; sixteen balls at once.

use crate::kernels::flight::TERMS;
use crate::kernels::prelude::*;

/// Number of values at a place: the pressure and its derivatives up to the third, along [`WAYS`].
pub(crate) const VALUES: usize = 20;

/// The axes of each derivative among the values.
pub(crate) const WAYS: [&[usize]; VALUES] = [
    &[],
    &[0],
    &[1],
    &[2],
    &[0, 0],
    &[0, 1],
    &[0, 2],
    &[1, 1],
    &[1, 2],
    &[2, 2],
    &[0, 0, 0],
    &[0, 0, 1],
    &[0, 0, 2],
    &[0, 1, 1],
    &[0, 1, 2],
    &[0, 2, 2],
    &[1, 1, 1],
    &[1, 1, 2],
    &[1, 2, 2],
    &[2, 2, 2],
];

/// For each value up to the second derivatives, the index of its derivative along each axis.
const NEXT: [[usize; 3]; 10] = [
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 8],
    [6, 8, 9],
    [10, 11, 12],
    [11, 13, 14],
    [12, 14, 15],
    [13, 16, 17],
    [14, 17, 18],
    [15, 18, 19],
];

/// Matrices that turn the pressure on a ball into the force in it.
pub(crate) struct Ball {
    /// The matrix (P, [`VALUES`], D) that converts the pressures in D directions on the ball to the values at P places:
    /// real and imaginary parts.
    pub(crate) inside: alloc::vec::Vec<[f32; 2]>,
    /// The matrix ([`TERMS`], P) that converts numbers at P places to the coefficients of the polynomial fitted to
    /// them.
    pub(crate) through: alloc::vec::Vec<f32>,
    /// The number P of places.
    pub(crate) places: usize,
}

/// Writes the polynomials of the force on a sphere with the coefficients C of `response` into `out`, one ball in each lane, from the
/// real and imaginary pressures (D,) on the balls.
pub(crate) fn forces(
    set: InstructionSet,
    ball: &Ball,
    coefficients: [[f32; 2]; 3],
    sound: &[[Lanes; 2]],
    out: &mut [[Lanes; 3]; TERMS],
) {
    dispatch!(set, s => {
        let mut forces = vec![[[0.0; LANES]; 3]; ball.places];
        for (rows, force) in ball.inside.chunks_exact(VALUES * sound.len()).zip(&mut forces) {
            let mut values = [[s.splat(0.0); 2]; VALUES];
            for (pair, rows) in rows.chunks_exact(2 * sound.len()).enumerate() {
                let [first, second] = product(s, rows, sound);
                (values[2 * pair], values[2 * pair + 1]) = (first, second);
            }
            for axis in 0..3 {
                let mut sum = s.splat(0.0);
                for inner in 0..NEXT.len() {
                    let way = WAYS[inner];
                    let twice = if way.len() == 2 && way[0] != way[1] { 2.0 } else { 1.0 };
                    let [re, im] = coefficients[way.len()].map(|part| s.splat(twice * part));
                    let (a, b) = (values[inner], values[NEXT[inner][axis]]);
                    // Re(C conj(a) b).
                    sum = s.fma(re, s.fma(a[0], b[0], s.mul(a[1], b[1])), sum);
                    sum = s.fma(im, s.fnma(a[0], b[1], s.mul(a[1], b[0])), sum);
                }
                s.store(sum, &mut force[axis]);
            }
        }
        for (shares, out) in ball.through.chunks_exact(ball.places).zip(out) {
            let mut sums = [s.splat(0.0); 3];
            for (&share, force) in shares.iter().zip(&forces) {
                let share = s.splat(share);
                for axis in 0..3 {
                    sums[axis] = s.fma(share, s.load(&force[axis]), sums[axis]);
                }
            }
            for axis in 0..3 {
                s.store(sums[axis], &mut out[axis]);
            }
        }
    });
}

/// Returns the products of two rows with the pressures. The sums of both rows are independent, so the processor adds them
/// at the same time.
#[inline(always)]
fn product<S: Elementwise>(s: S, rows: &[[f32; 2]], sound: &[[Lanes; 2]]) -> [[S::V; 2]; 2] {
    let mut sums = [[s.splat(0.0); 2]; 2];
    let (first, second) = rows.split_at(sound.len());
    for ((a, b), pressure) in first.iter().zip(second).zip(sound) {
        let (re, im) = (s.load(&pressure[0]), s.load(&pressure[1]));
        for (row, sum) in [a, b].into_iter().zip(&mut sums) {
            let [own_re, own_im] = [s.splat(row[0]), s.splat(row[1])];
            sum[0] = s.fnma(own_im, im, s.fma(own_re, re, sum[0]));
            sum[1] = s.fma(own_im, re, s.fma(own_re, im, sum[1]));
        }
    }
    sums
}
