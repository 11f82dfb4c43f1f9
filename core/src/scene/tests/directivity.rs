//! Tests of the directivities.

use super::*;
use crate::math;

/// Returns a bound on the fourth Taylor coefficient of D in cos(theta); `s` is the square of the law's sharpness.
fn most(s: f64) -> f64 {
    1.0 + s * s + 0.1 * s * s * s + 1e-4 * s * s * s * s
}

#[test]
fn slopes_are_those_of_the_directivity() {
    // The steps cover the argument at which the computation changes from series to functions. The extra beams have many lobes.
    let h = 1e-3;
    let beams = [Directivity::piston(50e-3), Directivity::sinc(60e-3), Directivity::cos(0.0), Directivity::cos(1.0)];
    let smooth = Directivity::all().filter(|directivity| !matches!(directivity.law.shape, Shape::Pieces(_)));
    for directivity in smooth.chain(beams) {
        for step in 1..=197 {
            let c = 0.005 * f64::from(step);
            let [d, d1, d2, d3, d4] = directivity.taylor(c, 739.0);
            assert!((d - directivity.value(c, 739.0)).abs() < 1e-13, "{directivity:?} at {c}");
            // Compares the Taylor polynomial with D nearby, to the fourth order.
            for x in [-h, h] {
                let near = directivity.taylor((c + x).min(1.0), 739.0)[0];
                let error = ((((d4 * x + d3) * x + d2) * x + d1) * x + d - near).abs();
                // D is a function of s^2 sin^2(theta), whose fourth derivative is below 1e-4.
                let sharpness = (directivity.law.sharpness)(directivity.parameter, 739.0);
                let fourth = match directivity.law.shape {
                    Shape::Even => most(sharpness * sharpness),
                    _ => 50.0 / (c * c * c),
                };
                assert!(error <= fourth * h * h * h * h + 1e-14, "{directivity:?} at {c}: {error:e}");
            }
        }
    }
}

#[test]
fn measured_slopes_are_those_of_the_cubics_between_the_angles() {
    let directivity = Directivity::T4010A1;
    for degrees in [3.0_f64, 12.0, 17.0, 23.0, 36.0, 55.0, 78.0, 84.0] {
        let c = math::cos(degrees.to_radians());
        let [d, d1, d2, d3, d4] = directivity.taylor(c, 739.0);
        assert!((d - directivity.value(c, 739.0)).abs() < 1e-14);
        for x in [-2e-4, 2e-4] {
            let near = directivity.value(c + x, 739.0);
            assert!(((((d4 * x + d3) * x + d2) * x + d1) * x + d - near).abs() < 1e-11, "{degrees} degrees");
        }
    }
}

#[test]
fn a_baffle_and_the_axis_have_slopes_too() {
    for directivity in Directivity::all().filter(|directivity| *directivity != Directivity::POINT) {
        assert_eq!(directivity.taylor(-0.1, 739.0), [0.0; SLOPES]);
        let front = directivity.taylor(1.0, 739.0);
        assert!(front[0] == 1.0 && front.iter().all(|slope| slope.is_finite()));
        assert_eq!(directivity.taylor(1.0 + 1e-15, 739.0), front);
    }
}
