//! Compares the results of strips with sums in double precision.

use super::*;
use crate::kernels::InstructionSet;
use crate::rng::Rng;
use num_complex::Complex64;

#[test]
fn gram_is_the_weighted_conjugate_product() {
    let work = Workspace::new();
    let mut rng = Rng::new(1);
    for (set, count) in InstructionSet::all().flat_map(|set| (1..=67).map(move |count| (set, count))) {
        // The sizes: one run of tiles, and two runs of which the last is not full.
        for transducers in [1, 37, 530] {
            let mut number = || 2.0 * rng.uniform() - 1.0;
            let matrix: Vec<Complex64> = (0..count * transducers).map(|_| Complex64::new(number(), number())).collect();
            let propagation = Propagation::from_matrix(&matrix, count).expect("propagation").with_instruction_set(set);
            let unit = 1.0 / propagation.reference();
            let factors: Vec<f32> = (0..tiles::lanes(transducers)).map(|i| 0.25 + (i % 3) as f32).collect();
            for factors in [None, Some(&factors[..])] {
                // Computed twice, the second time in memory that is not zero.
                let mut strips = Strips::new(&propagation, &work);
                drop(strips.gram(factors, &mut Control::none()).expect("it is not stopped"));
                let product = strips.gram(factors, &mut Control::none()).expect("it is not stopped");
                for k in (0..count).step_by(1 + count / 9) {
                    for l in 0..count {
                        let factor = |i: usize| factors.map_or(1.0, |factors| f64::from(factors[i]));
                        let at = |k: usize, i: usize| matrix[k * transducers + i] * unit;
                        let want: Complex64 = (0..transducers).map(|i| at(k, i).conj() * at(l, i) * factor(i)).sum();
                        let [re, im] = product.row(k).map(|row| f64::from(row[l]));
                        // The error bound: terms are below 8 and have about two roundings each.
                        let allowed = 15.0 * f64::from(f32::EPSILON) * (transducers + 8) as f64;
                        assert!((Complex64::new(re, im) - want).norm() <= allowed, "{set} {count} {k} {l}");
                    }
                    assert!(product.row(k).iter().all(|row| row[count..].iter().all(|&x| x == 0.0)));
                }
            }
        }
    }
}

#[test]
fn strips_add_up_to_sums_over_all_transducers() {
    let work = Workspace::new();
    let mut rng = Rng::new(2);
    // The sizes: a single stored strip, and several strips one after another.
    for (set, (count, transducers)) in
        InstructionSet::all().flat_map(|set| [(3, 70), (37, 530), (300, 1100)].map(|size| (set, size)))
    {
        let mut number = || 2.0 * rng.uniform() - 1.0;
        let matrix: Vec<Complex64> = (0..count * transducers).map(|_| Complex64::new(number(), number())).collect();
        let propagation = Propagation::from_matrix(&matrix, count).expect("propagation").with_instruction_set(set);
        let at = |j: usize, i: usize| matrix[j * transducers + i] / propagation.reference();
        let mut phasors = Planar::zeros(1, propagation.lanes(), &work);
        let target: Vec<Complex64> = (0..count).map(|_| Complex64::new(number(), number())).collect();
        for (j, target) in target.iter().enumerate() {
            (phasors.re[j], phasors.im[j]) = (target.re as f32, target.im as f32);
        }
        let mut strips = Strips::new(&propagation, &work);
        let none = &mut Control::none();
        // The error bound: terms are below 8 and have about two roundings each.
        let allowed = |terms: usize| 15.0 * f64::from(f32::EPSILON) * (terms + 8) as f64;
        let powers = strips.powers(none).expect("it is not stopped");
        let moduli = strips.moduli(&phasors.re, none).expect("it is not stopped");
        let mut drives = strips.back_project(&phasors, none).expect("it is not stopped");
        let field = strips.field(&mut drives, none).expect("it is not stopped");
        let drive = |i: usize| Complex64::new(f64::from(drives[0][i]), f64::from(drives[1][i]));
        for j in (0..count).step_by(1 + count / 9) {
            let power: f64 = (0..transducers).map(|i| at(j, i).norm_sqr()).sum();
            assert!((f64::from(powers[j]) - power).abs() <= allowed(transducers));
            let received: Complex64 = (0..transducers).map(|i| at(j, i) * drive(i)).sum();
            let got = Complex64::new(f64::from(field.re[j]), f64::from(field.im[j]));
            assert!((got - received).norm() <= allowed(transducers) * count as f64);
        }
        for i in (0..transducers).step_by(1 + transducers / 9) {
            let want: Complex64 = (0..count).map(|j| at(j, i).conj() * target[j]).sum();
            assert!((drive(i) - want).norm() <= allowed(count), "{set} {count} {i}");
            let want: f64 = (0..count).map(|j| at(j, i).norm() * target[j].re).sum();
            assert!((f64::from(moduli[i]) - want).abs() <= allowed(count), "{set} {count} {i}");
        }
        assert!(drives.iter().all(|part| part[transducers..].iter().all(|&x| x == 0.0)));
    }
}
