//! Directivity D(theta) from its cosine, by polynomials.

use alloc::vec::Vec;

use crate::kernels::lanes::Lanes;
use crate::kernels::phasor::{log2, power_of_two};
use crate::kernels::simd::{Simd, WHOLE};

/// D over c = cos(theta) from 0 to 1; coefficients of the highest power first.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one of them an array")]
pub(crate) enum Pattern {
    /// A polynomial of c^2 - 1/2: D is an entire function of sin(theta)^2, or an even power of c.
    Even(Vec<f32>),
    /// A polynomial of c - 1/2.
    Powers(Vec<f32>),
    /// Chebyshev polynomials of 2 c^2 - 1, for narrow beams, of whose powers f32 would lose the digits.
    Chebyshev(Vec<f32>),
    /// Quintics between 16 `bounds`, one register a coefficient: a piece is found without leaving the lanes.
    Pieces { bounds: Lanes, coefficients: [Lanes; 6] },
    /// c^n.
    Exponent(f32),
}

/// A piece of [`Pattern::Pieces`] begins near each whole number of PLACES c (1 + c): about every five degrees.
pub(crate) const PLACES: f32 = 6.9;

impl Pattern {
    /// D at an angle whose cosine is `along` times `inverse`; anything behind the transducer.
    #[inline(always)]
    pub(crate) fn directivity<S: Simd>(&self, s: S, along: S::V, inverse: S::V) -> S::V {
        let half = s.splat(-0.5);
        match self {
            Self::Even(coefficients) => {
                let c = s.mul(along, inverse);
                horner(s, coefficients, s.fma(c, c, half))
            }
            Self::Powers(coefficients) => horner(s, coefficients, s.fma(along, inverse, half)),
            Self::Chebyshev(coefficients) => {
                let c = s.mul(along, inverse);
                clenshaw(s, coefficients, s.fma(c, c, half))
            }
            Self::Pieces { bounds, coefficients } => {
                let c = s.mul(along, inverse);
                let scale = s.splat(PLACES);
                // The bound nearest to c may lie on either side.
                let near = s.fma(s.fma(c, scale, scale), c, s.splat(WHOLE));
                let piece = s.select_less(c, s.gather(bounds, near), s.sub(near, s.splat(1.0)), near);
                let u = s.sub(c, s.gather(bounds, piece));
                let [first, rest @ ..] = coefficients;
                let mut sum = s.gather(first, piece);
                for list in rest {
                    sum = s.fma(sum, u, s.gather(list, piece));
                }
                sum
            }
            Self::Exponent(n) => {
                let (c, least) = (s.mul(along, inverse), s.splat(f32::MIN_POSITIVE));
                let power = power_of_two(s, s.mul(log2(s, s.max(c, least)), s.splat(*n)));
                s.select_less(c, least, s.splat(0.0), power)
            }
        }
    }
}

/// The polynomial at x by Horner's rule.
#[inline(always)]
fn horner<S: Simd>(s: S, coefficients: &[f32], x: S::V) -> S::V {
    let mut sum = s.splat(0.0);
    for &coefficient in coefficients {
        sum = s.fma(sum, x, s.splat(coefficient));
    }
    sum
}

/// The sum of Chebyshev polynomials of 2 x by Clenshaw's recurrence.
#[inline(always)]
fn clenshaw<S: Simd>(s: S, coefficients: &[f32], x: S::V) -> S::V {
    let (mut sum, mut last) = (s.splat(0.0), s.splat(0.0));
    let four = s.mul(x, s.splat(4.0));
    for &coefficient in coefficients {
        (sum, last) = (s.sub(s.fma(sum, four, s.splat(coefficient)), last), sum);
    }
    // T_1 is x where the recurrence has 2 x.
    s.fnma(last, s.add(x, x), sum)
}
