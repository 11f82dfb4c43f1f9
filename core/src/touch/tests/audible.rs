//! Tests of the slow part of the squared pressure: a frame's start and end, one lap after another, delays and ears.

use alloc::vec;

use num_complex::Complex32;

use super::demodulate;
use crate::control::Control;

#[test]
fn a_frame_starts_where_the_one_before_has_ended() {
    let amplitudes = [(1.0, 2.0), (-3.0, 0.5), (0.0, -1.0), (2.0, 2.0)].map(|(re, im)| Complex32::new(re, im));
    let (order, weights, bins) = ([0, 1, 1], [1.0, 2.0, 0.5, 3.0], [0, 2, 1, 1]);
    for late in [0.0, 0.3, 0.9999] {
        let mut sums = vec![0.0; 2 * 3 * 3 * 3];
        demodulate(&amplitudes, &order, late, &weights, &bins, &mut sums, &mut Control::none()).expect("sums");
        let mut exact = vec![0.0; sums.len()];
        for (point, row) in amplitudes.chunks_exact(2).enumerate() {
            // E at the start of a frame, 30 laps of the slowest answer later, is that at the end of the one before.
            let mut y = [f64::from(row[0].re), f64::from(row[0].im)];
            for lap in (0..60_000).rev() {
                for (t, &frame) in order.iter().enumerate() {
                    let a = [f64::from(row[frame].re), f64::from(row[frame].im)];
                    let b = [y[0] - a[0], y[1] - a[1]];
                    y = [a[0] + late * b[0], a[1] + late * b[1]];
                    if lap > 0 {
                        continue;
                    }
                    let dot = |x: [f64; 2], y: [f64; 2]| x[0] * y[0] + x[1] * y[1];
                    for (k, term) in [dot(a, a) / 2.0, dot(a, b), dot(b, b) / 2.0].into_iter().enumerate() {
                        for ear in 0..2 {
                            let at = 2 * ear + point;
                            exact[((3 * ear + bins[at]) * 3 + k) * 3 + t] += f64::from(weights[at]) * term;
                        }
                    }
                }
            }
        }
        let most = exact.iter().fold(0.0_f64, |most, each| most.max(each.abs()));
        for (found, exact) in sums.iter().zip(&exact) {
            assert!((found - exact).abs() < 3e-4 * most, "{late}: {found} {exact}");
        }
    }
}

#[test]
fn sums_of_another_length_are_refused() {
    let (one, mut sums) = ([Complex32::ONE; 2], [0.0; 6]);
    for (late, bins) in [(0.5, [2, 0]), (1.0, [0, 0]), (-0.1, [0, 0])] {
        assert!(demodulate(&one, &[0], late, &[1.0; 2], &bins, &mut sums, &mut Control::none()).is_err());
    }
    assert!(demodulate(&one, &[0], 0.5, &[1.0; 2], &[0], &mut sums, &mut Control::none()).is_err());
    demodulate(&one, &[0], 0.5, &[1.0; 2], &[0, 0], &mut sums, &mut Control::none()).expect("sums");
    assert_eq!(sums, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
}
