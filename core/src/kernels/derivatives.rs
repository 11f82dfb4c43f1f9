//! Derivatives of eq. (5) by the place, up to the third or fourth, in double precision: eight transducers at a time.
//!
//! With the ray d of length r from a transducer of normal n, s = |d|^2/2, h = d . n and c = h/r, eq. (5) is F(s, h) =
//! g(s) D(c), g = e^{ur}/r, u = jk - alpha. A step x changes s by d . x + |x|^2/2 and h by n . x. So with e = d/r and
//! f_ab = r^{2a+b} times the derivative of F by s (a times) and h (b times), the Taylor terms of F in x are
//!
//! ```text
//! degree 1: 1/r   [ f10 ex + f01 nx ],   ex = e . x, nx = n . x
//! degree 2: 1/r^2 [ f20 ex^2/2 + f11 ex nx + f02 nx^2/2 + f10 |x|^2/2 ]
//! degree 3: 1/r^3 [ f30 ex^3/6 + f21 ex^2 nx/2 + f12 ex nx^2/2 + f03 nx^3/6 + |x|^2 (f20 ex + f11 nx)/2 ]
//! degree 4: 1/r^4 [ ex^2 (f40 ex^2/24 + f31 ex nx/6 + f22 nx^2/4 + f30 |x|^2/4) + nx^2 (f13 ex nx/6 + f04 nx^2/24 + f12 |x|^2/4)
//!                   + |x|^2 (f21 ex nx/2 + f20 |x|^2/8) ]
//! ```
//!
//! Plain loops without fused products: every instruction set gives the same bits.

use crate::kernels::phasor::phasor;
use crate::kernels::prelude::*;
use crate::kernels::simd::doubles::{Doubles, EIGHT, Eight, V, dot, loaded, ray, runs, scaled, total};
use crate::kernels::waves::{C, Emitters, Slopes, Waves, even};
use crate::math::exp;

/// Number of monomials x^a y^b z^c of degree up to 3, in this order: 1; x, y, z; x^2, xy, xz, y^2, yz, z^2; ...
pub(crate) const TERMS: usize = 20;

/// Number of monomials of degree up to 4, in the same order.
pub(crate) const MORE_TERMS: usize = 35;

/// Calls `take` with each block's Taylor coefficients around a point, real and imaginary parts. No transducer may be at
/// the point.
pub(crate) fn each(
    set: InstructionSet,
    waves: &Waves,
    emitters: &[Emitters],
    point: [f64; 3],
    mut take: impl FnMut(usize, &[[Eight; MORE_TERMS]; 2]),
    control: &mut Control,
) -> Result<()> {
    let mut terms = [[[0.0; EIGHT]; MORE_TERMS]; 2];
    for (b, block) in emitters.iter().enumerate() {
        control.pulse()?;
        dispatch!(set, s => {
            for at in runs(s) {
                let derivatives = expand::<_, MORE_TERMS>(s, waves, &waves.slopes, block, at, point);
                for part in 0..2 {
                    for term in 0..MORE_TERMS {
                        derivatives[part][term].put(&mut terms[part][term][at..]);
                    }
                }
            }
        });
        take(b, &terms);
    }
    Ok(())
}

/// Returns the sum of the Taylor coefficients around a point over all transducers: real and imaginary parts.
pub(crate) fn sum(
    set: InstructionSet,
    waves: &Waves,
    emitters: &[Emitters],
    point: [f64; 3],
    control: &mut Control,
) -> Result<[[f64; MORE_TERMS]; 2]> {
    let mut sums = [[[0.0; EIGHT]; MORE_TERMS]; 2];
    for blocks in emitters.chunks(EIGHT) {
        control.pulse()?;
        dispatch!(set, s => {
            for block in blocks {
                for at in runs(s) {
                    let derivatives = expand::<_, MORE_TERMS>(s, waves, &waves.slopes, block, at, point);
                    for part in 0..2 {
                        for term in 0..MORE_TERMS {
                            let sum = &mut sums[part][term][at..];
                            (V::of(s, sum) + derivatives[part][term]).put(sum);
                        }
                    }
                }
            }
        });
    }
    Ok(sums.map(|part| part.map(total)))
}

/// Writes each block's waves at a point, real and imaginary part. Distances below `least` count as `least`.
pub(crate) fn values(
    set: InstructionSet,
    waves: &Waves,
    emitters: &[Emitters],
    point: [f64; 3],
    least: f64,
    out: &mut [[Eight; 2]],
) {
    dispatch!(set, s => {
        for (block, out) in emitters.iter().zip(out) {
            for at in runs(s) {
                let wave = value(s, waves, block, at, point, least);
                for part in 0..2 {
                    wave[part].put(&mut out[part][at..]);
                }
            }
        }
    });
}

