//! Directivity D(theta) of a transducer: the laws, one in each file, and a law with its parameter by name.

pub(crate) mod bessel;
pub(crate) mod cos;
pub(crate) mod law;
pub(crate) mod pattern;
pub(crate) mod piston;
pub(crate) mod point;
pub(crate) mod sinc;
pub(crate) mod t4010a1;

pub use law::{Directivity, Parameter};

use crate::error::find;
use crate::kernels::waves::{SLOPES, Slopes};
use crate::prelude::*;
use crate::scene::directivity::bessel::{in_sine, normalised, series};
use crate::scene::directivity::law::{Law, Shape, Taylor};

/// All laws that scene files, Python and C can name.
static LAWS: [&Law; 5] = [&point::LAW, &piston::LAW, &sinc::LAW, &cos::LAW, &t4010a1::LAW];

impl Directivity {
    /// Returns one directivity for each law, with the law's default parameter.
    pub fn all() -> impl Iterator<Item = Self> {
        LAWS.iter().map(|law| Self { law, parameter: law.parameter.map_or(0.0, |parameter| parameter.default) })
    }

    /// Returns the directivity of this name and parameter (piston: radius in m, sinc: width in m, cos: exponent). Without a
    /// parameter it has the law's default.
    ///
    /// ```
    /// use midair::Directivity;
    ///
    /// let names: Vec<&str> = Directivity::all().map(|directivity| directivity.name().0).collect();
    /// assert!(names.contains(&"piston"));
    /// assert_eq!(Directivity::named("piston", None)?, Directivity::piston(4.5e-3));
    /// # Ok::<(), midair::Error>(())
    /// ```
    ///
    /// # Errors
    /// An unknown name, a parameter for a law without one, a radius or width that is not above 0, an exponent below 0.
    pub fn named(name: &str, parameter: Option<f64>) -> Result<Self> {
        let law = *find("directivity", name, &LAWS, |law| law.name)?;
        match (law.parameter, parameter) {
            (None, None) => Ok(Self { law, parameter: 0.0 }),
            (None, Some(value)) => {
                Err(Error::invalid(format!("directivity.{}", law.name), value, "it takes no parameter"))
            }
            (Some(range), value) => Self { law, parameter: value.unwrap_or(range.default) }.checked(),
        }
    }

    /// The length k a^2 / 2 of a piston's near field in m, for the wavenumber `k` in 1/m; 0 for other laws.
    ///
    /// Rayleigh's integral is 2 sin(k (sqrt(r^2 + a^2) - r) / 2) times a constant on the axis. At r = k a^2 / 2 it is 4 to 11 %
    /// of the far field below it (radii of half a wavelength and more), and its phase is half a radian off.
    pub(crate) fn near_field(&self, k: f64) -> f64 {
        self.radius().map_or(0.0, |a| k * a * a / 2.0)
    }

    pub(crate) fn checked(self) -> Result<Self> {
        if let Some(Parameter { length, .. }) = self.law.parameter {
            let item = format!("directivity.{}", self.law.name);
            real(&item, self.parameter, 0.0, length)?;
            if self.parameter > 1.0 && length {
                return Err(Error::out_of_range(item, self.parameter, "give metres: no transducer is wider than 1 m"));
            }
        }
        Ok(self)
    }

    /// Rejects a beam so narrow that angles in f32 cannot resolve it; `k` is the wavenumber in 1/m.
    pub(crate) fn check_beam(&self, k: f64) -> Result<()> {
        // Up to this sharpness the rounding of cos(theta) to f32, 6e-8, changes D by at most 2e-4.
        if (self.law.sharpness)(self.parameter, k) > 80.0 {
            let cure = "give metres, at most some 13 wavelengths (an exponent: at most 6400)";
            return Err(Error::invalid(format!("directivity.{}", self.law.name), self.parameter, cure));
        }
        Ok(())
    }

    /// Returns D at an angle, given by its cosine, for the wavenumber `k` in 1/m. Computed in double precision.
    pub fn value(&self, cos_theta: f64, k: f64) -> f64 {
        if self.silent(cos_theta) { 0.0 } else { (self.law.value)(self.parameter, cos_theta, k) }
    }

    /// Returns the Taylor coefficients of D by cos(theta) up to the fourth order, for the wavenumber `k` in 1/m. All are 0
    /// behind a baffle.
    pub(crate) fn taylor(&self, cos_theta: f64, k: f64) -> [f64; SLOPES] {
        let c = cos_theta.min(1.0);
        if self.silent(c) {
            return [0.0; SLOPES];
        }
        match self.law.taylor {
            Taylor::Each(of) => of(self.parameter, c, k),
            Taylor::InSine { scale, order, factor } => {
                in_sine(scale(self.parameter, k), c, |y| normalised(y, order).map(|value| factor * value))
            }
        }
    }

    /// Returns this directivity in the form in which the kernels evaluate it for many transducers.
    pub(crate) fn slopes(self, k: f64) -> Slopes {
        let each = Slopes::Each(Box::new(move |c| self.taylor(c, k)));
        match (&self.law.shape, &self.law.taylor) {
            (Shape::Omnidirectional, _) => Slopes::One,
            (_, Taylor::InSine { scale, order, factor }) => {
                let scale = scale(self.parameter, k);
                let square = scale * scale;
                series(*order, *factor, square).map_or(each, |terms| Slopes::Even { square, terms })
            }
            _ => each,
        }
    }

    /// Returns the Taylor coefficients of dD/dk up to the third order, if D is a function of k sin(theta). Otherwise D does not
    /// depend on k, and the result is `None`.
    pub(crate) fn widening(self, k: f64) -> Option<Slopes> {
        let Taylor::InSine { scale, order, factor } = &self.law.taylor else { return None };
        let (scale, order, factor) = (scale(self.parameter, k), *order, 2.0 * factor / k);
        let square = scale * scale;
        // The derivative is k dD/dk = 2 y dD/dy, where y = x^2 and x = `scale` sin(theta).
        let each = move |c: f64| {
            let c = c.min(1.0);
            let of = |y: f64| {
                let [_, f1, f2, f3, f4] = normalised(y, order).map(|value| factor * value);
                [y * f1, f1 + 2.0 * y * f2, 2.0 * f2 + 3.0 * y * f3, 3.0 * f3 + 4.0 * y * f4, 0.0]
            };
            if self.silent(c) { [0.0; SLOPES] } else { in_sine(scale, c, of) }
        };
        let grown = |terms: Vec<f64>| terms.iter().enumerate().map(|(n, term)| n as f64 * term).collect();
        Some(match series(order, factor, square) {
            Some(terms) => Slopes::Even { square, terms: grown(terms) },
            None => Slopes::Each(Box::new(each)),
        })
    }

    /// Whether the transducer radiates nothing at this angle, because the angle is behind its baffle.
    fn silent(&self, cos_theta: f64) -> bool {
        cos_theta < 0.0 && !matches!(self.law.shape, Shape::Omnidirectional)
    }
}

getters! {
    Directivity:

    /// The arguments of [`Directivity::named`] that give this directivity.
    pub name(self) -> (&'static str, Option<f64>) = (self.law.name, self.law.parameter.map(|_| self.parameter));

    /// The formula, in one line.
    pub about(self) -> &'static str = self.law.about;

    /// The law's parameter, where it has one.
    pub parameter(self) -> Option<Parameter> = self.law.parameter;

    /// The radius of a piston in m; `None` for other laws.
    pub(crate) radius(self) -> Option<f64> = (self.law.name == piston::LAW.name).then_some(self.parameter);
}

#[cfg(test)]
#[path = "../tests/directivity.rs"]
mod tests;
