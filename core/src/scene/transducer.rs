//! Transducer: source pressure P0 and directivity D(theta), in f64.

use alloc::format;

use crate::error::{Error, find, real};
use crate::math;

/// What all transducers of an array have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transducer {
    /// P0 in Pa m: on-axis pressure (peak) times distance at full drive.
    pub source_pressure: f64,
    /// D(theta).
    pub directivity: Directivity,
}

impl Default for Transducer {
    /// 4.386 Pa m, the AUTD3's transducer (its software: 275.574 * 0.2 / 4 pi), as a point source.
    fn default() -> Self {
        Self { source_pressure: 4.386, directivity: Directivity::Point }
    }
}

/// Directivity of a transducer. All but `Point` are baffled: D = 0 behind, where theta is above 90 degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Directivity {
    /// D = 1 everywhere, also behind: the paper's model.
    #[default]
    Point,
    /// D = 2 `J1(x)/x`, x = k a sin theta: a circular piston of radius a (m) in a baffle.
    Piston(f64),
    /// D = sin(x)/x, x = (k d/2) sin theta: an aperture of width d (m); Ultraino's model.
    Sinc(f64),
    /// D = cos(theta)^n; `HandyBeam`'s model with n = 3.376.
    Cos(f64),
    /// The Nicera T4010A1 as measured every 10 degrees (the AUTD3's transducer), by monotone cubics (PCHIP).
    T4010a1,
}

/// D of the T4010A1 at 0, 10, ..., 90 degrees (values of the AUTD3 software's transducer table).
pub(crate) const T4010A1: [f64; 10] = [1.0, 1.0, 1.0, 0.8913, 0.7079, 0.5012, 0.3548, 0.2512, 0.1995, 0.1778];

/// The directivities that a scene file knows, with the parameter that a bare name stands for.
const KNOWN: [Directivity; 5] = [
    Directivity::Point,
    Directivity::Piston(4.5e-3),
    Directivity::Sinc(9e-3),
    Directivity::Cos(3.376),
    Directivity::T4010a1,
];

impl Directivity {
    /// The directivity of a name (`point`, `piston`, `sinc`, `cos`, `t4010a1`) and its parameter: radius in m,
    /// width in m, exponent; left out it is 4.5e-3, 9e-3, 3.376.
    ///
    /// # Errors
    /// A name not listed, a parameter where none belongs, a radius or width that is not above 0, an exponent
    /// below 0.
    pub fn named(name: &str, parameter: Option<f64>) -> Result<Self, Error> {
        let known = find("directivity", name, &KNOWN, |known| known.name().0)?;
        if let (None, Some(value)) = (known.name().1, parameter) {
            return Err(Error::invalid(format!("directivity.{}", known.name().0), value, "it takes no parameter"));
        }
        match *known {
            Self::Piston(radius) => Self::Piston(parameter.unwrap_or(radius)),
            Self::Sinc(width) => Self::Sinc(parameter.unwrap_or(width)),
            Self::Cos(exponent) => Self::Cos(parameter.unwrap_or(exponent)),
            bare => bare,
        }
        .checked()
    }

    /// The name and parameter that [`Directivity::named`] takes.
    #[must_use]
    pub fn name(&self) -> (&'static str, Option<f64>) {
        match *self {
            Self::Point => ("point", None),
            Self::Piston(radius) => ("piston", Some(radius)),
            Self::Sinc(width) => ("sinc", Some(width)),
            Self::Cos(exponent) => ("cos", Some(exponent)),
            Self::T4010a1 => ("t4010a1", None),
        }
    }

    pub(crate) fn checked(self) -> Result<Self, Error> {
        if let (name, Some(parameter)) = self.name() {
            let item = format!("directivity.{name}");
            real(&item, parameter, 0.0, !matches!(self, Self::Cos(_)))?;
            if parameter > 1.0 && !matches!(self, Self::Cos(_)) {
                return Err(Error::invalid(item, parameter, "give metres: no transducer is wider than 1 m"));
            }
        }
        Ok(self)
    }