#[inline(always)]
fn value<S: Doubles>(s: S, waves: &Waves, block: &Emitters, at: usize, point: [f64; 3], least: f64) -> C<S> {
    let d = ray(s, point, (&block.position, at));
    let (r, least) = (dot(d, d).sqrt(), V::all(s, least));
    let r = least.where_less(r, least, r);
    let near = r.inverse();
    let wave = times(spread(s, waves, r, near), loaded(s, &block.factor, at));
    let c = dot(d, loaded(s, &block.normal, at)) * near;
    match &waves.slopes {
        Slopes::One => wave,
        Slopes::Even { square, terms } => by(wave, even(s, *square, terms, c)[0]),
        Slopes::Each(of) => by(wave, c.each(|c| [of(c)[0]])[0]),
    }
}

/// Returns the waves e^{ur}/r, u = jk - alpha, for distances r and their inverses `near`.
#[inline(always)]
fn spread<S: Doubles>(s: S, waves: &Waves, r: V<S>, near: V<S>) -> C<S> {
    let (cos, sin) = phasor(s, r * (waves.wavenumber / TAU));
    let amplitude = if waves.absorption > 0.0 { near * r.each(|r| [exp(-waves.absorption * r)])[0] } else { near };
    [amplitude * cos, amplitude * sin]
}

/// Returns the first [`TERMS`] or [`MORE_TERMS`] Taylor coefficients of a block, with the directivity given by
/// `slopes`.
#[inline(always)]
pub(super) fn expand<S: Doubles, const COUNT: usize>(
    s: S,
    waves: &Waves,
    slopes: &Slopes,
    block: &Emitters,
    at: usize,
    point: [f64; 3],
) -> [[V<S>; COUNT]; 2] {
    let zero = V::all(s, 0.0);
    let out = &mut [[zero; COUNT]; 2];
    let ray = ray(s, point, (&block.position, at));
    let r = dot(ray, ray).sqrt();
    let near = r.inverse();
    let e = scaled(ray, near);
    let n = loaded(s, &block.normal, at);
    let factor = loaded(s, &block.factor, at);
    // G_a = r^{2a} times the a-th derivative of g by s, times the factor: g times 1, v - 1, v^2 - 3v + 3, v^3 - 6v^2 + 15v - 15,
    // v^4 - 10v^3 + 45v^2 - 105v + 105, v = ur.
    let v = [r * -waves.absorption, r * waves.wavenumber];
    let g0 = times(spread(s, waves, r, near), factor);
    let g1 = times([v[0] - 1.0, v[1]], g0);
    let g2 = times(plus(times([v[0] - 3.0, v[1]], v), 3.0), g0);
    let g3 = times([v[0] - 6.0, v[1]], v);
    let g3 = times(plus(times(plus(g3, 15.0), v), -15.0), g0);
    let g4 = times(plus(times([v[0] - 10.0, v[1]], v), 45.0), v);
    let g4 = times(plus(times(plus(g4, -105.0), v), 105.0), g0);
    let c = dot(e, n);
    let slopes = match slopes {
        Slopes::One => {
            constant(out, g0);
            first(out, near, g1, e, None);
            second_third(out, near, [e, n], [g1, g2, g3], None);
            if COUNT == MORE_TERMS {
                fourth(s, out, near, [e, n], [g2, g3, g4], None);
            }
            return *out;
        }
        Slopes::Even { square, terms } => even(s, *square, terms, c),
        Slopes::Each(of) => c.each(of),
    };
    // Derivatives of D by s (first digit) and h (second digit), times r^{2a+b}.
    let [d, d1, d2, d3, d4] = [slopes[0], slopes[1], slopes[2] * 2.0, slopes[3] * 6.0, slopes[4] * 24.0];
    let (c2, d3c) = (c * c, d3 * c);
    let (d01, d10, d02) = (d1, d1 * c * -1.0, d2);
    let d11 = (d2 * c + d1) * -1.0;
    let d20 = d2 * c2 + d1 * c * 3.0;
    let (d03, d12) = (d3, (d3c + d2 * 2.0) * -1.0);
    let d21 = d3c * c + d2 * c * 5.0 + d1 * 3.0;
    let d30 = (d3c * c2 + d2 * c2 * 9.0 + d1 * c * 15.0) * -1.0;
    constant(out, by(g0, d));
    let f10 = both(by(g1, d), by(g0, d10));
    let f01 = by(g0, d01);
    first(out, near, f10, e, Some((f01, n)));
    let f20 = both(both(by(g2, d), by(g1, d10 * 2.0)), by(g0, d20));
    let f11 = both(by(g1, d01), by(g0, d11));
    let f02 = by(g0, d02);
    let f30 = both(both(by(g3, d), by(g2, d10 * 3.0)), both(by(g1, d20 * 3.0), by(g0, d30)));
    let f21 = both(both(by(g2, d01), by(g1, d11 * 2.0)), by(g0, d21));
    let f12 = both(by(g1, d02), by(g0, d12));
    let f03 = by(g0, d03);
    second_third(out, near, [e, n], [f10, f20, f30], Some([f11, f02, f21, f12, f03]));
    if COUNT == MORE_TERMS {
        let d4c = d4 * c;
        let (d04, d13) = (d4, (d4c + d3 * 3.0) * -1.0);
        let d22 = d4c * c + d3c * 7.0 + d2 * 8.0;
        let d31 = (d4c * c2 + d3 * c2 * 12.0 + d2 * c * 33.0 + d1 * 15.0) * -1.0;
        let d40 = d4 * c2 * c2 + d3c * c2 * 18.0 + d2 * c2 * 87.0 + d1 * c * 105.0;
        let f40 = both(both(by(g4, d), by(g3, d10 * 4.0)), by(g2, d20 * 6.0));
        let f40 = both(f40, both(by(g1, d30 * 4.0), by(g0, d40)));
        let f31 = both(both(by(g3, d01), by(g2, d11 * 3.0)), both(by(g1, d21 * 3.0), by(g0, d31)));
        let f22 = both(both(by(g2, d02), by(g1, d12 * 2.0)), by(g0, d22));
        let f13 = both(by(g1, d03), by(g0, d13));
        fourth(s, out, near, [e, n], [f20, f30, f40], Some([f21, f31, f12, f22, f13, by(g0, d04)]));
    }
    *out
}

