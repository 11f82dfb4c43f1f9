//! Tests of `products`.

use super::*;
use crate::kernels::InstructionSet;
use crate::rng::Rng;
use num_complex::Complex64;

#[test]
fn gram_is_the_weighted_conjugate_product() {
    let work = Workspace::new();
    let mut rng = Rng::new(1);
    for (set, count) in InstructionSet::all().flat_map(|set| (1..=67).map(move |count| (set, count))) {
        // One run of tiles, and two with a rest.
        for transducers in [1, 37, 530] {
            let mut number = || 2.0 * rng.uniform() - 1.0;
            let matrix: Vec<Complex64> = (0..count * transducers).map(|_| Complex64::new(number(), number())).collect();
            let propagation = Propagation::from_matrix(&matrix, count).expect("propagation").with_instruction_set(set);
            let unit = 1.0 / propagation.reference();
            let factors: Vec<f32> = (0..transducers).map(|i| 0.25 + (i % 3) as f32).collect();
            for factors in [None, Some(&factors[..])] {
                // Twice, over dirty memory.
                drop(gram(&propagation, factors, &work, &mut Control::none()).expect("nobody stops it"));
                let product = gram(&propagation, factors, &work, &mut Control::none()).expect("nobody stops it");
                for k in (0..count).step_by(1 + count / 9) {
                    for l in 0..count {
                        let factor = |i: usize| factors.map_or(1.0, |factors| f64::from(factors[i]));
                        let at = |k: usize, i: usize| matrix[k * transducers + i] * unit;
                        let want: Complex64 = (0..transducers).map(|i| at(k, i).conj() * at(l, i) * factor(i)).sum();
                        let [re, im] = product.row(k).map(|row| f64::from(row[l]));
                        // Terms below 8, some two roundings each.
                        let allowed = 15.0 * f64::from(f32::EPSILON) * (transducers + 8) as f64;
                        assert!((Complex64::new(re, im) - want).norm() <= allowed, "{set} {count} {k} {l}");
                    }
                    assert!(product.row(k).iter().all(|row| row[count..].iter().all(|&x| x == 0.0)));
                }
            }
        }
    }
}
