//! Objective: a point's term of eq. (7), squared or absolute, and its change without cancellation.

use crate::kernels::simd::{Elementwise, TINY};

/// A point's term of the energy, by how it changes with |P|.
pub(crate) trait Term {
    /// Whether the objective is (t - |P|)^2, whose moments are known.
    const SQUARE: bool;
    /// The change of the term when |P| rises by `rise`, `gap` = target - |P| before.
    fn change<S: Elementwise>(s: S, rise: S::V, gap: S::V) -> S::V;
    /// A bound on it for a drive of modulus 1: `gain` bounds |G|, and so |rise|.
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

/// Squares of smaller numbers vanish in f32; added to |P| + |P + e| it keeps 0/0 away.
const SMALLEST: f32 = 1e-20;

/// |P + e| - |P|, from P (re, im, modulus) and e.
#[inline(always)]
pub(crate) fn rise<S: Elementwise>(s: S, [pr, pi, old]: [S::V; 3], [er, ei]: [S::V; 2]) -> S::V {
    let (x, y) = (s.add(pr, er), s.add(pi, ei));
    // |P + e|^2 - |P|^2 without the cancellation of its two large parts.
    let square = s.fma(er, s.add(pr, x), s.mul(ei, s.add(pi, y)));
    let new = s.sqrt_rsqrt(s.max(s.fma(x, x, s.mul(y, y)), s.splat(TINY))).0;
    s.mul(square, reciprocal(s, s.add(new, s.add(old, s.splat(SMALLEST)))))
}

/// 1/a of normal a > 0, by the inverse root and one step of Newton.
#[inline(always)]
fn reciprocal<S: Elementwise>(s: S, a: S::V) -> S::V {
    let guess = s.rsqrt_estimate(a);
    let guess = s.mul(guess, guess);
    s.fma(guess, s.fnma(a, guess, s.splat(1.0)), guess)
}