#[inline(always)]
fn constant<S: Doubles, const COUNT: usize>(out: &mut [[V<S>; COUNT]; 2], f: C<S>) {
    for part in 0..2 {
        out[part][0] = f[part];
    }
}

/// Writes the Taylor coefficients of degree 1, from f10 and, where there is a directivity, f01 (see the module's head).
#[inline(always)]
fn first<S: Doubles, const COUNT: usize>(
    out: &mut [[V<S>; COUNT]; 2],
    near: V<S>,
    f10: C<S>,
    e: [V<S>; 3],
    directed: Option<(C<S>, [V<S>; 3])>,
) {
    for part in 0..2 {
        for axis in 0..3 {
            let slope = f10[part] * e[axis];
            let slope = if let Some((f01, n)) = directed { slope + f01[part] * n[axis] } else { slope };
            out[part][1 + axis] = slope * near;
        }
    }
}

/// Writes the coefficients of degrees 2 and 3. `directed` has f11, f02, f21, f12, f03 where there is a directivity.
#[inline(always)]
fn second_third<S: Doubles, const COUNT: usize>(
    out: &mut [[V<S>; COUNT]; 2],
    near: V<S>,
    [e, n]: [[V<S>; 3]; 2],
    [f10, f20, f30]: [C<S>; 3],
    directed: Option<[C<S>; 5]>,
) {
    let (ee, en, nn) = (product(e, e), product(e, n), product(n, n));
    let (square, cube) = (near * near, near * near * near);
    for part in 0..2 {
        let [half, sixth] = [f20[part] * 0.5, f30[part] * (1.0 / 6.0)];
        let mut second = scaled(ee, half);
        let mut along = scaled(ee, sixth);
        let mut across = [near * 0.0; 6];
        if let Some([f11, f02, f21, f12, f03]) = directed {
            for t in 0..6 {
                second[t] = second[t] + en[t] * f11[part] + nn[t] * (f02[part] * 0.5);
                along[t] = along[t] + en[t] * (f21[part] * 0.5);
                across[t] = en[t] * (f12[part] * 0.5) + nn[t] * (f03[part] * (1.0 / 6.0));
            }
            for t in [0, 3, 5] {
                across[t] = across[t] + f11[part] * 0.5;
            }
        }
        for t in [0, 3, 5] {
            second[t] = second[t] + f10[part] * 0.5;
            along[t] = along[t] + half;
        }
        for t in 0..6 {
            out[part][4 + t] = second[t] * square;
        }
        let mut third = cubic(e, along);
        if directed.is_some() {
            let more = cubic(n, across);
            for t in 0..10 {
                third[t] = third[t] + more[t];
            }
        }
        for t in 0..10 {
            out[part][10 + t] = third[t] * cube;
        }
    }
}

