//! The measured directivity of the Nicera T4010A1, the transducer of the AUTD3.

use crate::prelude::*;
use crate::scene::directivity::law::{Directivity, Law, Shape, Taylor};

/// D at 0, 10, ..., 90 degrees (values of the AUTD3 software's transducer table).
const MEASURED: [f64; 10] = [1.0, 1.0, 1.0, 0.8913, 0.7079, 0.5012, 0.3548, 0.2512, 0.1995, 0.1778];

/// Where the pieces of the polynomial begin, in degrees: at measured angles, where D has kinks, and between them.
const BEGINS: [f64; 15] = [90.0, 80.0, 70.0, 65.0, 60.0, 55.0, 50.0, 47.0, 43.0, 40.0, 35.0, 30.0, 26.0, 23.0, 20.0];

pub(super) static LAW: Law = Law {
    name: "t4010a1",
    parameter: None,
    about: "the Nicera T4010A1 as measured every 10 degrees (the AUTD3's transducer), by monotone cubics (PCHIP)",
    value: |_, cos_theta, _| pchip(&MEASURED, math::acos(cos_theta.min(1.0)).to_degrees() / 10.0)[0],
    // The derivatives of D. The second derivative jumps at every tenth degree, where two cubics meet.
    taylor: Taylor::Each(|_, c, _| {
        let theta = math::acos(c);
        let [d, d1, d2, d3] = pchip(&MEASURED, theta.to_degrees() / 10.0);
        // D is constant near the axis, where theta has no Taylor series in cos(theta).
        if d1 == 0.0 && d2 == 0.0 && d3 == 0.0 {
            return [d, 0.0, 0.0, 0.0, 0.0];
        }
        // The Taylor series of theta in c = cos(theta), with s = sin(theta): its derivatives are -1/s, -c/s^3, -(1 + 2
        // c^2)/s^5, -(9 c + 6 c^3)/s^7.
        let s2 = 1.0 - c * c;
        let s = math::sqrt(s2);
        let unit = 1.0_f64.to_degrees() / 10.0;
        let [a, b, e] = [-1.0 / s, -c / (2.0 * s2 * s), -(1.0 + 2.0 * c * c) / (6.0 * s2 * s2 * s)]
            .map(|coefficient| coefficient * unit);
        let f = -c * (9.0 + 6.0 * c * c) / (24.0 * s2 * s2 * s2 * s) * unit;
        let fourth = d1 * f + d2 * (2.0 * a * e + b * b) + 3.0 * d3 * a * a * b;
        [d, d1 * a, d1 * b + d2 * a * a, d1 * e + 2.0 * d2 * a * b + d3 * a * a * a, fourth]
    }),
    sharpness: |_, _| 0.0,
    shape: Shape::Pieces(BEGINS),
};

impl Directivity {
    /// The Nicera T4010A1 as measured every 10 degrees (the AUTD3's transducer), by monotone cubics (PCHIP).
    pub const T4010A1: Self = Self { law: &LAW, parameter: 0.0 };
}

/// Returns the Taylor coefficients at x of the monotone cubic through `values` at 0, 1, 2, ... (F. N. Fritsch and J. Butland
/// 1984). The slopes are harmonic means, so the cubic does not overshoot between measured values; at the ends they are
/// one-sided three-point slopes.
fn pchip(values: &[f64; 10], x: f64) -> [f64; 4] {
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
