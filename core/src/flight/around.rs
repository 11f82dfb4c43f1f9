//! Around: the force on a small sphere near a place, as a polynomial of the coordinates relative to the place.
//!
//! In a ball without sources, sound is a sum of regular spherical waves of orders l, each of which is a sum of plane waves in
//! directions d:
//!
//! ```text
//! p(x) = sum_d e^{j k d . x} c_d
//! c_d = w_d sum_s w_s p(R s) sum_l (2l + 1)/(4 pi)^2 (-j)^l P_l(d . s)/j_l(kR)
//! ```
//!
//! (NIST's Digital Library of Mathematical Functions, 10.60.7 and 14.30.9.) R is the ball's radius, k the wavenumber; d and s
//! are the directions of a quadrature rule with weights w. Orders up to 6 leave an error of 1e-5 of the pressure. The
//! derivatives of p give the force at some places in a smaller ball, by `response`. A polynomial of degree 6 fitted to these
//! forces is accurate to 1e-3.

use crate::kernels::LANES;
use crate::kernels::around::{Ball, VALUES, WAYS, forces};
use crate::kernels::flight::TERMS;
use crate::prelude::*;
use crate::propagation::forces::response::coefficients;
use crate::propagation::{Model, field};
use crate::scene::{Particle, dot};

/// Highest order of the waves.
const ORDERS: usize = 6;
/// Radius of the ball in wavelengths.
const BALL: f64 = 1.0 / 6.0;

/// Degree of the polynomials.
const DEGREE: usize = 6;
/// Radius in wavelengths within which the polynomials are used.
const UNIT: f64 = 1.0 / 7.0;
/// Number of places to which a polynomial is fitted.
const PLACES: usize = 180;

/// Number of terms in the power series of a Bessel function.
const SERIES: usize = 11;

/// Force in N along x, y and z: the coefficients of x^a y^b z^c, ordered by degree up to 6, then by falling exponents.
pub(crate) type Polynomial = [[f64; 3]; TERMS];

/// The forces on a sphere in the fields of drives of one array.
pub(crate) struct Around<'a> {
    model: &'a Model,
    /// C_0, C_1 and C_2 of `response`, real and imaginary parts.
    coefficients: [[f32; 2]; 3],
    /// Places on the ball in m, relative to its centre.
    surface: Vec<[f64; 3]>,
    ball: Ball,
    /// Unit of the coordinates in m.
    pub(crate) unit: f64,
}

impl<'a> Around<'a> {
    /// Prepares the forces on a sphere.
    pub(crate) fn new(model: &'a Model, particle: Particle) -> Self {
        let medium = model.medium();
        let wavelength = medium.wavelength();
        let wavenumber = Complex64::new(2.0 * PI / wavelength, medium.absorption);
        let (radius, unit) = (BALL * wavelength, UNIT * wavelength);
        let rule = rule();
        let surface = rule.iter().map(|node| node.way.map(|x| radius * x)).collect();
        let waves = waves(&rule, wavenumber * radius);
        let places = within();
        let mut inside = Vec::with_capacity(PLACES * VALUES * rule.len());
        for place in &places {
            for axes in WAYS {
                let plane: Vec<Complex64> = rule
                    .iter()
                    .map(|node| {
                        let slope = |axis: usize| Complex64::I * wavenumber * node.way[axis];
                        let way = unit * dot(*place, node.way);
                        let wave = math::phasor(wavenumber.re * way) * math::exp(-wavenumber.im * way);
                        axes.iter().fold(wave, |wave, &axis| wave * slope(axis))
                    })
                    .collect();
                inside.extend((0..rule.len()).map(|s| {
                    let sum: Complex64 = plane.iter().zip(&waves).map(|(wave, row)| wave * row[s]).sum();
                    [sum.re as f32, sum.im as f32]
                }));
            }
        }
        let ball = Ball { inside, through: through(&places), places: PLACES };
        let coefficients = coefficients(particle, medium).map(|c| [c.re as f32, c.im as f32]);
        Self { model, coefficients, surface, ball, unit }
    }

