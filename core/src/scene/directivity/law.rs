//! Law: radiation of a kind of transducer over the angle, stated once; and a directivity, a law with its parameter.

use core::fmt;

use crate::kernels::waves::SLOPES;

/// All that is known of one kind of directivity D(theta), for wavenumber k in 1/m. One file of this folder states one law.
pub(crate) struct Law {
    /// The name in scene files, Python and C.
    pub(crate) name: &'static str,
    /// The parameter, where it has one.
    pub(crate) parameter: Option<Parameter>,
    /// The formula, in one line.
    pub(crate) about: &'static str,
    /// D of (parameter, cos theta, k) for cos theta from 0 to 1.
    pub(crate) value: fn(f64, f64, f64) -> f64,
    /// The method that computes its derivatives by cos theta there.
    pub(crate) taylor: Taylor,
    /// The speed at which D varies with the angle, of (parameter, k): x where D falls about as 1 - x^2 sin^2(theta)/6
    /// from the axis.
    pub(crate) sharpness: fn(f64, f64) -> f64,
    /// The functions that the polynomials of the f32 rows follow.
    pub(crate) shape: Shape,
}

/// The Taylor coefficients D, D', D''/2, D'''/6, D''''/24 by cos theta.
pub(crate) enum Taylor {
    /// A function of (parameter, cos theta, k).
    Each(fn(f64, f64, f64) -> [f64; SLOPES]),
    /// D = `factor` J(x)/x^`order`, x = `scale` sin theta with a scale of (parameter, k): see [`super::bessel`].
    InSine { scale: fn(f64, f64) -> f64, order: f64, factor: f64 },
}

/// The parameter of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// The parameter that a bare name stands for.
    pub default: f64,
    /// Whether the parameter is a length in m, above 0 and at most 1 m; else it is a number, 0 or above.
    pub length: bool,
}

/// The value of a law over the angle.
pub(crate) enum Shape {
    /// D = 1 everywhere, also behind.
    Omnidirectional,
    /// D is a smooth function of cos^2 theta, 0 behind the baffle.
    Even,
    /// D = cos^n theta with the parameter n, 0 behind the baffle.
    Power,
    /// D bends or ends at these angles in degrees, from 90 downwards; 0 behind the baffle.
    Pieces([f64; 15]),
}

/// Directivity of a transducer: a law and its parameter. All but `point` are baffled: D = 0 behind, where theta is above 90
/// degrees.
#[derive(Clone, Copy)]
pub struct Directivity {
    pub(crate) law: &'static Law,
    /// 0 where the law has none.
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
