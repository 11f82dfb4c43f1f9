//! Bessel functions of x = k a sin(theta), for the directivities piston and sinc, as Taylor series in cos(theta).

use crate::kernels::waves::SLOPES;
use crate::prelude::*;

/// Below this x the power series of the Bessel functions is short; above it the recurrence loses no digits.
const SMALL: f64 = 2.0;

/// The largest y = x^2 for which [`series`] is used: its largest term is then a hundred times the first, which costs two
/// digits.
const LARGEST: f64 = 64.0;

/// Converts Taylor coefficients of a function f of y = x^2, where x = `scale` sin(theta), into those of f in c = cos(theta).
/// `of(y)` returns the coefficients in y.
pub(super) fn in_sine(scale: f64, c: f64, of: impl Fn(f64) -> [f64; SLOPES]) -> [f64; SLOPES] {
    let square = scale * scale;
    let [f, f1, f2, f3, f4] = of(square * (1.0 - c * c));
    // A step h of c changes y by -square (2 c h + h^2).
    let (a, b) = (-2.0 * square * c, -square);
    let fourth = f2 * b * b + 3.0 * f3 * a * a * b + f4 * a * a * a * a;
    [f, f1 * a, f1 * b + f2 * a * a, 2.0 * f2 * a * b + f3 * a * a * a, fourth]
}

/// Returns the power series in y of `factor` times the function of [`normalised`], cut where terms fall below 1e-17 of the
/// first for all y up to `most`. Returns `None` if the terms grow so large that their sum loses digits.
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

/// Returns the Taylor coefficients in y = x^2 of J1(x)/x (`order` 1) or of sin(x)/x (`order` 1/2). Both follow from d/dy
/// [J_n(x)/x^n] = -1/2 J_(n+1)(x)/x^(n+1), which also holds for spherical Bessel functions.
pub(super) fn normalised(y: f64, order: f64) -> [f64; SLOPES] {
    let x = math::sqrt(y);
    let mut values = [0.0; SLOPES];
    if x < SMALL {
        // In the series of the n-th function, the term with (-y/4)^m is first_n/(m! (order + n + 1)_m).
        let mut first: f64 = if order == 1.0 { 0.5 } else { 1.0 };
        for (n, value) in values.iter_mut().enumerate() {
            let (mut term, mut m, top): (f64, f64, f64) = (first, 1.0, order + n as f64);
            while term.abs() > 1e-18 * first {
                *value += term;
                term *= -y / (4.0 * m * (top + m));
                m += 1.0;
            }
            // The first term of J_(n+1)/x^(n+1) is 1/(2 (order + n + 1)) of the first term of J_n/x^n.
            first /= 2.0 * (top + 1.0);
        }
    } else {
        // The functions f_n = J_n/x^n follow from the two lowest: f_(n+1) = (2 n f_n - f_(n-1))/y.
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
