//! Tests of `shifted`: sparse systems for many shifts compared with dense elimination in double precision.

use super::*;
use crate::rng::Rng;

/// Returns the Laplacian of a square lattice with random weights: starts, rows and values of its columns, and the dense
/// matrix.
fn lattice(side: usize, rng: &mut Rng) -> (Vec<usize>, Vec<u32>, Vec<f64>, Vec<Vec<f64>>) {
    let count = side * side;
    let mut dense = vec![vec![0.0; count]; count];
    for k in 0..count {
        for l in [k + 1, k + side].into_iter().filter(|&l| l < count && (l != k + 1 || l % side != 0)) {
            let weight = 0.5 + rng.uniform();
            (dense[k][l], dense[l][k]) = (-weight, -weight);
            dense[k][k] += weight;
            dense[l][l] += weight;
        }
    }
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for column in &dense {
        for (row, &value) in column.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            rows.push(row as u32);
            values.push(value);
        }
        starts.push(rows.len());
    }
    (starts, rows, values, dense)
}

/// Returns the solution x of a x = b by Gaussian elimination without pivoting.
fn eliminated(mut a: Vec<Vec<Complex64>>, mut b: Vec<Complex64>) -> Vec<Complex64> {
    let count = b.len();
    for k in 0..count {
        for i in k + 1..count {
            let factor = a[i][k] / a[k][k];
            for j in k..count {
                let above = a[k][j];
                a[i][j] -= factor * above;
            }
            let above = b[k];
            b[i] -= factor * above;
        }
    }
    for k in (0..count).rev() {
        b[k] = (b[k] - (k + 1..count).map(|j| a[k][j] * b[j]).sum::<Complex64>()) / a[k][k];
    }
    b
}

#[test]
fn each_shift_has_the_solution_of_dense_elimination() {
    let mut rng = Rng::new(7);
    let (starts, rows, values, dense) = lattice(9, &mut rng);
    let shares: Vec<f64> = (0..81).map(|_| 0.5 + rng.uniform()).collect();
    let system = Shifted::new(&starts, &rows, &values, &shares).expect("it is a matrix");
    // There are more shifts than lanes: 17 shifts of waves with losses, so that the last group has a single one.
    let shifts: Vec<Complex64> = (1..=17).map(|k| Complex64::new(-0.02, 0.008) * f64::from(k * k)).collect();
    let loads: Vec<Complex32> =
        (0..17 * 81).map(|_| Complex32::new(rng.uniform() as f32, rng.uniform() as f32)).collect();
    for set in InstructionSet::all() {
        let solutions = system.solve(set, &shifts, &loads, &mut Control::none()).expect("it is not stopped");
        for (k, &shift) in shifts.iter().enumerate() {
            let row = |i: usize| (0..81).map(move |j| (i, j));
            let entry =
                |(i, j): (usize, usize)| if i == j { dense[i][i] + shift * shares[i] } else { dense[i][j].into() };
            let full = (0..81).map(|i| row(i).map(entry).collect()).collect();
            let range = k * 81..(k + 1) * 81;
            let load = loads[range.clone()].iter().map(|z| Complex64::new(z.re.into(), z.im.into())).collect();
            let exact = eliminated(full, load);
            let largest = exact.iter().map(|z| z.norm()).fold(0.0, f64::max);
            for (value, exact) in solutions[range].iter().zip(exact) {
                let value = Complex64::new(value.re.into(), value.im.into());
                assert!((value - exact).norm() < 1e-4 * largest, "{set:?}, shift {k}: {value} {exact}");
            }
        }
    }
}

#[test]
fn wrong_columns_raise_errors_that_name_them() {
    let refused = |starts: &[usize], rows: &[u32], values: &[f64]| {
        Shifted::new(starts, rows, values, &[1.0; 2]).expect_err("it is wrong").to_string()
    };
    assert!(refused(&[0, 1], &[0], &[1.0]).starts_with("starts is 1 columns and 1 entries: give 2 columns"));
    assert!(refused(&[0, 1, 2], &[0, 2], &[1.0; 2]).starts_with("column 1 is not sorted: give rows below 2"));
    assert!(refused(&[0, 1, 2], &[0, 1], &[1.0, f64::NAN]).starts_with("values[1] is NaN: give finite values"));
    let system = Shifted::new(&[0, 1, 2], &[0, 1], &[1.0; 2], &[1.0; 2]).expect("it is a matrix");
    let few = system.solve(InstructionSet::best(), &[Complex64::i()], &[Complex32::i()], &mut Control::none());
    assert!(
        few.expect_err("it is too short")
            .to_string()
            .starts_with("loads is 1 numbers: give 2 for each of the 1 shifts")
    );
}
