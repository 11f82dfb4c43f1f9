//! Local: derivatives of the sound at a point without sources nearby, from the pressure on a small ball around it.
//!
//! Inside a ball without sources, sound of wavenumber k is a sum of regular spherical waves. The addition theorem of spherical
//! harmonics (NIST's Digital Library of Mathematical Functions, 14.30.9) gives the pressure at a point x, at the distance r
//! from the middle, from the pressures p(a s) on the sphere of radius a in the directions s:
//!
//! ```text
//! p(x) = sum_l (2l + 1)/(4 pi) j_l(kr)/j_l(ka) int p(a s) P_l(s . x/r) ds
//! j_l(kr) = (kr)^l/(2l + 1)!! (1 - (kr)^2/(4l + 6) + (kr)^4/((4l + 6)(8l + 20)) - ...)
//! ```
//!
//! The integral over the directions s is computed by a Gauss rule in the height and equal steps in azimuth, exact to
//! degree 13. Derivatives up to the fourth need the orders l up to 4. The rule separates these orders from all others
//! below 10. r^l P_l(s . x/r) is a polynomial in x.

use crate::prelude::*;
use crate::propagation::jet::{Jet, TERMS};
use crate::propagation::scattering::sphere::gauss;
use crate::scene::Medium;

/// The number of heights of the Gauss rule; there are twice as many steps in azimuth.
const HEIGHTS: usize = 7;

/// The least distance in wavelengths between a point and a sphere or mesh, for derivatives of the field.
pub(crate) const LEAST_CLEARANCE: f64 = 0.01;

/// Offsets from a point in m, each with weights: the weight of the pressure there in each Taylor coefficient at the point.
pub(crate) struct Local(Vec<([f64; 3], [Complex64; TERMS])>);

impl Local {
    /// Returns the places on a ball with this radius in m. The imaginary part of the wavenumber is the absorption.
    pub(crate) fn new(wavenumber: Complex64, radius: f64) -> Self {
        let (heights, weights) = gauss(HEIGHTS);
        let steps = 2 * HEIGHTS;
        let place = |k: usize| {
            let (height, across) = (heights[k / steps], math::sqrt(1.0 - heights[k / steps] * heights[k / steps]));
            let turn = math::phasor(TAU * (k % steps) as f64 / steps as f64);
            let s = [across * turn.re, across * turn.im, height];
            let share = weights[k / steps] * TAU / steps as f64;
            (s.map(|x| radius * x), shares(wavenumber, radius, s).map(|term| share * term))
        };
        Self((0..HEIGHTS * steps).map(place).collect())
    }

    /// Returns the places on a ball that is clear of bodies; `clear` is the distance in m to the nearest body.
    /// Returns `None` if this distance is less than a hundredth of the wavelength.
    pub(crate) fn beside(medium: Medium, clear: f64) -> Option<Self> {
        let ball = || Self::new(medium.complex_wavenumber(), 0.125 * clear.min(medium.wavelength()));
        (clear >= LEAST_CLEARANCE * medium.wavelength()).then(ball)
    }

    /// The places on the ball around a point, each with its weights for the Taylor coefficients.
    pub(crate) fn around(&self, point: [f64; 3]) -> impl Iterator<Item = ([f64; 3], &[Complex64; TERMS])> {
        self.0.iter().map(move |(offset, terms)| ((Vec3(point) + *offset).0, terms))
    }

    /// The Taylor polynomials, real and imaginary part, around a point, from the values of `pressure` on the ball.
    pub(crate) fn expand(&self, point: [f64; 3], mut pressure: impl FnMut([f64; 3]) -> Complex64) -> [Jet; 2] {
        let mut sum = [Complex64::ZERO; TERMS];
        for (place, terms) in self.around(point) {
            let p = pressure(place);
            sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum += p * term);
        }
        [Jet::of(&sum.map(|c| c.re)), Jet::of(&sum.map(|c| c.im))]
    }
}

/// The weights of a direction s: the sum over l of (2l + 1)/(4 pi) `j_l(kr)/j_l(ka) P_l(s . x/r)` as a polynomial up to degree
/// 4 in x.
fn shares(wavenumber: Complex64, radius: f64, s: [f64; 3]) -> [Complex64; TERMS] {
    let along = Jet::linear(s);
    let square = Jet::square();
    let mixed = |a: &Jet, by: f64, b: &Jet, less: f64| {
        let mut sum = Jet::ZERO;
        sum.add(a, by);
        sum.add(b, less);
        sum
    };
    let (twice, square_twice) = (along.times(&along), square.times(&square));
    let mut fourth = mixed(&twice.times(&twice), 4.375, &square.times(&twice), -3.75);
    fourth.add(&square_twice, 0.375);
    let orders = [
        Jet::monomial(0),
        along,
        mixed(&twice, 1.5, &square, -0.5),
        mixed(&twice.times(&along), 2.5, &square.times(&along), -1.5),
        fourth,
    ];
    let mut terms = [Complex64::ZERO; TERMS];
    let mut unit = 1.0;
    for (l, order) in orders.iter().enumerate() {
        let factor = (2 * l + 1) as f64 / (4.0 * PI * unit) / tail(wavenumber * radius, l);
        unit *= radius;
        let next = -wavenumber * wavenumber / (4 * l + 6) as f64;
        let last = -next * wavenumber * wavenumber / (8 * l + 20) as f64;
        for (share, part) in [(1.0.into(), *order), (next, order.times(&square)), (last, order.times(&square_twice))] {
            terms.iter_mut().zip(part.coefficients()).for_each(|(term, c)| *term += factor * share * c);
        }
    }
    terms
}

/// `j_l(z)` (2l + 1)!!/z^l for a small z, by its power series.
fn tail(z: Complex64, l: usize) -> Complex64 {
    let (mut sum, mut term) = (Complex64::ONE, Complex64::ONE);
    for n in 1..12 {
        term *= -0.5 * z * z / (n * (2 * (l + n) + 1)) as f64;
        sum += term;
    }
    sum
}

#[cfg(test)]
#[path = "tests/local.rs"]
mod tests;
