//! Quantity: a function of the field at a point, and its derivatives by the pressure there.

use crate::kernels::contraction::Weights;
use crate::prelude::*;
use crate::propagation::forces::response::{Form, Response};
use crate::propagation::jet::{EXPONENTS, Jet, TERMS, place};
use crate::scene::{Medium, Particle};

/// A quantity of the field at each point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Quantity {
    /// Complex p in Pa (peak): two numbers for each point, the real and the imaginary part.
    Pressure,
    /// |p| in Pa.
    Amplitude,
    /// Radiation pressure |p|^2/(rho c^2) in Pa on a wall at normal incidence.
    Radiation,
    /// The potential of the force on a particle in J, without the push of travelling waves.
    Potential(Particle),
    /// The force on a particle in N: three numbers for each point.
    Force(Particle),
    /// The stiffness -dF/ds of a particle along x, y and z in N/m: three numbers for each point.
    Stiffness(Particle),
}

impl Quantity {
    /// Returns the quantity of this name; `particle` is used by the quantities of a particle.
    ///
    /// ```
    /// use midair::{Particle, Quantity};
    ///
    /// assert_eq!(Quantity::named("force", Particle::default())?.width(), 3);
    /// # Ok::<(), midair::Error>(())
    /// ```
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str, particle: Particle) -> Result<Self> {
        let all = [
            ("pressure", Self::Pressure),
            ("amplitude", Self::Amplitude),
            ("radiation", Self::Radiation),
            ("gorkov", Self::Potential(particle)),
            ("force", Self::Force(particle)),
            ("stiffness", Self::Stiffness(particle)),
        ];
        let named = all.iter().find(|(known, _)| *known == name).map(|&(_, quantity)| quantity);
        named.ok_or_else(|| Error::unknown("quantity", name, all.iter().map(|(known, _)| *known)))
    }

    /// The number of values at each point.
    pub fn width(self) -> usize {
        match self {
            Self::Pressure => 2,
            Self::Amplitude | Self::Radiation | Self::Potential(_) => 1,
            Self::Force(_) | Self::Stiffness(_) => 3,
        }
    }

    /// The particle, or `None` for a quantity of the pressure.
    pub fn particle(self) -> Option<Particle> {
        match self {
            Self::Potential(particle) | Self::Force(particle) | Self::Stiffness(particle) => Some(particle),
            _ => None,
        }
    }

    /// Writes the value of a quantity of the pressure for a pressure p.
    pub(crate) fn write(self, medium: Medium, p: Complex64, value: &mut [f64]) {
        match self {
            Self::Pressure => value.copy_from_slice(&[p.re, p.im]),
            Self::Radiation => value[0] = medium.radiation(math::hypot(p.re, p.im)),
            _ => value[0] = math::hypot(p.re, p.im),
        }
    }

    /// Returns dL/dRe p + j dL/dIm p for a scalar L with this `cotangent` dL/dvalue, and the derivative of L by the
    /// sound speed at constant p.
    pub(crate) fn back(self, medium: Medium, p: Complex64, value: &[f64], cotangent: &[f64]) -> ([f64; 2], f64) {
        let along = |factor: f64| [factor * p.re, factor * p.im];
        match self {
            Self::Pressure => ([cotangent[0], cotangent[1]], 0.0),
            Self::Radiation => {
                (along(2.0 * cotangent[0] * medium.radiation(1.0)), -2.0 * cotangent[0] * value[0] / medium.sound_speed)
            }
            // |p| has no derivative at 0: the smallest subgradient, 0, is used.
            _ => (along(if value[0] > 0.0 { cotangent[0] / value[0] } else { 0.0 }), 0.0),
        }
    }

    /// The bilinear forms of a quantity of a particle, one for each of its values.
    fn forms(self, response: &Response) -> Vec<&Form> {
        match self {
            Self::Force(_) => response.force.iter().collect(),
            Self::Stiffness(_) => (0..3).map(|axis| &response.hessian[axis][axis]).collect(),
            _ => vec![&response.potential],
        }
    }

    /// Writes the value of a quantity of a particle, for the Taylor polynomials of the pressure around the point (real and
    /// imaginary part).
    pub(crate) fn write_of_particle(self, pressure: &[Jet; 2], response: &Response, value: &mut [f64]) {
        let field = pressure.each_ref().map(Jet::coefficients);
        value.iter_mut().zip(self.forms(response)).for_each(|(value, form)| *value = form.value(field));
    }

    /// Returns the cotangents of the coefficients of the pressure for a scalar L, and the derivative of L by the
    /// sound speed at constant pressure. `responses` are that of the particle and its derivative by the sound speed.
    pub(crate) fn back_of_particle(
        self,
        responses: &[Response; 2],
        pressure: &[Jet; 2],
        cotangent: &[f64],
    ) -> ([Jet; 2], f64) {
        let field = pressure.each_ref().map(Jet::coefficients);
        let mut pulls = [[0.0; TERMS]; 2];
        let [forms, by_speed] = responses.each_ref().map(|response| self.forms(response));
        forms.iter().zip(cotangent).for_each(|(form, share)| form.pull(*share, field, &mut pulls));
        (
            pulls.each_ref().map(Jet::of),
            by_speed.iter().zip(cotangent).map(|(form, share)| share * form.value(field)).sum(),
        )
    }
}

/// Returns the weights for the backward pass, from the cotangents of a pressure's coefficients (real and imaginary
/// part).
pub(crate) fn weights([re, im]: &[Jet; 2]) -> Weights {
    let mut weights = Weights::default();
    for (term, (re, im)) in re.coefficients().iter().zip(im.coefficients()).enumerate() {
        if *re == 0.0 && *im == 0.0 {
            continue;
        }
        let powers = EXPONENTS[term];
        let weight = |exponents: [u8; 3], factor: f64| (place(exponents), [factor * re, -factor * im]);
        let raised = |exponents: [u8; 3], axis: usize, sign: f64| {
            let mut exponents = exponents;
            exponents[axis] += 1;
            weight(exponents, sign * f64::from(exponents[axis]))
        };
        weights.value.push(weight(powers, 1.0));
        weights.grown.push(weight(powers, 1.0 + powers.iter().map(|&n| f64::from(n)).sum::<f64>()));
        for axis in 0..3 {
            weights.slopes[axis].push(raised(powers, axis, 1.0));
            // The derivative by a rotation about the axis: x dF/dy - y dF/dx for the axis z, and in cyclic order for
            // x and y.
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            for (from, to, sign) in [(next, last, 1.0), (last, next, -1.0)] {
                if powers[from] > 0 {
                    let mut lower = powers;
                    lower[from] -= 1;
                    weights.turned[axis].push(raised(lower, to, sign));
                }
            }
        }
    }
    weights
}
