//! Cover: a start with one focus behind or in front of the points, whose cone is a little wider than they are.
//!
//! ```text
//! a, A     mean place of the transducers, and their root mean square distance from it
//! c, R     mean place of the points, weighted by their targets, and their root mean square distance from it
//! f = a + (c - a)/(1 -+ WIDTH R/A)                                    the focus behind (-) or in front of (+) the points
//! q_i = e^{-jk |f - x_i|}                                             the drive; conjugate where f is behind the array
//! ```
//!
//! The field of this drive is smooth over the points. It has no zeros there, which descent could not move away, and
//! most of the power goes through the points. A disc, a square or a picture that begins so ends at a tenth of the error
//! that random phases or plane waves end at.

use crate::solvers::prelude::*;

/// The side of the points on which the focus is, as seen from the array.
#[derive(Clone, Copy)]
pub(crate) enum Side {
    Behind,
    Front,
}

/// Width of the cone at the points, relative to theirs. Over 30 pictures, descents from cones of .7, 1, 1.25, 1.5 and 2
/// ended at means of 3.1, 2.2, 1.5, 1.7 and 3.4 times the least error of all.
const WIDTH: f64 = 1.25;

/// Least distance of the points from the array's middle, relative to its size. Nearer points are among the transducers
/// and have no cone over them. Between two boards, descent from a cone ended at an error of .14, descent from drives in
/// phase at .0004.
const AMID: f64 = 0.25;

/// Returns the drives of modulus 1 for a focus on one side. Returns `None` if places are not known, transducers share
/// channels, the points are among the transducers or all points are quiet.
pub(crate) fn cover(problem: &Problem, side: Side, work: &Workspace) -> Option<Vec<Complex32>> {
    let (array, points, _) = problem.propagation().origin().filter(|(array, ..)| array.channels().is_none())?;
    let live = (0..array.len()).map(|i| if array.effect(i) == Complex64::ZERO { 0.0 } else { 1.0 });
    let (middle, aperture) = spread(array.positions(), live);
    let (centre, radius) = spread(points, problem.targets().iter().map(|&target| f64::from(target)));
    let distance = math::sqrt(centre.iter().zip(&middle).map(|(c, a)| (c - a) * (c - a)).sum::<f64>());
    if !(aperture > 0.0 && distance > AMID * aperture && radius.is_finite()) {
        return None;
    }
    let width = WIDTH * radius / aperture;
    let part = match side {
        Side::Behind => 1.0 - width,
        Side::Front => 1.0 + width,
    };
    // A plane wave would have its focus at infinity.
    let part = if part.abs() < 1e-3 { 1e-3 } else { part };
    let focus: [f64; 3] = core::array::from_fn(|axis| middle[axis] + (centre[axis] - middle[axis]) / part);
    let turn = -part.signum() * problem.setup().medium.wavenumber();
    let mut drive = work.complexes.take(array.len());
    for (i, (q, place)) in drive.iter_mut().zip(array.positions()).enumerate() {
        let square = focus.iter().zip(place).map(|(f, x)| (f - x) * (f - x)).sum::<f64>();
        let effect = array.effect(i);
        let lag = if effect == Complex64::ZERO { 0.0 } else { math::atan2(effect.im, effect.re) };
        let phasor = math::phasor(turn * math::sqrt(square) - lag);
        *q = Complex32::new(phasor.re as f32, phasor.im as f32);
    }
    Some(drive.into_vec())
}

/// Returns the weighted mean of places, and the root mean square distance from it; not finite if all weights are 0.
fn spread(places: &[[f64; 3]], weights: impl Iterator<Item = f64> + Clone) -> ([f64; 3], f64) {
    let all = weights.clone().sum::<f64>();
    let mut mean = [0.0; 3];
    for (place, weight) in places.iter().zip(weights.clone()) {
        mean.iter_mut().zip(place).for_each(|(mean, x)| *mean += weight / all * x);
    }
    let square = |place: &[f64; 3]| place.iter().zip(&mean).map(|(x, m)| (x - m) * (x - m)).sum::<f64>();
    let variance = places.iter().zip(weights).map(|(place, weight)| weight / all * square(place)).sum::<f64>();
    (mean, math::sqrt(variance))
}

#[cfg(test)]
#[path = "tests/cover.rs"]
mod tests;
