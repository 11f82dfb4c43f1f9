//! D = cos(theta)^n: the directivity of `HandyBeam`.

use crate::prelude::*;
use crate::scene::directivity::law::{Directivity, Law, Parameter, Shape, Taylor};

pub(super) static LAW: Law = Law {
    name: "cos",
    parameter: Some(Parameter { default: 3.376, length: false }),
    about: "D = cos(theta)^n; HandyBeam's model with n = 3.376",
    value: |exponent, cos_theta, _| math::pow(cos_theta, exponent),
    taylor: Taylor::Each(|n, c, _| {
        // c^n is computed once. The lower powers follow by division, unless c^n or c is too small to divide by.
        let (whole, over) = (math::pow(c, n), [1.0, c, c * c, c * c * c]);
        let power = |m: usize, factor: f64| match factor {
            0.0 => 0.0,
            _ if c > 1e-30 && whole > 1e-200 => factor * whole / over[m],
            _ => factor * math::pow(c, n - m as f64),
        };
        let second = n * (n - 1.0) / 2.0;
        let third = power(3, second * (n - 2.0) / 3.0);
        let fourth = if c > 0.0 { third * (n - 3.0) / (4.0 * c) } else { 0.0 };
        [whole, power(1, n), power(2, second), third, fourth]
    }),
    sharpness: |exponent, _| math::sqrt(exponent),
    shape: Shape::Power,
};

impl Directivity {
    /// D = cos(theta)^n with n = `exponent`; `HandyBeam`'s model with n = 3.376.
    pub const fn cos(exponent: f64) -> Self {
        Self { law: &LAW, parameter: exponent }
    }
}