    /// Refuses beams so narrow that an angle in f32 no longer resolves them, for wavenumber k (1/m).
    pub(crate) fn check_beam(&self, k: f64) -> Result<(), Error> {
        // An error of 6e-8 in cos(theta) changes D by 2e-4 at most up to here.
        if let (name, Some(parameter)) = self.name()
            && self.sharpness(k) > 80.0
        {
            let cure = "give metres, at most some 13 wavelengths (an exponent: at most 6400)";
            return Err(Error::invalid(format!("directivity.{name}"), parameter, cure));
        }
        Ok(())
    }

    /// How fast D varies with the angle.
    fn sharpness(&self, k: f64) -> f64 {
        match *self {
            Self::Point | Self::T4010a1 => 0.0,
            Self::Piston(radius) => k * radius,
            Self::Sinc(width) => k * width / 2.0,
            Self::Cos(exponent) => math::sqrt(exponent),
        }
    }

    /// D at an angle given by its cosine, for wavenumber k (1/m), in double precision.
    #[must_use]
    pub fn value(&self, cos_theta: f64, k: f64) -> f64 {
        if matches!(self, Self::Point) {
            return 1.0;
        }
        if cos_theta < 0.0 {
            return 0.0;
        }
        let sin_theta = math::sqrt((1.0 - cos_theta * cos_theta).max(0.0));
        match *self {
            Self::Point => 1.0,
            Self::Piston(radius) => jinc(k * radius * sin_theta),
            Self::Sinc(width) => {
                let x = 0.5 * k * width * sin_theta;
                if x < 1e-4 { 1.0 - x * x / 6.0 } else { math::sin(x) / x }
            }
            Self::Cos(exponent) => math::pow(cos_theta, exponent),
            Self::T4010a1 => pchip(&T4010A1, math::acos(cos_theta.min(1.0)).to_degrees() / 10.0),
        }
    }
}

/// 2 `J1(x)/x`.
fn jinc(x: f64) -> f64 {
    if x < 1e-4 { 1.0 - x * x / 8.0 } else { 2.0 * math::j1(x) / x }
}

/// The monotone cubic through `values` at 0, 1, 2, ... (Fritsch and Butland 1984: harmonic-mean slopes, so that
/// no overshoot is invented between measured values; one-sided three-point slopes at the ends).
fn pchip(values: &[f64; 10], x: f64) -> f64 {
    pchip_piece(values, x)[0]
}

/// The same as its Taylor coefficients at x.
pub(crate) fn pchip_piece(values: &[f64; 10], x: f64) -> [f64; 4] {
    let step = |i: usize| values[i + 1] - values[i];
    let slope = |i: usize| -> f64 {
        let end = |first: f64, second: f64| {
            let slope = 1.5 * first - 0.5 * second;
            if slope * first <= 0.0 {
                0.0
            } else if first * second < 0.0 && slope.abs() > 3.0 * first.abs() {
                3.0 * first
            } else {
                slope
            }
        };
        match i {
            0 => end(step(0), step(1)),
            9 => end(step(8), step(7)),
            _ if step(i - 1) * step(i) <= 0.0 => 0.0,
            _ => 2.0 * step(i - 1) * step(i) / (step(i - 1) + step(i)),
        }
    };
    let i = (x as usize).min(8);
    let u = x - i as f64;
    let [c0, c1, c2, c3] = hermite(values[i], values[i + 1], slope(i), slope(i + 1));
    [((c3 * u + c2) * u + c1) * u + c0, (3.0 * c3 * u + 2.0 * c2) * u + c1, 3.0 * c3 * u + c2, c3]
}

/// The cubic c0 + c1 u + c2 u^2 + c3 u^3 with the given values and slopes at u = 0 and u = 1.
fn hermite(left: f64, right: f64, left_slope: f64, right_slope: f64) -> [f64; 4] {
    let rise = right - left;
    [left, left_slope, 3.0 * rise - 2.0 * left_slope - right_slope, left_slope + right_slope - 2.0 * rise]
}
