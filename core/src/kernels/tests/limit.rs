//! Amplitude limits compared with f64, for drives whose squares underflow to those whose squares overflow.

use alloc::vec::Vec;

use num_complex::Complex64;

use crate::kernels::limit;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tests::{LENGTHS, ROUNDING, numbers, wide};
use crate::rng::Rng;

/// A function that limits drives, and the same limit for one drive in double precision.
type Limit<'a> = (fn(InstructionSet, [&mut [f32]; 2]), &'a dyn Fn(Complex64) -> Complex64);

#[test]
fn limits_are_those_of_double_precision() {
    for set in InstructionSet::all() {
        for (count, unit) in LENGTHS.flat_map(|count| [1e-42, 1e-25, 1.0, 1e25, 3e38].map(|unit| (count, unit))) {
            let mut rng = Rng::new(count as u64);
            let [mut re, mut im] = [(); 2].map(|()| numbers(&mut rng, count, -1.0, 1.0));
            re.iter_mut().chain(&mut im).for_each(|part| *part *= unit);
            (re[count / 2], im[count / 2]) = (0.0, 0.0);
            let q: Vec<Complex64> = re.iter().zip(&im).map(|(&re, &im)| Complex64::new(wide(re), wide(im))).collect();
            let largest = q.iter().map(|q| q.norm()).fold(f64::MIN_POSITIVE, f64::max);
            let full = |q: Complex64| if q.norm() > 0.0 { q / q.norm() } else { q };
            let limits: [Limit<'_>; 3] = [
                (limit::clamp, &|q| if q.norm() > 1.0 { full(q) } else { q }),
                (limit::normalize, &|q| q / largest),
                (limit::fill, &full),
            ];
            for (k, (limit, want)) in limits.into_iter().enumerate() {
                let (mut re, mut im) = (re.clone(), im.clone());
                limit(set, [&mut re, &mut im]);
                for ((re, im), q) in re.iter().zip(&im).zip(&q) {
                    let gap = (Complex64::new(wide(*re), wide(*im)) - want(*q)).norm();
                    assert!(gap <= 8.0 * ROUNDING, "{set} {count} {unit} {k}: {gap}");
                }
            }
        }
    }
}
