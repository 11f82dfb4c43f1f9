//! Products with whole matrices, and the sweep of `fast`, compared with plain f64 loops.

use alloc::vec;
use alloc::vec::Vec;

use num_complex::{Complex32, Complex64};

use crate::control::Control;
use crate::kernels::closed_form;
use crate::kernels::closed_form::{Memory, Sweep};
use crate::kernels::lanes::padded;
use crate::kernels::matrix::{add_waves, correlate_rows};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tests::{LENGTHS, ROUNDING, numbers, wide};
use crate::rng::Rng;

/// A planar matrix of padded rows.
struct Matrix {
    re: Vec<f32>,
    im: Vec<f32>,
    rows: usize,
    columns: usize,
}

impl Matrix {
    fn new(rows: usize, columns: usize) -> Self {
        let mut rng = Rng::new((1000 * rows + columns) as u64);
        let mut list = || (0..rows).flat_map(|_| numbers(&mut rng, columns, -1.0, 1.0)).collect();
        Self { re: list(), im: list(), rows, columns }
    }

    fn rows(&self) -> Rows<'_> {
        Rows::Stored { re: &self.re, im: &self.im }
    }

    fn at(&self, row: usize, column: usize) -> Complex64 {
        let place = row * padded(self.columns) + column;
        Complex64::new(wide(self.re[place]), wide(self.im[place]))
    }
}

fn exact(z: Complex32) -> Complex64 {
    Complex64::new(wide(z.re), wide(z.im))
}

fn assert_close(got: Complex64, want: Complex64, terms: usize, what: &str) {
    // The allowed error: two products and sums for each term, of numbers below 2, and the sum over lanes.
    let allowed = 4.0 * ROUNDING * (terms + 8) as f64;
    assert!((got - want).norm() <= allowed, "{what}: {got} for {want}, allowed {allowed:e}");
}

#[test]
fn products_with_rows_are_their_sums() {
    for set in InstructionSet::all() {
        for count in LENGTHS {
            let matrix = Matrix::new(68 - count, count);
            let lanes = padded(count);
            let vector = Matrix::new(1, count);
            correlate_rows(set, [&matrix.re, &matrix.im], [&vector.re, &vector.im], &mut Control::none(), |k, got| {
                let want = (0..count).map(|j| matrix.at(k, j).conj() * vector.at(0, j)).sum();
                assert_close(exact(got), want, count, "correlate_rows");
            })
            .expect("it is not stopped");
            let factors: Vec<Complex32> =
                (0..matrix.rows).map(|k| Complex32::cis(k as f32) * if k % 5 == 4 { 0.0 } else { 0.5 }).collect();
            let want = |j: usize| (0..matrix.rows).map(|k| matrix.at(k, j) * exact(factors[k])).sum();
            let (mut re, mut im) = (vec![0.0; lanes], vec![0.0; lanes]);
            add_waves(set, matrix.rows(), &factors, [&mut re, &mut im], &mut Control::none())
                .expect("it is not stopped");
            for j in 0..count {
                assert_close(Complex64::new(wide(re[j]), wide(im[j])), want(j), matrix.rows, "add_waves");
            }
            assert!(re[count..].iter().chain(&im[count..]).all(|&x| x == 0.0), "padding was given sound");
        }
    }
}

/// Returns the new drives of some rows after a block of `fast`, computed by its formula from the field before.
fn block(
    matrix: &Matrix,
    requested: [&[f32]; 2],
    own: f64,
    old: &[Complex32],
    before: &[Complex64],
    rows: core::ops::Range<usize>,
) -> Vec<Complex64> {
    let [target, weight] = requested.map(|list| move |j: usize| wide(list[j]));
    let short = |j: usize| {
        let p = before[j];
        let phase = if p.norm() > 0.0 { p / p.norm() } else { Complex64::ONE };
        weight(j) * (target(j) * phase - p)
    };
    let sum = |i: usize| {
        let term = |j: usize| {
            let g = matrix.at(i, j);
            g.conj() * short(j) + own * weight(j) * g.norm_sqr() * exact(old[i])
        };
        (0..matrix.columns).map(term).sum::<Complex64>()
    };
    rows.map(sum).map(|sum| if sum.norm() > 0.0 { sum / sum.norm() } else { Complex64::ZERO }).collect()
}

#[test]
fn the_sweep_of_fast_is_its_formula() {
    const N: usize = 21;
    for set in InstructionSet::all() {
        for count in LENGTHS {
            let mut matrix = Matrix::new(N, count);
            let lanes = padded(count);
            // Transducer 4 has no effect at any point.
            matrix.re[4 * lanes..5 * lanes].fill(0.0);
            matrix.im[4 * lanes..5 * lanes].fill(0.0);
            let mut rng = Rng::new(count as u64);
            let (target, weight) = (numbers(&mut rng, count, 1.0, 5.0), numbers(&mut rng, count, 0.5, 1.0));
            let requested = [&target[..], &weight[..]];
            for size in [1, 3, 8] {
                let mut drive = vec![Complex32::ZERO; N];
                let (mut re, mut im) = (vec![0.0; lanes], vec![0.0; lanes]);
                let mut memory = vec![f32::NAN; closed_form::floats(lanes)];
                for own in [0.0, 0.4] {
                    let old = drive.clone();
                    let task = Sweep {
                        rows: matrix.rows(),
                        target: &target,
                        weight: &weight,
                        count,
                        block: size,
                        own,
                        phases: None,
                        memory: Memory::of(&mut memory),
                    };
                    // The field after each block; the formula starts from it at the next block.
                    let field = |[re, im]: [&[f32]; 2]| -> Vec<Complex64> {
                        (0..count).map(|j| Complex64::new(wide(re[j]), wide(im[j]))).collect()
                    };
                    let mut fields = vec![field([&re, &im])];
                    let step = |pressures: [&[f32]; 2]| {
                        fields.push(field(pressures));
                        true
                    };
                    assert!(closed_form::sweep(set, task, 0..N, &mut drive, [&mut re, &mut im], step));
                    assert_eq!(fields.len(), 1 + N.div_ceil(size));
                    for (step, fields) in fields.windows(2).enumerate() {
                        let rows = size * step..N.min(size * (step + 1));
                        let formula = block(&matrix, requested, wide(own), &old, &fields[0], rows.clone());
                        for (i, want) in rows.clone().zip(&formula) {
                            // A sum of terms up to 5 that nearly cancel has few digits left: the error is at most 1e-4.
                            assert!((exact(drive[i]) - want).norm() < 1e-4, "{set}: q of {i}, M = {count}");
                        }
                        for j in 0..count {
                            let moved = |i: usize| matrix.at(i, j) * (exact(drive[i]) - exact(old[i]));
                            let want = fields[0][j] + rows.clone().map(moved).sum::<Complex64>();
                            assert_close(fields[1][j], want, 4 * N, "the field after a block");
                        }
                    }
                }
                assert_eq!(drive[4], Complex32::ZERO);
            }
        }
    }
}
