//! Law: the directivity of one kind of transducer as a function of the angle. Directivity: a law with its parameter.

use core::fmt;

use crate::kernels::waves::SLOPES;

/// One kind of directivity D(theta), with k the wavenumber in 1/m. Each file of this folder defines one law.
pub(crate) struct Law {
    /// The name in scene files, Python and C.
    pub(crate) name: &'static str,
    /// The law's parameter, or `None`.
    pub(crate) parameter: Option<Parameter>,
    /// The formula in one line, for users.
    pub(crate) about: &'static str,
    /// Returns D for (parameter, cos theta, k), with cos theta from 0 to 1.
    pub(crate) value: fn(f64, f64, f64) -> f64,
    /// How the derivatives of D by cos theta are computed.
    pub(crate) taylor: Taylor,
    /// How fast D changes with the angle, for (parameter, k): the x for which D falls about as 1 - x^2 sin^2(theta)/6 near the
    /// axis.
    pub(crate) sharpness: fn(f64, f64) -> f64,
    /// The form of D, which selects the polynomials that approximate it in f32.
    pub(crate) shape: Shape,
}

/// How to compute the Taylor coefficients D, D', D''/2, D'''/6, D''''/24 by cos theta.
pub(crate) enum Taylor {
    /// By a function of (parameter, cos theta, k).
    Each(fn(f64, f64, f64) -> [f64; SLOPES]),
    /// By a Bessel function: D = `factor` J(x)/x^`order` with x = `scale` sin theta; `scale` is a function of (parameter, k).
    /// See [`super::bessel`].
    InSine { scale: fn(f64, f64) -> f64, order: f64, factor: f64 },
}

/// The parameter of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// The parameter's value if only the law's name is given.
    pub default: f64,
    /// Whether the parameter is a length in m, above 0 and at most 1 m. Otherwise it is a number of 0 or above.
    pub length: bool,
}

/// The form of D as a function of the angle. Except for a point source, D is 0 behind the baffle.
pub(crate) enum Shape {
    /// D = 1 everywhere, also behind.
    Omnidirectional,
    /// D is a smooth function of cos^2 theta.
    Even,
    /// D = cos^n theta, where n is the parameter.
    Power,
    /// D is a piecewise polynomial of cos theta; the pieces begin at these angles in degrees, from 90 downwards.
    Pieces([f64; 15]),
}

/// Directivity of a transducer: a law and its parameter. All but `point` are baffled: D = 0 behind, where theta is above 90
/// degrees.
#[derive(Clone, Copy)]
pub struct Directivity {
    pub(crate) law: &'static Law,
    /// The value of the parameter, 0 where the law has none.
    pub(crate) parameter: f64,
}

impl PartialEq for Directivity {
    fn eq(&self, other: &Self) -> bool {
        (self.law.name, self.parameter) == (other.law.name, other.parameter)
    }
}

impl fmt::Debug for Directivity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.law.parameter {
            None => write!(f, "{}", self.law.name),
            Some(_) => write!(f, "{}({})", self.law.name, self.parameter),
        }
    }
}