    /// Returns for each of the places (P, 3) in m the force around it, in the field of its drive (P, N). The variables of the
    /// polynomials are the coordinates relative to the place, in units of [`Around::unit`].
    ///
    /// # Errors
    /// The errors of [`field`]; a stop.
    pub(crate) fn at(
        &self,
        places: &[[f64; 3]],
        drives: &[&[Complex32]],
        control: &mut Control,
    ) -> Result<Vec<Polynomial>> {
        let mut polynomials = vec![[[0.0; 3]; TERMS]; places.len()];
        let parts = polynomials.chunks_mut(LANES).zip(places.chunks(LANES)).zip(drives.chunks(LANES)).collect();
        control.each(parts, &|((polynomials, places), drives): Part<'_>, control| {
            let mut sound = vec![[[0.0; LANES]; 2]; self.surface.len()];
            for (lane, (place, drive)) in places.iter().zip(drives).enumerate() {
                let around: Vec<[f64; 3]> = self.surface.iter().map(|way| (Vec3(*place) + *way).0).collect();
                let pressures = field(self.model, drive, &around, control).map_err(nowhere)?;
                for (sound, p) in sound.iter_mut().zip(pressures) {
                    (sound[0][lane], sound[1][lane]) = (p.re, p.im);
                }
            }
            let mut out = [[[0.0; LANES]; 3]; TERMS];
            forces(self.model.set, &self.ball, self.coefficients, &sound, &mut out);
            for (lane, polynomial) in polynomials.iter_mut().enumerate() {
                *polynomial = out.map(|term| term.map(|lanes| f64::from(lanes[lane])));
            }
            Ok(())
        })?;
        Ok(polynomials)
    }
}

