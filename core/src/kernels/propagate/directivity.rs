//! Directivity D(theta), computed from cos(theta) by polynomials.

use crate::kernels::phasor::{log2, power_of_two};
use crate::kernels::prelude::*;
use crate::kernels::simd::WHOLE;

/// The directivity D as a function of cos(theta) from 0 to 1. Each kind and length is a type, for which loops are
/// compiled.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one of them an array")]
pub(crate) enum Pattern {
    Even6(Polynomial<true, 6>),
    Even10(Polynomial<true, 10>),
    Even14(Polynomial<true, 14>),
    All6(Polynomial<false, 6>),
    All10(Polynomial<false, 10>),
    All14(Polynomial<false, 14>),
    Chebyshev(Chebyshev),
    Pieces(Pieces),
    Exponent(Exponent),
}

/// Evaluates one kind of [`Pattern`].
pub(crate) trait Ahead {
    /// Returns D at an angle whose cosine is `along` times `inverse`. The result has no meaning behind the transducer.
    fn directivity<S: Elementwise>(&self, s: S, along: S::V, inverse: S::V) -> S::V;
}

/// Polynomial coefficients, the highest power first. With c = cos(theta), the variable is c^2 - 1/2 where D is an
/// entire function of sin(theta)^2 or an even power of c, else c - 1/2. So no f32 digits are lost at either end.
#[derive(Clone, Debug)]
pub(crate) struct Polynomial<const EVEN: bool, const N: usize>(pub(crate) [f32; N]);

impl<const EVEN: bool, const N: usize> Ahead for Polynomial<EVEN, N> {
    #[inline(always)]
    fn directivity<S: Elementwise>(&self, s: S, along: S::V, inverse: S::V) -> S::V {
        let half = s.splat(-0.5);
        let x = if EVEN {
            let c = s.mul(along, inverse);
            s.fma(c, c, half)
        } else {
            s.fma(along, inverse, half)
        };
        let mut sum = s.splat(self.0[0]);
        for &coefficient in &self.0[1..] {
            sum = s.fma(sum, x, s.splat(coefficient));
        }
        sum
    }
}

/// Coefficients of Chebyshev polynomials of 2 c^2 - 1, the highest first: for narrow beams, whose power series would
/// lose digits.
#[derive(Clone, Debug)]
pub(crate) struct Chebyshev(pub(crate) Vec<f32>);

impl Ahead for Chebyshev {
    /// Uses Clenshaw's recurrence.
    #[inline(always)]
    fn directivity<S: Elementwise>(&self, s: S, along: S::V, inverse: S::V) -> S::V {
        let c = s.mul(along, inverse);
        let x = s.fma(c, s.add(c, c), s.splat(-1.0));
        let (double, mut sum, mut last) = (s.add(x, x), s.splat(0.0), s.splat(0.0));
        for &coefficient in &self.0 {
            // The subtraction uses a value from two steps before, so that a step waits for one instruction only.
            (sum, last) = (s.fma(sum, double, s.sub(s.splat(coefficient), last)), sum);
        }
        // The first Chebyshev polynomial is x, where the recurrence would have 2 x.
        s.fnma(last, x, sum)
    }
}

/// D as quartics of c = cos(theta) in pieces, one lane group for each coefficient. The variable is x = c - 1/4 less the
/// piece's lower bound. A piece is found by a lookup in registers.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Pieces {
    /// Lower bounds of the pieces in x. Bound k is where the position of [`PLACE`] is nearest to k.
    pub(crate) bounds: Lanes,
    /// Coefficients of each piece, the highest power first.
    pub(crate) coefficients: [Lanes; 5],
}

/// Offset of the variable of [`Pieces`]: x is cos(theta) less this value.
pub(crate) const MIDDLE: f32 = 0.25;

/// Coefficients a and b of a piece's position in the tables, (a x + b) x + 1. Ten degrees near 90 degrees have one
/// piece, ten degrees near 20 have three.
const PLACE: [f32; 2] = [16.9, 6.55];

impl Ahead for Pieces {
    #[inline(always)]
    fn directivity<S: Elementwise>(&self, s: S, along: S::V, inverse: S::V) -> S::V {
        let x = s.fma(along, inverse, s.splat(-MIDDLE));
        // x may be on either side of the nearest bound.
        let near = s.fma(s.fma(x, s.splat(PLACE[0]), s.splat(PLACE[1])), x, s.splat(WHOLE + 1.0));
        let piece = s.select_less(x, s.gather(&self.bounds, near), s.sub(near, s.splat(1.0)), near);
        let x = s.sub(x, s.gather(&self.bounds, piece));
        let [first, rest @ ..] = &self.coefficients;
        let mut sum = s.gather(first, piece);
        for list in rest {
            sum = s.fma(sum, x, s.gather(list, piece));
        }
        sum
    }
}

/// D = c^n for exponents n that no short polynomial fits: small ones that are not whole, or large ones.
#[derive(Clone, Debug)]
pub(crate) struct Exponent(pub(crate) f32);

impl Ahead for Exponent {
    #[inline(always)]
    fn directivity<S: Elementwise>(&self, s: S, along: S::V, inverse: S::V) -> S::V {
        let (c, least) = (s.mul(along, inverse), s.splat(f32::MIN_POSITIVE));
        let power = power_of_two(s, s.mul(log2(s, s.max(c, least)), s.splat(self.0)));
        s.select_less(c, least, s.splat(0.0), power)
    }
}
