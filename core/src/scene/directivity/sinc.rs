//! An aperture of finite width: the directivity of Ultraino.

use crate::prelude::*;
use crate::scene::directivity::law::{Directivity, Law, Parameter, Shape, Taylor};

pub(super) static LAW: Law = Law {
    name: "sinc",
    parameter: Some(Parameter { default: 9e-3, length: true }),
    about: "D = sin(x)/x, x = (k d/2) sin theta: an aperture of width d in m; Ultraino's model",
    value: |width, cos_theta, k| {
        let x = 0.5 * k * width * math::sqrt((1.0 - cos_theta * cos_theta).max(0.0));
        if x < 1e-4 { 1.0 - x * x / 6.0 } else { math::sin(x) / x }
    },
    taylor: Taylor::InSine { scale: |width, k| 0.5 * k * width, order: 0.5, factor: 1.0 },
    sharpness: |width, k| k * width / 2.0,
    shape: Shape::Even,
};

impl Directivity {
    /// D = sin(x)/x with x = (k d/2) sin theta: an aperture of `width` d (m), as in Ultraino.
    pub const fn sinc(width: f64) -> Self {
        Self { law: &LAW, parameter: width }
    }
}
