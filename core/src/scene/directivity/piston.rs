//! A circular piston in a baffle (P. M. Morse and K. U. Ingard, Theoretical Acoustics, 1968, section 7.4).

use crate::prelude::*;
use crate::scene::directivity::law::{Directivity, Law, Parameter, Shape, Taylor};

pub(super) static LAW: Law = Law {
    name: "piston",
    parameter: Some(Parameter { default: 4.5e-3, length: true }),
    about: "D = 2 J1(x)/x, x = k a sin theta: a circular piston of radius a in m, in a baffle",
    value: |radius, cos_theta, k| {
        let x = k * radius * math::sqrt((1.0 - cos_theta * cos_theta).max(0.0));
        if x < 1e-4 { 1.0 - x * x / 8.0 } else { 2.0 * math::j1(x) / x }
    },
    taylor: Taylor::InSine { scale: |radius, k| k * radius, order: 1.0, factor: 2.0 },
    sharpness: |radius, k| k * radius,
    shape: Shape::Even,
};

impl Directivity {
    /// D = 2 `J1(x)/x` with x = k a sin theta: a circular piston of `radius` a (m) in a baffle.
    pub const fn piston(radius: f64) -> Self {
        Self { law: &LAW, parameter: radius }
    }
}
