//! Tests of `local` with waves whose Taylor polynomials are known.

use super::*;
use crate::control::Control;
use crate::kernels::InstructionSet;
use crate::propagation::sources::Sources;
use crate::propagation::taylor::Taylor;
use crate::scene::{Array, Medium};

#[test]
fn values_on_a_ball_give_the_polynomial_of_a_transducer() {
    let medium = Medium { absorption: 0.2, ..Medium::default() };
    let sources = Sources::new(&Array::new(vec![[0.01, -0.004, 0.0]], None).expect("an array"), medium);
    // One point is about a wavelength from the transducer, the other about a quarter of a wavelength. The radius of the ball is
    // an eighth of the distance.
    for point in [[0.013, 0.002, 0.006], [0.01, -0.003, 0.0019]] {
        let mut exact = [Jet::ZERO; 2];
        let taylor = Taylor::new(InstructionSet::best(), &sources, |_| Complex64::ONE);
        taylor.add(point, &mut exact, &mut Control::none()).expect("it is not stopped");
        let clear = crate::scene::distance(point, [0.01, -0.004, 0.0]);
        let local = Local::new(medium.complex_wavenumber(), clear / 8.0);
        let value = local.expand(point, |place| sources.exact(0, place));
        let largest = |degree: i32| {
            let of =
                |(term, c): (usize, &f64)| if crate::propagation::jet::degree(term) == degree { c.abs() } else { 0.0 };
            exact.iter().flat_map(|part| part.coefficients().iter().enumerate().map(of)).fold(0.0, f64::max)
        };
        for (part, other) in value.iter().zip(&exact) {
            for (term, (c, d)) in part.coefficients().iter().zip(other.coefficients()).enumerate() {
                let most = largest(crate::propagation::jet::degree(term));
                // The force has fourth derivatives only in the small part of the quadrupole.
                let error = if crate::propagation::jet::degree(term) < 4 { 1e-5 } else { 1e-4 };
                assert!((c - d).abs() < error * most, "{point:?}, term {term}: {c} {d}");
            }
        }
    }
}