type Part<'a> = ((&'a mut [Polynomial], &'a [[f64; 3]]), &'a [&'a [Complex32]]);

/// Converts an error about a place that a bead has reached, where the field is not known.
fn nowhere(error: Error) -> Error {
    if error.is_stop() { error } else { error.inside("beads come where there is no force") }
}

/// Returns x^a y^b z^c up to degree 6, in the order of a [`Polynomial`].
pub(crate) fn monomials([x, y, z]: [f64; 3]) -> [f64; TERMS] {
    let mut all = [1.0; TERMS];
    let mut next = 0;
    let power = |x: f64, n: usize| (0..n).fold(1.0, |all, _| all * x);
    for degree in 0..=DEGREE {
        for rest in 0..=degree {
            for c in 0..=rest {
                all[next] = power(x, degree - rest) * power(y, rest - c) * power(z, c);
                next += 1;
            }
        }
    }
    all
}

/// Returns the amplitudes (D, D) of the plane waves for a pressure of 1 in each direction of the rule; see the module's head.
/// `size` is kR.
fn waves(rule: &[Node], size: Complex64) -> Vec<Vec<Complex64>> {
    let bessel = bessel(size);
    let shares: Vec<Complex64> = (0..=ORDERS)
        .map(|l| (-Complex64::I).powu(l as u32) * (2 * l + 1) as f64 / (bessel[l] * 16.0 * PI * PI))
        .collect();
    let wave = |from: &Node, to: &Node| {
        let cosine = dot(from.way, to.way);
        let (mut before, mut legendre) = (0.0, 1.0);
        let mut sum = Complex64::ZERO;
        for (l, share) in shares.iter().enumerate() {
            sum += share * legendre;
            let next = ((2 * l + 1) as f64 * cosine * legendre - l as f64 * before) / (l + 1) as f64;
            (before, legendre) = (legendre, next);
        }
        sum * (from.weight * to.weight)
    };
    rule.iter().map(|from| rule.iter().map(|to| wave(from, to)).collect()).collect()
}

/// A direction of a quadrature rule on the sphere.
struct Node {
    way: [f64; 3],
    weight: f64,
}

/// Returns the 50 nodes of a quadrature rule on the sphere, exact to degree 11.
///
/// V. I. Lebedev, USSR Comput. Math. Math. Phys. 16(2), 10 (1976): the directions of the faces, edges and corners of a cube,
/// and those of (1, 1, 3).
fn rule() -> Vec<Node> {
    let mut all = Vec::new();
    let ways = [-3, -1, 0, 1, 3];
    for x in ways {
        for y in ways {
            for z in ways {
                let mut shape = [x, y, z].map(i32::abs);
                shape.sort_unstable();
                let weight = match shape {
                    [0, 0, 1] => 4.0 / 315.0,
                    [0, 1, 1] => 64.0 / 2835.0,
                    [1, 1, 1] => 27.0 / 1280.0,
                    [1, 1, 3] => 14641.0 / 725_760.0,
                    _ => continue,
                };
                all.push(Node { way: Vec3([x, y, z].map(f64::from)).unit().0, weight: 4.0 * PI * weight });
            }
        }
    }
    all
}

/// Returns the spherical Bessel functions j_l(z), l = 0 to 6, of a small z by their power series.
fn bessel(z: Complex64) -> [Complex64; ORDERS + 1] {
    let mut lead = Complex64::ONE;
    core::array::from_fn(|order| {
        let (mut term, mut total) = (lead, lead);
        for n in 1..=SERIES {
            term *= -z * z / (2 * n * (2 * (order + n) + 1)) as f64;
            total += term;
        }
        lead *= z / (2 * order + 3) as f64;
        total
    })
}

/// Returns places in the unit ball, denser near its surface, where a fitted polynomial has the largest errors.
fn within() -> Vec<[f64; 3]> {
    let place = |k: usize| {
        let index = k as f64 + 0.5;
        let (height, angle) = (1.0 - 2.0 * index / PLACES as f64, PI * (1.0 + math::sqrt(5.0)) * index);
        let across = math::sqrt(1.0 - height * height);
        let part = index * core::f64::consts::SQRT_2;
        let depth = math::sin(PI / 2.0 * (part - math::floor(part)));
        [across * math::cos(angle), across * math::sin(angle), height].map(|x| x * depth)
    };
    (0..PLACES).map(place).collect()
}

/// Returns the matrix ([`TERMS`], P) that fits a polynomial to numbers at P places by least squares: (A^T A)^-1 A^T with the
/// monomials A (P, [`TERMS`]), by Cholesky's factor of A^T A.
fn through(places: &[[f64; 3]]) -> Vec<f32> {
    let rows: Vec<[f64; TERMS]> = places.iter().map(|&place| monomials(place)).collect();
    let mut factor = vec![[0.0; TERMS]; TERMS];
    for i in 0..TERMS {
        for j in 0..=i {
            let product: f64 = rows.iter().map(|row| row[i] * row[j]).sum();
            let rest = product - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>();
            factor[i][j] = if i == j { math::sqrt(rest) } else { rest / factor[j][j] };
        }
    }
    let mut matrix = vec![0.0; TERMS * places.len()];
    for (place, row) in rows.iter().enumerate() {
        let mut x = *row;
        for i in 0..TERMS {
            let above: f64 = (0..i).map(|k| factor[i][k] * x[k]).sum();
            x[i] = (x[i] - above) / factor[i][i];
        }
        for i in (0..TERMS).rev() {
            let below: f64 = (i + 1..TERMS).map(|k| factor[k][i] * x[k]).sum();
            x[i] = (x[i] - below) / factor[i][i];
        }
        for (term, x) in x.iter().enumerate() {
            matrix[term * places.len() + place] = *x as f32;
        }
    }
    matrix
}

#[cfg(test)]
#[path = "tests/around.rs"]
mod tests;
