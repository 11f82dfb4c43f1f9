//! Objective: the term of one point in the energy, squared or absolute, and its change without cancellation.

use crate::kernels::simd::{Elementwise, TINY};

/// The term of one point in the energy, as a function of |P|.
pub(crate) trait Term {
    /// Whether the term is (t - |P|)^2, for which the moments are known.
    const SQUARE: bool;
    /// Returns the change of the term when |P| grows by `rise`; `gap` = target - |P| before.
    fn change<S: Elementwise>(s: S, rise: S::V, gap: S::V) -> S::V;
    /// Returns a bound on the change of the term by a drive of modulus 1; `gain` is a bound on |G|, and so on |rise|.
    fn bound<S: Elementwise>(s: S, gain: S::V, gap: S::V) -> S::V;
}

/// (t - |P|)^2, the paper's eq. (7).
pub(crate) struct L2;

/// |t - |P||, which the authors' code minimises.
pub(crate) struct L1;

impl Term for L2 {
    const SQUARE: bool = true;

    #[inline(always)]
    fn change<S: Elementwise>(s: S, rise: S::V, gap: S::V) -> S::V {
        s.mul(rise, s.sub(rise, s.add(gap, gap)))
    }

    #[inline(always)]
    fn bound<S: Elementwise>(s: S, gain: S::V, gap: S::V) -> S::V {
        let gap = s.abs(gap);
        s.mul(gain, s.add(gain, s.add(gap, gap)))
    }
}

impl Term for L1 {
    const SQUARE: bool = false;

    #[inline(always)]
    fn change<S: Elementwise>(s: S, rise: S::V, gap: S::V) -> S::V {
        s.sub(s.abs(s.sub(gap, rise)), s.abs(gap))
    }

    #[inline(always)]
    fn bound<S: Elementwise>(_: S, gain: S::V, _gap: S::V) -> S::V {
        gain
    }
}

/// Squares of smaller numbers are 0 in f32. This constant is added to |P| + |P + e|, so that 0/0 does not occur.
const SMALLEST: f32 = 1e-20;

/// Returns |P + e| - |P|, the change of the modulus of a pressure P (re, im, modulus) when a wave e is added.
#[inline(always)]
pub(crate) fn rise<S: Elementwise>(s: S, [pr, pi, old]: [S::V; 3], [er, ei]: [S::V; 2]) -> S::V {
    let (x, y) = (s.add(pr, er), s.add(pi, ei));
    // This is |P + e|^2 - |P|^2 without the cancellation of two large terms.
    let square = s.fma(er, s.add(pr, x), s.mul(ei, s.add(pi, y)));
    let new = s.sqrt_rsqrt(s.max(s.fma(x, x, s.mul(y, y)), s.splat(TINY))).0;
    s.mul(square, reciprocal(s, s.add(new, s.add(old, s.splat(SMALLEST)))))
}

/// Returns 1/a of normal a > 0, from the inverse root and one step of Newton's method.
#[inline(always)]
fn reciprocal<S: Elementwise>(s: S, a: S::V) -> S::V {
    let guess = s.rsqrt_estimate(a);
    let guess = s.mul(guess, guess);
    s.fma(guess, s.fnma(a, guess, s.splat(1.0)), guess)
}
