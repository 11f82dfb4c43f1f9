//! Sine and cosine of phases in turns, powers of two and logarithms, as polynomials without branches.

use core::f64::consts::{PI, SQRT_2};

use crate::kernels::simd::Elementwise;
use crate::kernels::simd::doubles::{Doubles, V};

/// sqrt(2) sin(pi x)/x in powers of x^2, with the least maximal error on |x| <= 1/2 (2e-8 before rounding).
#[allow(clippy::approx_constant, reason = "fitted coefficients that lie near a constant")]
const SINE: [f32; 5] = [4.442_883, -7.308_245_7, 3.606_354_5, -0.846_112_9, 0.109_826_99];

/// sqrt(2) cos(pi x) in powers of x^2, with the least maximal error on |x| <= 1/2 (7e-8).
#[allow(clippy::approx_constant, reason = "fitted coefficients that lie near a constant")]
const COSINE: [f32; 5] = [1.414_213_5, -6.978_851, 5.739_461, -1.883_563, 0.310_698_18];

/// 2^x in powers of x, with the least relative error on |x| <= 1/2 (2e-9).
#[allow(clippy::approx_constant, reason = "fitted coefficients that lie near a constant")]
const POWER: [f32; 7] =
    [1.0, 0.693_147_2, 0.240_226_47, 0.055_503_29, 0.009_618_489, 0.001_339_993_1, 0.000_153_458_12];

/// log2(1 + x)/x in powers of x, with the least relative error on -1/4 <= x <= 1/2 (2e-7).
const LOGARITHM: [f32; 8] =
    [1.442_695_3, -0.721_350_9, 0.480_852_43, -0.360_319_4, 0.289_925_58, -0.250_733_46, 0.205_497_65, -0.097_788_125];

/// Evaluates a polynomial at x by Horner's rule.
#[inline(always)]
fn polynomial<S: Elementwise, const N: usize>(s: S, coefficients: &[f32; N], x: S::V) -> S::V {
    let mut sum = s.splat(coefficients[N - 1]);
    for &coefficient in coefficients[..N - 1].iter().rev() {
        sum = s.fma(sum, x, s.splat(coefficient));
    }
    sum
}

/// Returns `amplitude` times (cos 2 pi x, sin 2 pi x) for |x| < 2^22 turns. The absolute error is below 7e-7 of the
/// amplitude (sigma^2 is up to 2, and rounded three times where products are not fused).
///
/// The half angle is used: with sigma = sqrt(2) sin(pi x) and gamma = sqrt(2) cos(pi x) the two are 1 - sigma^2 and
/// sigma gamma, and |x| <= 1/2 needs no quadrants.
#[inline(always)]
pub(crate) fn wave<S: Elementwise>(s: S, turns: S::V, amplitude: S::V) -> [S::V; 2] {
    let x = s.fract(turns);
    let square = s.mul(x, x);
    let sine = s.mul(polynomial(s, &SINE, square), x);
    let cosine = polynomial(s, &COSINE, square);
    let part = s.mul(amplitude, sine);
    [s.fnma(part, sine, amplitude), s.mul(part, cosine)]
}

/// Returns 2^x for x <= 0; results below 2^-126 are replaced by 2^-126 times a number near 1.
#[inline(always)]
pub(crate) fn power_of_two<S: Elementwise>(s: S, x: S::V) -> S::V {
    let x = s.max(x, s.splat(-126.0));
    let whole = s.round(x);
    s.mul(polynomial(s, &POWER, s.sub(x, whole)), s.exp2(whole))
}

/// Returns log2 of normal x, with a relative error below 4e-7.
#[inline(always)]
pub(crate) fn log2<S: Elementwise>(s: S, x: S::V) -> S::V {
    // The remainder is between 3/4 and 3/2. So for x near 1 the logarithm is that of the remainder alone.
    let whole = s.exponent(s.mul(x, s.splat(4.0 / 3.0)));
    let rest = s.sub(s.mul(x, s.exp2(s.sub(s.splat(0.0), whole))), s.splat(1.0));
    s.fma(polynomial(s, &LOGARITHM, rest), rest, whole)
}

/// Number of Taylor terms in [`phasor`].
const TERMS: usize = 11;

/// Returns cosine and sine of an angle in turns below 2^40, within 3e-16. It uses Taylor polynomials of the angle from
/// the nearest half turn.
#[inline(always)]
pub(crate) fn phasor<S: Doubles>(s: S, turns: V<S>) -> (V<S>, V<S>) {
    let halves = turns * 2.0;
    let whole = halves.round();
    // The sign is 1 for an even number of half turns, else -1.
    let odd = whole - (whole * 0.5).round() * 2.0;
    let sign = V::all(s, 1.0) - odd * odd * 2.0;
    let angle = (halves - whole) * PI;
    let square = angle * angle;
    let [mut cos, mut sin] = [V::all(s, TAYLOR[2 * TERMS - 2]), V::all(s, TAYLOR[2 * TERMS - 1])];
    for n in (0..TERMS - 1).rev() {
        cos = cos * square + TAYLOR[2 * n];
        sin = sin * square + TAYLOR[2 * n + 1];
    }
    (cos * sign, sin * angle * sign)
}

/// Returns the same as [`phasor`] within 2e-10, in half the time: by the half angle as [`wave`], with eight terms.
#[inline(always)]
pub(crate) fn close_phasor<S: Doubles>(s: S, turns: V<S>) -> (V<S>, V<S>) {
    let half = (turns - turns.round()) * PI;
    let square = half * half;
    let sin = eight_terms(square, 1) * (half * SQRT_2);
    let cos = eight_terms(square, 0) * SQRT_2;
    (V::all(s, 1.0) - sin * sin, sin * cos)
}

/// Sums eight of [`TAYLOR`]'s terms, every second one from `first` on, times powers of a square. It adds pairs of terms
/// first, which halves the latency.
#[inline(always)]
fn eight_terms<S: Doubles>(square: V<S>, first: usize) -> V<S> {
    let pair = |n: usize| square * TAYLOR[2 * n + 2 + first] + TAYLOR[2 * n + first];
    let (power, mut sum) = (square * square, pair(6));
    for n in [4, 2, 0] {
        sum = sum * power + pair(n);
    }
    sum
}

/// 1/n! with the signs of the cosine's terms (even n) and of the sine's (odd n).
pub(crate) const TAYLOR: [f64; 22] = {
    let mut terms = [1.0; 22];
    let mut n = 1;
    while n < 22 {
        terms[n] = terms[n - 1] / n as f64;
        n += 1;
    }
    let mut n = 0;
    while n < 22 {
        if n / 2 % 2 == 1 {
            terms[n] = -terms[n];
        }
        n += 1;
    }
    terms
};

#[cfg(test)]
#[path = "tests/phasor.rs"]
mod tests;
