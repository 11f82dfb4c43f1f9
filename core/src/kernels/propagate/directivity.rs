//! Directivity D(theta) from its cosine, by polynomials.

use alloc::vec::Vec;

use crate::kernels::lanes::Lanes;
use crate::kernels::phasor::{log2, power_of_two};
use crate::kernels::simd::{Elementwise, WHOLE};

/// D over c = cos(theta) from 0 to 1. A type for each kind and length, so that a loop over points is compiled for it.
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

/// A kind of [`Pattern`].
pub(crate) trait Ahead {
    /// D at an angle whose cosine is `along` times `inverse`; anything behind the transducer.
    fn directivity<S: Elementwise>(&self, s: S, along: S::V, inverse: S::V) -> S::V;
}

/// Coefficients, the highest power first, of c^2 - 1/2 where D is an entire function of sin(theta)^2 or an even power of c,
/// else of c - 1/2: from there to either end no f32 digits are lost.
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

/// Coefficients, the highest first, of Chebyshev polynomials of 2 c^2 - 1: for narrow beams, whose powers would lose
/// digits.
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
            // The difference waits for nothing: a step takes as long as one instruction.
            (sum, last) = (s.fma(sum, double, s.sub(s.splat(coefficient), last)), sum);
        }
        // T_1 is x, where the recurrence has 2 x.
        s.fnma(last, x, sum)
    }
}

/// Quartics of x = c - 1/4 less its piece's lower bound, one lane group a coefficient: a piece is found without leaving the
/// lanes.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Pieces {
    /// The k-th is the one whose [`PLACE`] is nearest to k.
    pub(crate) bounds: Lanes,
    /// The highest power first.
    pub(crate) coefficients: [Lanes; 5],
}

/// x is c less this,
pub(crate) const MIDDLE: f32 = 0.25;

/// and its place (a x + b) x + 1: a piece for ten degrees near 90, three for those near 20.
const PLACE: [f32; 2] = [16.9, 6.55];

impl Ahead for Pieces {
    #[inline(always)]
    fn directivity<S: Elementwise>(&self, s: S, along: S::V, inverse: S::V) -> S::V {
        let x = s.fma(along, inverse, s.splat(-MIDDLE));
        // x may lie on either side of the bound that it is nearest to.
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

/// c^n for an n that no short polynomial follows: broken and small, or large.
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
