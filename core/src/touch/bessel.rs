//! The modified Bessel functions `K_0` and `K_1` of complex numbers.

use crate::prelude::*;

/// From this |z| on the series in 1/z is used. At this |z| both series have a relative error of about 1e-10.
const FAR: f64 = 12.0;

/// Number of terms of the series in 1/z: at |z| = 12 the 24th term is the smallest.
const TERMS: u32 = 24;
/// Largest number of terms of the series in z.
const MOST: u32 = 80;

/// Euler's constant.
const GAMMA: f64 = 0.577_215_664_901_532_9;

/// Returns `K_0` (order 0) or `K_1` (order 1) of z, whose real part is above 0.
pub(crate) fn modified_bessel(order: u32, z: Complex64) -> Complex64 {
    if math::hypot(z.re, z.im) < FAR { near(f64::from(order), z) } else { far(f64::from(order), z) }
}

/// Returns K of order n = 0 or 1 by the ascending series (DLMF 10.31): (1/z for n = 1) + (-z/2)^n sum of (z/2)^2k (h -
/// ln(z/2))/(k! (n + k)!), where h is the mean of digamma(k + 1) and digamma(n + k + 1).
fn near(order: f64, z: Complex64) -> Complex64 {
    let half = z / 2.0;
    let (square, logarithm) = (half * half, Complex64::new(math::log(math::hypot(half.re, half.im)), turn(half)));
    // digamma(1) = -gamma, digamma(2) = 1 - gamma.
    let (mut mean, mut term) = (order / 2.0 - GAMMA, Complex64::ONE);
    let mut sum = term * (mean - logarithm);
    for k in 1..=MOST {
        let k = f64::from(k);
        term *= square / (k * (order + k));
        mean += f64::midpoint(1.0 / k, 1.0 / (order + k));
        sum += term * (mean - logarithm);
        if term.norm_sqr() < 1e-36 * sum.norm_sqr() {
            break;
        }
    }
    if order > 0.0 { 1.0 / z - half * sum } else { sum }
}

/// Returns K of the given order for large z by the series in 1/z (DLMF 10.40): sqrt(pi/(2 z)) e^{-z} sum of `a_k`/z^k.
fn far(order: f64, z: Complex64) -> Complex64 {
    let (mut sum, mut term) = (Complex64::ONE, Complex64::ONE);
    for k in 1..=TERMS {
        let k = f64::from(k);
        let odd = 2.0 * k - 1.0;
        term *= (4.0 * order * order - odd * odd) / (8.0 * k) / z;
        sum += term;
    }
    let size = math::sqrt(PI / (2.0 * math::hypot(z.re, z.im))) * math::exp(-z.re);
    sum * math::phasor(-turn(z) / 2.0 - z.im) * size
}

/// Returns the angle of z in rad.
pub(crate) fn turn(z: Complex64) -> f64 {
    math::atan2(z.im, z.re)
}

#[cfg(test)]
#[path = "tests/bessel.rs"]
mod tests;
