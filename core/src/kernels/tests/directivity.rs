//! Directivity patterns at every angle compared with D in f64, for every instruction set.

use core::array::from_fn;

use crate::kernels::lanes::{LANES, Lanes};
use crate::kernels::propagate::source::{Form, Radiation, formed};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::tests::{ROUNDING, STRIDE, WAVENUMBER, wide};
use crate::scene::Directivity;

/// Returns the largest difference from D over cosines from -1 to 1.
fn error(set: InstructionSet, directivity: Directivity, steps: i32) -> f64 {
    let radiation = Radiation { decay: None, pattern: directivity.pattern(WAVENUMBER) };
    let mut error = 0.0_f64;
    for first in (-steps..=steps).step_by(LANES * STRIDE) {
        let cosines: Lanes = from_fn(|l| (first + l as i32).min(steps) as f32 / steps as f32);
        // With half the ray and twice the inverse distance, no digit of the cosine is lost.
        let rays = cosines.map(|c| 0.5 * c);
        let got = dispatch!(set, s => {
            let mut got = [f32::NAN; LANES];
            s.store(formed!(s, &radiation, true, form => form.direct(s, s.splat(1.0), || s.load(&rays), s.splat(2.0))), &mut got);
            got
        });
        for (got, c) in got.into_iter().zip(cosines) {
            error = error.max((wide(got) - directivity.value(wide(c), WAVENUMBER)).abs());
        }
    }
    error
}

/// Returns a piston with this product `ka` of wavenumber and radius.
fn piston(ka: f64) -> Directivity {
    Directivity::piston(ka / WAVENUMBER)
}

/// Returns a sinc directivity with this half of k d, d the width.
fn sinc(x: f64) -> Directivity {
    Directivity::sinc(2.0 * x / WAVENUMBER)
}

#[test]
fn patterns_are_accurate_within_a_millionth() {
    let exponents = [0.0, 0.1, 0.5, 1.0, 1.5, 2.0, 2.5, 2.9, 3.0, 3.376, 4.0, 5.5, 9.0, 12.5, 17.0, 24.0, 70.0, 6400.0];
    let widths = [0.01, 1.0, 2.0, 3.326, 4.0, 5.0, 6.0, 7.0, 8.0];
    let beams = widths.into_iter().flat_map(|x| [piston(x), sinc(x)]);
    for directivity in exponents.into_iter().map(Directivity::cos).chain(beams).chain([Directivity::T4010A1]) {
        for set in InstructionSet::all() {
            let error = error(set, directivity, 40_000);
            assert!(error < 1e-6, "{set}: {directivity:?} is missed by {error:e}");
        }
    }
}

#[test]
fn narrow_beams_are_accurate_up_to_a_rounding_of_the_cosine() {
    for x in [9.0, 10.0, 12.0, 14.0, 16.0, 20.0, 30.0, 50.0, 79.0] {
        for directivity in [piston(x), sinc(x)] {
            for set in InstructionSet::all() {
                let error = error(set, directivity, 100_000);
                // The derivative of D by cos(theta)^2 is at most x^2/6 for a sinc and x^2/8 for a piston.
                assert!(error < 1e-6 + x * x / 6.0 * ROUNDING, "{set}: {directivity:?} is missed by {error:e}");
            }
        }
    }
}
