//! Pattern: a directivity D(theta) as polynomials in f32. Chebyshev interpolation in f64 gives their coefficients.

use core::{array, iter};

use crate::kernels::LANES;
use crate::kernels::lanes::Lanes;
use crate::kernels::propagate::directivity::{Chebyshev, Exponent, MIDDLE, Pattern, Pieces, Polynomial};
use crate::prelude::*;
use crate::scene::directivity::law::{Directivity, Shape};

/// The largest error of a polynomial, before its coefficients are rounded to f32.
const ERROR: f64 = 7.5e-7;

/// Interpolation nodes in the interval 0 to 1: the narrowest beam needs about 50.
const NODES: usize = 64;

/// The largest allowed sum of the moduli of a polynomial's terms. D is at most 1, so up to four bits of f32 are lost by
/// cancellation.
const TERMS: f64 = 16.0;

impl Directivity {
    /// Returns the pattern for the wavenumber `k` in 1/m, from which the f32 kernels compute D; `None` for a point source.
    pub(crate) fn pattern(&self, k: f64) -> Option<Pattern> {
        let even = match &self.law.shape {
            Shape::Omnidirectional => return None,
            Shape::Pieces(bounds) => return Some(Pattern::Pieces(pieces(bounds, |c| self.value(c, k)))),
            Shape::Even => true,
            Shape::Power => libm::fmod(self.parameter, 2.0) == 0.0,
        };
        let series = if even {
            short_series(|square| self.value(math::sqrt(square), k))
        } else {
            short_series(|c| self.value(c, k))
        };
        let powers = powers(&series);
        let polynomial = if size(&powers) <= TERMS { polynomial(even, &powers) } else { None };
        Some(polynomial.unwrap_or_else(|| match self.law.shape {
            Shape::Power => Pattern::Exponent(Exponent(self.parameter as f32)),
            _ => Pattern::Chebyshev(Chebyshev(series.iter().rev().map(|&x| x as f32).collect())),
        }))
    }
}

/// Returns the shortest type of polynomial that has room for these powers; `None` if there are too many.
fn polynomial(even: bool, powers: &[f64]) -> Option<Pattern> {
    Some(match (even, powers.len()) {
        (true, ..=6) => Pattern::Even6(rounded(powers)),
        (true, ..=10) => Pattern::Even10(rounded(powers)),
        (true, ..=14) => Pattern::Even14(rounded(powers)),
        (false, ..=6) => Pattern::All6(rounded(powers)),
        (false, ..=10) => Pattern::All10(rounded(powers)),
        (false, ..=14) => Pattern::All14(rounded(powers)),
        _ => return None,
    })
}

/// Rounds the coefficients to f32 and orders them from the highest power down, as the kernels expect.
fn rounded<const EVEN: bool, const N: usize>(powers: &[f64]) -> Polynomial<EVEN, N> {
    Polynomial(array::from_fn(|n| powers.get(N - 1 - n).map_or(0.0, |&power| power as f32)))
}

/// The sum of the moduli of a polynomial's terms at |x| = 1/2.
fn size(powers: &[f64]) -> f64 {
    powers.iter().rev().fold(0.0, |sum, power| 0.5 * sum + power.abs())
}

/// The first `count` Chebyshev coefficients of a function on the interval from low to high, from its values at `nodes` nodes.
fn series(value: impl Fn(f64) -> f64, [low, high]: [f64; 2], nodes: usize, count: usize) -> Vec<f64> {
    let mut series = vec![0.0; count];
    for node in 0..nodes {
        let x = math::cos(PI * (node as f64 + 0.5) / nodes as f64);
        let share = 2.0 / nodes as f64 * value(low + (high - low) * 0.5 * (1.0 + x));
        // The recurrence of Chebyshev polynomials: T_(n+1) = 2 x T_n - T_(n-1).
        let (mut last, mut this) = (x, 1.0);
        for sum in &mut series {
            *sum += share * this;
            (last, this) = (this, 2.0 * x * this - last);
        }
    }
    series[0] *= 0.5;
    series
}

/// The shortest Chebyshev series on the interval 0 to 1 whose error is at most [`ERROR`].
fn short_series(value: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut series = series(value, [0.0, 1.0], NODES, NODES);
    let mut error = 0.0;
    while let Some(last) = series.pop() {
        error += last.abs();
        if error > ERROR {
            series.push(last);
            break;
        }
    }
    series
}

/// Converts a Chebyshev series into powers of x/2, the lowest first; x is the argument of the Chebyshev polynomials.
fn powers(series: &[f64]) -> Vec<f64> {
    let mut powers = vec![0.0; series.len()];
    // The Chebyshev polynomials in powers of x/2: T_0 = 1, T_1 = 2 (x/2), T_(n+1) = 4 (x/2) T_n - T_(n-1).
    let (mut last, mut this) = (Vec::new(), vec![1.0]);
    for (n, coefficient) in series.iter().enumerate() {
        for (sum, power) in powers.iter_mut().zip(&this) {
            *sum += coefficient * power;
        }
        let factor = if n == 0 { 2.0 } else { 4.0 };
        let mut next: Vec<f64> = iter::once(0.0).chain(this.iter().map(|power| factor * power)).collect();
        next.iter_mut().zip(&last).for_each(|(next, last): (&mut f64, &f64)| *next -= last);
        (last, this) = (this, next);
    }
    powers
}

/// Returns a piecewise polynomial of degree 4 in cos(theta). Its pieces begin at these angles in degrees; the last one ends at
/// 0 degrees.
fn pieces(begins: &[f64; LANES - 1], value: impl Fn(f64) -> f64) -> Pieces {
    let middle = f64::from(MIDDLE);
    let bounds: Lanes = array::from_fn(|k| {
        begins.get(k).map_or(1.0, |degrees| math::cos(degrees.to_radians()).max(0.0) - middle) as f32
    });
    let mut coefficients = [[0.0; LANES]; 5];
    for (k, pair) in bounds.windows(2).enumerate() {
        // The last bound is above 1, the largest cosine: the piece ends at 1.
        let [low, high] = [pair[0], pair[1].min(1.0 - MIDDLE)].map(|bound| f64::from(bound) + middle);
        let width = high - low;
        let mut powers = powers(&series(&value, [low, high], 8, coefficients.len()));
        // Converts powers of (c - low)/width - 1/2 into powers of c - low by a Taylor shift.
        for first in 0..powers.len() {
            for n in (first..powers.len() - 1).rev() {
                powers[n] -= 0.5 * powers[n + 1];
            }
        }
        for (n, power) in powers.into_iter().enumerate() {
            coefficients[4 - n][k] = (power / libm::pow(width, n as f64)) as f32;
        }
    }
    Pieces { bounds, coefficients }
}
