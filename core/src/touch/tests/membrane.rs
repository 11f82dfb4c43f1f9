//! Tests of the membrane: the closed form of a point load, and superposition of the loads of all places.

use alloc::string::ToString;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::{Complex32, Complex64};

use super::Membrane;
use crate::control::Control;
use crate::error::Error;
use crate::touch::bessel::modified_bessel;

fn membrane() -> Membrane {
    Membrane::new(6.0, 0.4, 6.4).expect("a membrane")
}

#[test]
fn a_point_load_moves_the_sheet_as_the_closed_form_says() {
    let (membrane, step, rows, columns) = (membrane(), 1e-3, 40, 50);
    for frequency in [10.0, 80.0, 250.0, 500.0] {
        let mut load = vec![Complex32::ZERO; rows * columns];
        load[7 * columns + 11].re = 1.0;
        let moved = membrane.moved(&[frequency], &load, [rows, columns], step, &mut Control::none()).expect("moved");
        for (i, j) in [(7, 12), (7, 49), (20, 11), (39, 0), (0, 49)] {
            let apart = step * f64::hypot(i as f64 - 7.0, j as f64 - 11.0);
            let exact =
                step * step * modified_bessel(0, membrane.decay(frequency) * apart) / (TAU * membrane.tension());
            let value = moved[i * columns + j];
            let value = Complex64::new(value.re.into(), value.im.into());
            assert!((value - exact).norm() < 2e-3 * exact.norm(), "{frequency} Hz at {i}, {j}: {value} {exact}");
        }
        // At the load itself the displacement is near the mean of the closed form over a fine lattice in the square.
        let fine = 40;
        let part = |k: usize| step * ((k as f64 + 0.5) / fine as f64 - 0.5);
        let parts = (0..fine * fine).map(|k| membrane.response(frequency, f64::hypot(part(k / fine), part(k % fine))));
        let mean = parts.sum::<Complex64>() * step * step / (fine * fine) as f64;
        let value = moved[7 * columns + 11];
        assert!((Complex64::new(value.re.into(), value.im.into()) - mean).norm() < 0.01 * mean.norm());
    }
}

#[test]
fn the_motion_is_the_sum_of_that_by_each_place_alone() {
    let (membrane, sides, step) = (membrane(), [5_usize, 9], 2e-3);
    let load: Vec<Complex32> = (0..45).map(|k| Complex32::new((k * k % 7) as f32, (k % 5) as f32)).collect();
    let moved = membrane.moved(&[120.0], &load, sides, step, &mut Control::none()).expect("moved");
    let single = |k: usize| {
        let mut one = vec![Complex32::ZERO; 45];
        one[k] = load[k];
        membrane.moved(&[120.0], &one, sides, step, &mut Control::none()).expect("moved")
    };
    let all: Vec<Vec<Complex32>> = (0..45).map(single).collect();
    let largest = moved.iter().map(|w| w.norm()).fold(0.0, f32::max);
    for (k, total) in moved.iter().enumerate() {
        let sum: Complex32 = all.iter().map(|each| each[k]).sum();
        assert!((total - sum).norm() < 1e-5 * largest);
    }
}

#[test]
fn a_wrong_sheet_or_load_raises_an_error() {
    let refused = |membrane: Result<Membrane, Error>| membrane.expect_err("refused").to_string();
    assert_eq!(refused(Membrane::new(0.0, 0.4, 6.4)), "speed is 0: give a number from 1e-6 to 1e6");
    assert_eq!(refused(Membrane::new(6.0, 0.4, f64::NAN)), "mass is NaN: give a number from 1e-6 to 1e6");
    let short = membrane().moved(&[100.0], &[Complex32::ONE; 5], [2, 3], 1e-3, &mut Control::none());
    assert_eq!(short.expect_err("refused").to_string(), "lines is 5 numbers: give 2 x 3 for each of 1 frequencies");
}