/// Writes the coefficients of degree 4. `directed` has f21, f31, f12, f22, f13, f04 where there is a directivity.
#[inline(always)]
fn fourth<S: Doubles, const COUNT: usize>(
    s: S,
    out: &mut [[V<S>; COUNT]; 2],
    near: V<S>,
    [e, n]: [[V<S>; 3]; 2],
    [f20, f30, f40]: [C<S>; 3],
    directed: Option<[C<S>; 6]>,
) {
    let (ee, en, nn) = (product(e, e), product(e, n), product(n, n));
    let [zero, one] = [V::all(s, 0.0), V::all(s, 1.0)];
    let unit = [one, zero, zero, one, zero, one];
    let scale = near * near * near * near;
    for part in 0..2 {
        let mut along = scaled(ee, f40[part] * (1.0 / 24.0));
        let mut level = scaled(unit, f20[part] * 0.125);
        let mut across = [zero; 6];
        for t in [0, 3, 5] {
            along[t] = along[t] + f30[part] * 0.25;
        }
        if let Some([f21, f31, f12, f22, f13, f04]) = directed {
            for t in 0..6 {
                along[t] = along[t] + en[t] * (f31[part] * (1.0 / 6.0)) + nn[t] * (f22[part] * 0.25);
                level[t] = level[t] + en[t] * (f21[part] * 0.5);
                across[t] = en[t] * (f13[part] * (1.0 / 6.0)) + nn[t] * (f04[part] * (1.0 / 24.0));
            }
            for t in [0, 3, 5] {
                across[t] = across[t] + f12[part] * 0.25;
            }
        }
        let (mut sum, level) = (quartic(ee, along), quartic(unit, level));
        for t in 0..15 {
            sum[t] = sum[t] + level[t];
        }
        if directed.is_some() {
            let across = quartic(nn, across);
            for t in 0..15 {
                sum[t] = sum[t] + across[t];
            }
        }
        for t in 0..15 {
            out[part][TERMS + t] = sum[t] * scale;
        }
    }
}

/// Returns the coefficients of x^2, xy, xz, y^2, yz, z^2 in the quadratic form (a . x)(b . x).
#[inline(always)]
fn product<S: Doubles>(a: [V<S>; 3], b: [V<S>; 3]) -> [V<S>; 6] {
    let mixed = |i: usize, j: usize| a[i] * b[j] + a[j] * b[i];
    [a[0] * b[0], mixed(0, 1), mixed(0, 2), a[1] * b[1], mixed(1, 2), a[2] * b[2]]
}

/// Returns the product of a linear and a quadratic form, in the order of [`TERMS`].
#[inline(always)]
fn cubic<S: Doubles>(l: [V<S>; 3], [xx, xy, xz, yy, yz, zz]: [V<S>; 6]) -> [V<S>; 10] {
    let [x, y, z] = l;
    [
        x * xx,
        x * xy + y * xx,
        x * xz + z * xx,
        x * yy + y * xy,
        x * yz + y * xz + z * xy,
        x * zz + z * xz,
        y * yy,
        y * yz + z * yy,
        y * zz + z * yz,
        z * zz,
    ]
}

/// Returns the product of two quadratic forms, in the order of [`MORE_TERMS`].
#[inline(always)]
fn quartic<S: Doubles>(a: [V<S>; 6], b: [V<S>; 6]) -> [V<S>; 15] {
    let pair = |i: usize, j: usize| a[i] * b[j] + a[j] * b[i];
    let like = |i: usize| a[i] * b[i];
    [
        like(0),
        pair(0, 1),
        pair(0, 2),
        pair(0, 3) + like(1),
        pair(0, 4) + pair(1, 2),
        pair(0, 5) + like(2),
        pair(1, 3),
        pair(1, 4) + pair(2, 3),
        pair(1, 5) + pair(2, 4),
        pair(2, 5),
        like(3),
        pair(3, 4),
        pair(3, 5) + like(4),
        pair(4, 5),
        like(5),
    ]
}

#[inline(always)]
fn times<S: Doubles>(a: C<S>, b: C<S>) -> C<S> {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

#[inline(always)]
fn plus<S: Doubles>([re, im]: C<S>, x: f64) -> C<S> {
    [re + x, im]
}

#[inline(always)]
fn both<S: Doubles>(a: C<S>, b: C<S>) -> C<S> {
    [a[0] + b[0], a[1] + b[1]]
}

#[inline(always)]
fn by<S: Doubles>([re, im]: C<S>, x: V<S>) -> C<S> {
    [re * x, im * x]
}
