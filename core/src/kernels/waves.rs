//! Waves: eq. (5) in double precision, eight transducers at a time: parameters, ray, phase, decay and directivity.
//!
//! Plain loops without fused products: every instruction set gives the same bits.

use crate::kernels::simd::doubles::{Doubles, EIGHT, Eight, V, list};
use crate::prelude::*;

/// Number of Taylor coefficients of D by c = cos(theta): D, D', D''/2, D'''/6, D''''/24.
pub(crate) const SLOPES: usize = 5;

/// exp(-x) is computed as exp(-x/2^HALVINGS), squared as many times.
const HALVINGS: usize = 7;

/// Complex vectors: real and imaginary parts.
pub(super) type C<S> = [V<S>; 2];

/// Position, normal and factor of eight transducers; lanes without a transducer have factor 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emitters {
    /// Positions in m.
    pub(crate) position: [Eight; 3],
    /// Unit normals.
    pub(crate) normal: [Eight; 3],
    /// The factor of eq. (5), real and imaginary part: source pressure times response, and the drive if it is known.
    pub(crate) factor: [Eight; 2],
}

impl Emitters {
    /// Creates blocks of eight from transducers: position, normal, factor.
    pub(crate) fn all(of: impl ExactSizeIterator<Item = ([f64; 3], [f64; 3], [f64; 2])>) -> Vec<Self> {
        let mut blocks: Vec<Self> = Vec::with_capacity(of.len().div_ceil(EIGHT));
        for (i, (position, normal, factor)) in of.enumerate() {
            if i % EIGHT == 0 {
                let [position, normal] = [position, normal].map(|vector| vector.map(|x| [x; EIGHT]));
                blocks.push(Self { position, normal, factor: [[0.0; EIGHT]; 2] });
            }
            let Some(block) = blocks.last_mut() else { continue };
            for axis in 0..3 {
                block.position[axis][i % EIGHT] = position[axis];
                block.normal[axis][i % EIGHT] = normal[axis];
            }
            for part in 0..2 {
                block.factor[part][i % EIGHT] = factor[part];
            }
        }
        blocks
    }
}

/// How D and its derivatives by c = cos(theta) are computed.
pub(crate) enum Slopes {
    /// The directivity D is 1.
    One,
    /// D is a polynomial in y = `square` (1 - c^2) with coefficients `terms`; 0 behind the transducer.
    Even { square: f64, terms: Vec<f64> },
    /// A function returns the Taylor coefficients at c.
    Each(Box<dyn Fn(f64) -> [f64; SLOPES] + Send + Sync>),
}

/// Properties of the air and the directivity of all transducers.
pub(crate) struct Waves {
    /// The wavenumber k in rad/m.
    pub(crate) wavenumber: f64,
    /// The absorption alpha in 1/m.
    pub(crate) absorption: f64,
    pub(crate) slopes: Slopes,
    /// dD/dk and its derivatives by c, where D is a function of k sin(theta); `None` where D depends only on theta.
    pub(crate) widening: Option<Slopes>,
}

/// Returns w* z per lane, z times the conjugate of w.
#[inline(always)]
pub(super) fn against<S: Doubles>(w: C<S>, z: C<S>) -> C<S> {
    [w[0] * z[0] + w[1] * z[1], w[0] * z[1] - w[1] * z[0]]
}

/// Returns exp(-x) of x >= 0 with a relative error of 1e-13. Instead of a result below 1e-55 it may return any number
/// below 1e-55.
#[inline(always)]
pub(super) fn decay<S: Doubles>(s: S, x: V<S>) -> V<S> {
    let most = V::all(s, 128.0);
    let part = x.where_less(x, most, most) * (-1.0 / f64::from(1 << HALVINGS));
    let mut sum = V::all(s, 1.0);
    for n in (1..16).rev() {
        sum = sum * part * (1.0 / f64::from(n)) + 1.0;
    }
    for _ in 0..HALVINGS {
        sum = sum * sum;
    }
    sum
}

/// Returns D and its Taylor coefficients by c, for a polynomial in y = `square` (1 - c^2); 0 behind the transducer.
#[inline(always)]
pub(super) fn even<S: Doubles>(s: S, square: f64, terms: &[f64], c: V<S>) -> [V<S>; SLOPES] {
    let [zero, one] = [V::all(s, 0.0), V::all(s, 1.0)];
    let c = c.where_less(c, one, one);
    let y = (one - c * c) * square;
    let mut f = [zero; SLOPES];
    for &term in terms.iter().rev() {
        f = [f[0] * y + term, f[1] * y + f[0], f[2] * y + f[1], f[3] * y + f[2], f[4] * y + f[3]];
    }
    // If c changes by h, y changes by -square (2 c h + h^2).
    let (a, b) = (c * (-2.0 * square), -square);
    let third = f[2] * a * (2.0 * b) + f[3] * a * a * a;
    let fourth = f[2] * (b * b) + f[3] * a * a * (3.0 * b) + f[4] * a * a * a * a;
    let slopes = [f[0], f[1] * a, f[1] * b + f[2] * a * a, third, fourth];
    list(s, |n| zero.where_less(c, zero, slopes[n]))
}
