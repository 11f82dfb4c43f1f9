//! Choices between two parts of the amplitude, one transducer after another, compared with the sums in f64.

use alloc::vec;
use alloc::vec::Vec;

use num_complex::{Complex32, Complex64};

use crate::control::Control;
use crate::kernels::dither::{Points, choose};
use crate::kernels::lanes::padded;
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tests::{LENGTHS, numbers, wide};
use crate::rng::Rng;

const TRANSDUCERS: usize = 9;
const PAIR: [f32; 2] = [0.5, 0.75];

#[test]
fn each_transducer_takes_the_part_of_the_smaller_error() {
    for (set, count) in InstructionSet::all().flat_map(|set| LENGTHS.map(move |count| (set, count))) {
        let (mut rng, lanes) = (Rng::new(count as u64), padded(count));
        let mut list = |rows: usize| (0..rows).flat_map(|_| numbers(&mut rng, count, -1.0, 1.0)).collect::<Vec<f32>>();
        let [gain_re, gain_im] = [list(TRANSDUCERS), list(TRANSDUCERS)];
        let [inverse_re, inverse_im, mut error_re, mut error_im] = [list(1), list(1), list(1), list(1)];
        let mut quiet = vec![0.0; lanes];
        quiet[..count].iter_mut().step_by(3).for_each(|quiet| *quiet = 1.0);
        error_im.iter_mut().zip(&quiet).for_each(|(error, quiet)| *error *= quiet);
        let mut drive: Vec<_> = (0..TRANSDUCERS).map(|i| Complex32::from_polar(0.8, i as f32)).collect();
        drive[4] = Complex32::ZERO;
        let mut parts = vec![0.6; TRANSDUCERS];
        let wave = |i: usize, j: usize| {
            let place = i * lanes + j;
            let [g, u] = [[gain_re[place], gain_im[place]], [inverse_re[j], inverse_im[j]]];
            let [g, u] = [g, u].map(|[re, im]| Complex64::new(wide(re), wide(im)));
            let c = g * Complex64::new(wide(drive[i].re), wide(drive[i].im)) * u;
            Complex64::new(c.re, c.im * wide(quiet[j]))
        };
        let mut errors: Vec<_> = (0..count).map(|j| Complex64::new(wide(error_re[j]), wide(error_im[j]))).collect();
        let [mut row_re, mut row_im] = [vec![f32::NAN; lanes], vec![f32::NAN; lanes]];
        for i in 0..TRANSDUCERS {
            let before = parts[i];
            let points = Points {
                error: [&mut error_re, &mut error_im],
                inverse: [&inverse_re, &inverse_im],
                quiet: &quiet,
                row: [&mut row_re, &mut row_im],
            };
            let rows = Rows::Stored { re: &gain_re, im: &gain_im };
            choose(set, rows, (i..i + 1, &drive), points, &mut parts, PAIR, &mut Control::none()).unwrap();
            if i == 4 {
                assert_eq!(parts[4].to_bits(), before.to_bits(), "{set}: silence does not choose");
                continue;
            }
            let with = |part: f32| -> f64 {
                let change = wide(part) - wide(before);
                (0..count).map(|j| (errors[j] + change * wave(i, j)).norm_sqr()).sum()
            };
            let other = if parts[i] == PAIR[0] { PAIR[1] } else { PAIR[0] };
            assert!(PAIR.contains(&parts[i]), "{set}");
            assert!(with(parts[i]) <= with(other) + 1e-5 * count as f64, "{set}, {count} points, transducer {i}");
            let change = wide(parts[i]) - wide(before);
            errors.iter_mut().enumerate().for_each(|(j, error)| *error += change * wave(i, j));
        }
        for (j, error) in errors.iter().enumerate() {
            let value = Complex64::new(wide(error_re[j]), wide(error_im[j]));
            assert!((value - error).norm() < 1e-5, "{set}, {count} points: {value} for {error}");
        }
    }
}
