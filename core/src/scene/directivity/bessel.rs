//! Bessel: functions of k a sin(theta) as series in cos(theta).

use alloc::vec::Vec;

use crate::kernels::waves::SLOPES;
use crate::math;

/// Below this argument the series of the Bessel functions needs few terms, above it the functions themselves lose none.
const SMALL: f64 = 2.0;

/// Above this y the largest term of the series in y is a hundred times the first, and takes two digits.
const LARGEST: f64 = 64.0;

/// A function of y = x^2, x = `scale` sin(theta), given by its Taylor coefficients in y, as one of cos(theta).
pub(super) fn in_sine(scale: f64, c: f64, of: impl Fn(f64) -> [f64; SLOPES]) -> [f64; SLOPES] {
    let square = scale * scale;
    let [f, f1, f2, f3, f4] = of(square * (1.0 - c * c));
    // y moves by -square (2 c h + h^2).
    let (a, b) = (-2.0 * square * c, -square);
    let fourth = f2 * b * b + 3.0 * f3 * a * a * b + f4 * a * a * a * a;
    [f, f1 * a, f1 * b + f2 * a * a, 2.0 * f2 * a * b + f3 * a * a * a, fourth]
}

/// The coefficients in y of `factor` times what [`normalised`] gives, to 1e-17 of the first up to `most`; none where the terms
/// grow too large to be added up.
pub(super) fn series(order: f64, factor: f64, most: f64) -> Option<Vec<f64>> {
    if most > LARGEST {
        return None;
    }
    let mut term = if order == 1.0 { 0.5 * factor } else { factor };
    let (mut terms, mut size, mut m) = (Vec::new(), 1.0, 1.0);
    while size > 1e-17 || most > 4.0 * m * (order + m) {
        terms.push(term);
        term *= -1.0 / (4.0 * m * (order + m));
        size *= most / (4.0 * m * (order + m));
        m += 1.0;
    }
    Some(terms)
}

/// `Gamma`-normalised Bessel functions in y = x^2: the Taylor coefficients in y of J1(x)/x (`order` 1) or of
/// sin(x)/x (`order` 1/2), by d/dy [J_n(x)/x^n] = -1/2 J_(n+1)(x)/x^(n+1), which holds for both kinds.
pub(super) fn normalised(y: f64, order: f64) -> [f64; SLOPES] {
    let x = math::sqrt(y);
    let mut values = [0.0; SLOPES];
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
    let [f, f1, f2, f3, f4] = values;
    [f, -f1 / 2.0, f2 / 8.0, -f3 / 48.0, f4 / 384.0]
}
