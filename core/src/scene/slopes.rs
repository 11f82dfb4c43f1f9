//! Slopes of a directivity: D and its first three derivatives by cos(theta), in f64.

use crate::math;
use crate::scene::transducer::{Directivity, T4010A1, pchip_piece};

/// Below this argument the series of the Bessel functions needs few terms, above it the functions themselves lose none.
const SMALL: f64 = 2.0;

impl Directivity {
    /// The Taylor coefficients D, D', D''/2, D'''/6 by cos(theta), for wavenumber k (1/m); all 0 behind a baffle.
    ///
    /// Of `T4010a1`, monotone cubics in theta, the second derivative jumps every 10 degrees.
    pub(crate) fn taylor(&self, cos_theta: f64, k: f64) -> [f64; 4] {
        let c = cos_theta.min(1.0);
        match *self {
            Self::Point => [1.0, 0.0, 0.0, 0.0],
            _ if c < 0.0 => [0.0; 4],
            Self::Piston(radius) => in_sine(k * radius, c, |y| bessel(y, 1.0).map(|value| 2.0 * value)),
            Self::Sinc(width) => in_sine(0.5 * k * width, c, |y| bessel(y, 0.5)),
            Self::Cos(n) => {
                let power = |m: f64, factor: f64| if factor == 0.0 { 0.0 } else { factor * math::pow(c, n - m) };
                let second = n * (n - 1.0) / 2.0;
                [power(0.0, 1.0), power(1.0, n), power(2.0, second), power(3.0, second * (n - 2.0) / 3.0)]
            }
            Self::T4010a1 => {
                let theta = math::acos(c);
                let [d, d1, d2, d3] = pchip_piece(&T4010A1, theta.to_degrees() / 10.0);
                // The measured values begin flat.
                if d1 == 0.0 && d2 == 0.0 && d3 == 0.0 {
                    return [d, 0.0, 0.0, 0.0];
                }
                // theta as a series in cos(theta): its derivatives are -1/s, -c/s^3 and -(1 + 2 c^2)/s^5.
                let s2 = 1.0 - c * c;
                let s = math::sqrt(s2);
                let unit = 1.0_f64.to_degrees() / 10.0;
                let [a, b, e] = [-1.0 / s, -c / (2.0 * s2 * s), -(1.0 + 2.0 * c * c) / (6.0 * s2 * s2 * s)]
                    .map(|coefficient| coefficient * unit);
                [d, d1 * a, d1 * b + d2 * a * a, d1 * e + 2.0 * d2 * a * b + d3 * a * a * a]
            }
        }
    }
}

/// A function of y = x^2, x = `scale` sin(theta), given by its Taylor coefficients in y, as one of cos(theta).
fn in_sine(scale: f64, c: f64, of: impl Fn(f64) -> [f64; 4]) -> [f64; 4] {
    let square = scale * scale;
    let [f, f1, f2, f3] = of(square * (1.0 - c * c));
    // y moves by -square (2 c h + h^2).
    let (a, b) = (-2.0 * square * c, -square);
    [f, f1 * a, f1 * b + f2 * a * a, 2.0 * f2 * a * b + f3 * a * a * a]
}

/// `Gamma`-normalised Bessel functions in y = x^2: the Taylor coefficients in y of J1(x)/x (`order` 1) or of
/// sin(x)/x (`order` 1/2), by d/dy [J_n(x)/x^n] = -1/2 J_(n+1)(x)/x^(n+1), which holds for both kinds.
fn bessel(y: f64, order: f64) -> [f64; 4] {
    let x = math::sqrt(y);
    let mut values = [0.0; 4];
    if x < SMALL {
        // The term of (-y/4)^m of the function number n is first_n/(m! (order + n + 1)_m).
        let mut first: f64 = if order == 1.0 { 0.5 } else { 1.0 };
        for (n, value) in values.iter_mut().enumerate() {
            let (mut term, mut m, top): (f64, f64, f64) = (first, 1.0, order + n as f64);
            while term.abs() > 1e-18 * first {
                *value += term;
                term *= -y / (4.0 * m * (top + m));
                m += 1.0;
            }
            // J_(n+1)/x^(n+1) begins at 1/(2 (order + n + 1)) of J_n/x^n.
            first /= 2.0 * (top + 1.0);
        }
    } else {
        // f_n = J_n/x^n: f_(n+1) = (2 n f_n - f_(n-1))/y, from the two lowest.
        let (mut before, mut now) =
            if order == 1.0 { (math::j0(x), math::j1(x) / x) } else { (math::cos(x), math::sin(x) / x) };
        for (n, value) in values.iter_mut().enumerate() {
            *value = now;
            let top = order + n as f64;
            (before, now) = (now, (2.0 * top * now - before) / y);
        }
    }
    let [f, f1, f2, f3] = values;
    [f, -f1 / 2.0, f2 / 8.0, -f3 / 48.0]
}

#[cfg(test)]
#[path = "tests/slopes.rs"]
mod tests;
