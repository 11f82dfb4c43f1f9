//! Double precision: products, factor and solutions compared with plain loops; all sets give the same bits.

use alloc::vec;
use alloc::vec::Vec;

use crate::control::Control;
use crate::kernels::InstructionSet;
use crate::kernels::double::{WIDE, add_products, factor, solve, times, times_adjoint};
use crate::rng::Rng;

fn numbers(rng: &mut Rng, count: usize) -> Vec<f64> {
    (0..count).map(|_| 2.0 * rng.uniform() - 1.0).collect()
}

#[test]
fn a_matrix_and_its_adjoint_times_a_vector_are_their_sums() {
    for (count, lanes) in [(1, WIDE), (3, 8), (16, 60), (33, 132)] {
        let mut rng = Rng::new(lanes as u64);
        let [re, im] = [(); 2].map(|()| numbers(&mut rng, count * lanes));
        let [qr, qi] = [(); 2].map(|()| numbers(&mut rng, lanes));
        let [pr, pi] = [(); 2].map(|()| numbers(&mut rng, count));
        let mut bits = Vec::new();
        for set in InstructionSet::all() {
            let [mut a, mut b, mut c, mut d] = [count, count, lanes, lanes].map(|len| vec![f64::NAN; len]);
            times(set, [&re, &im], [&qr, &qi], [&mut a, &mut b]);
            times_adjoint(set, [&re, &im], [&pr, &pi], [&mut c, &mut d]);
            for j in 0..count {
                let sum = |part: &dyn Fn(usize, usize) -> f64| (0..lanes).map(|i| part(j * lanes + i, i)).sum::<f64>();
                assert!((a[j] - sum(&|at, i| re[at] * qr[i] - im[at] * qi[i])).abs() < 1e-13 * lanes as f64);
                assert!((b[j] - sum(&|at, i| re[at] * qi[i] + im[at] * qr[i])).abs() < 1e-13 * lanes as f64);
            }
            for i in 0..lanes {
                let sum = |part: &dyn Fn(usize, usize) -> f64| (0..count).map(|j| part(j * lanes + i, j)).sum::<f64>();
                assert!((c[i] - sum(&|at, j| re[at] * pr[j] + im[at] * pi[j])).abs() < 1e-13 * count as f64);
                assert!((d[i] - sum(&|at, j| re[at] * pi[j] - im[at] * pr[j])).abs() < 1e-13 * count as f64);
            }
            bits.push([a, b, c, d]);
        }
        assert!(bits.iter().all(|each| *each == bits[0]));
    }
}

#[test]
fn products_are_factored_and_solved() {
    for (size, lanes) in [(4, 4), (8, 64), (20, 132), (36, 12), (68, 128)] {
        let mut rng = Rng::new(size as u64);
        let (rows, exact) = (numbers(&mut rng, size * lanes), numbers(&mut rng, size));
        let entry = |k: usize, l: usize| {
            let product: f64 = (0..lanes).map(|i| rows[i * size + k] * rows[i * size + l]).sum();
            product + if k == l { 0.5 } else { 0.0 }
        };
        let mut bits = Vec::new();
        for set in InstructionSet::all() {
            let (mut matrix, mut control) = (vec![0.0; size * size], Control::none());
            (0..size).for_each(|k| matrix[k * size + k] = 0.5);
            add_products(set, &rows, size, &mut matrix, &mut control).expect("no stop");
            for (k, l) in (0..size).flat_map(|k| (k..size).map(move |l| (k, l))) {
                assert!((matrix[k * size + l] - entry(k, l)).abs() < 1e-12);
            }
            // Entries below the diagonal are not read.
            (0..size).for_each(|k| matrix[k * size..k * size + k].fill(f64::NAN));
            assert!(factor(set, &mut matrix, size, &mut control).expect("no stop"));
            let mut b: Vec<f64> =
                (0..size).map(|k| (0..size).map(|l| entry(k.min(l), k.max(l)) * exact[l]).sum()).collect();
            solve(set, &matrix, &mut b);
            for (got, exact) in b.iter().zip(&exact) {
                // The condition number is below 1e4, so that ten digits are left.
                assert!((got - exact).abs() < 1e-10, "{size}: {got} for {exact}");
            }
            bits.push((matrix[0], b));
        }
        assert!(bits.iter().all(|each| *each == bits[0]));
    }
}

#[test]
fn a_matrix_that_is_not_positive_definite_has_no_factor() {
    for bad in [0.0, -1.0, f64::NAN] {
        for set in InstructionSet::all() {
            let mut matrix = vec![0.0; 16];
            (0..4).for_each(|k| matrix[k * 5] = if k == 2 { bad } else { 1.0 });
            assert!(!factor(set, &mut matrix, 4, &mut Control::none()).expect("no stop"));
        }
    }
}
