//! Eq. (7) as a polynomial of one transducer's drive.
//!
//! With u_j = G_j / P_j and z = a e^{j phi}, |P_j + G_j z| = |P_j| |1 + u_j z|, and
//!
//! ```text
//! |1 + w| = 1 + Re w + (|w|^2 - Re w^2)/4 - (|w|^2 Re w - Re w^3)/8 + r,   |r| <= |w|^4 / (8 (1 - |w|))
//! ```
//!
//! (Gegenbauer polynomials: the coefficients of |w|^n are at most 1/8 from n = 4 on). So the energy changes by
//!
//! ```text
//! a^2 B + 2 Re(z A1) + Re(z^2 A2)/2 - Re(z^3 A3)/4 + a^2 Re(z C)/4,
//! B  = sum w |G|^2 (1 - t/(2|P|))     A1 = sum w conj(P) G (1 - t/|P|)
//! A2 = sum w t |P| u^2                A3 = sum w t |P| u^3             C = sum w t |P| |u|^2 u
//! ```
//!
//! within R = sum w t |P| |u|^4 / (4 (1 - |u|)): moments that cost O(M) once, and then nothing of M for any
//! number of candidates. Points with |u| above [`FAR`] (at the first transducers) are left out and named, to be
//! evaluated exactly.

use super::simd::{Simd, TINY};
use super::{LANES, Lanes, groups};
use crate::math::sqrtf;

/// The largest |u| that the polynomial is used for.
const FAR: f32 = 0.25;

/// What is kept of 16 points, refreshed when their pressures change.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sixteen {
    /// The pressures P.
    pub(crate) re: Lanes,
    pub(crate) im: Lanes,
    /// |P|.
    pub(crate) modulus: Lanes,
    /// 1/|P|^2, so large for silence that |u| is above [`FAR`]; 0 for a quiet point, whose term has no remainder.
    inverse: Lanes,
    /// w (1 - t/|P|).
    pull: Lanes,
    /// w t |P|.
    product: Lanes,
    pub(crate) target: Lanes,
    pub(crate) weight: Lanes,
}

impl Sixteen {
    /// Silence where pressures t are wanted, with weights w.
    #[inline(always)]
    pub(crate) fn silent<S: Simd>(s: S, target: &Lanes, weight: &Lanes) -> Self {
        let none = [0.0; LANES];
        let mut sixteen = Self {
            re: none,
            im: none,
            modulus: none,
            inverse: none,
            pull: none,
            product: none,
            target: *target,
            weight: *weight,
        };
        sixteen.refresh(s, s.splat(0.0), s.splat(0.0));
        sixteen
    }

    /// The points of the problem in a lane, where each of `points` is one point of several problems.
    #[inline(always)]
    pub(super) fn of_lane<S: Simd>(s: S, points: &[Self], lane: usize) -> Self {
        let mut own = Self::silent(s, &[0.0; LANES], &[0.0; LANES]);
        for (j, point) in points.iter().enumerate() {
            own.re[j] = point.re[lane];
            own.im[j] = point.im[lane];
            own.modulus[j] = point.modulus[lane];
            own.inverse[j] = point.inverse[lane];
            own.pull[j] = point.pull[lane];
            own.product[j] = point.product[lane];
            own.target[j] = point.target[lane];
            own.weight[j] = point.weight[lane];
        }
        own
    }

    /// Sets the pressures; returns the energies w (t - |P|)^2.
    #[inline(always)]
    fn refresh<S: Simd>(&mut self, s: S, re: S::V, im: S::V) -> S::V {
        let (target, weight) = (s.load(&self.target), s.load(&self.weight));
        let square = s.fma(re, re, s.mul(im, im));
        let (root, inverse) = s.roots(s.max(square, s.splat(TINY)));
        let zero = s.splat(0.0);
        let modulus = s.select_less(square, s.splat(TINY), zero, root);
        let weighted = s.mul(weight, target);
        s.store(re, &mut self.re);
        s.store(im, &mut self.im);
        s.store(modulus, &mut self.modulus);
        s.store(s.select_less(zero, target, s.mul(inverse, inverse), zero), &mut self.inverse);
        s.store(s.fnma(weighted, inverse, weight), &mut self.pull);
        s.store(s.mul(weighted, modulus), &mut self.product);
        let gap = s.sub(target, modulus);
        s.mul(s.mul(weight, gap), gap)
    }

    /// P += G q; returns the energies.
    #[inline(always)]
    pub(crate) fn add<S: Simd>(&mut self, s: S, [gr, gi]: [&Lanes; 2], [qr, qi]: [S::V; 2]) -> S::V {
        let (gr, gi) = (s.load(gr), s.load(gi));
        let re = s.fma(gr, qr, s.fnma(gi, qi, s.load(&self.re)));
        let im = s.fma(gr, qi, s.fma(gi, qr, s.load(&self.im)));
        self.refresh(s, re, im)
    }
}

/// The moments of one transducer.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    /// 2 A1, A2/2, -A3/4 and C/4.
    pub(crate) first: [f32; 2],
    pub(crate) second: [f32; 2],
    pub(crate) third: [f32; 2],
    pub(crate) crossed: [f32; 2],
    /// B.
    pub(crate) bow: f32,
    /// sum w |G|^2.
    pub(crate) power: f32,
    /// R, for drives of modulus 1.
    pub(crate) remainder: f32,
    /// The energy before.
    pub(crate) energy: f32,
}

/// What a lane adds to the moments, in this order: A1, A2, A3 and C (re before im), 2 B, the power, 4 R (1 - [`FAR`])
/// and the energy.
pub(super) const PARTS: usize = 12;

/// By what the sums of the parts are multiplied.
pub(super) const FACTORS: [f32; PARTS] =
    [2.0, 2.0, 0.5, 0.5, -0.25, -0.25, 0.25, 0.25, 0.5, 1.0, 0.25 / (1.0 - FAR), 1.0];

/// Adds the parts of 16 points, energies apart. Bit l is set where the polynomial does not hold: such points add
/// their power alone.
#[inline(always)]
pub(super) fn add_parts<S: Simd>(
    s: S,
    parts: &mut [S::V; PARTS],
    point: &Sixteen,
    [mut gr, mut gi]: [S::V; 2],
) -> u32 {
    let zero = s.splat(0.0);
    let [a1r, a1i, a2r, a2i, a3r, a3i, cr, ci, bow, power, rest, _] = parts;
    let (weight, inverse) = (s.load(&point.weight), s.load(&point.inverse));
    let (pull, product) = (s.load(&point.pull), s.load(&point.product));
    let mut square = s.fma(gr, gr, s.mul(gi, gi));
    *power = s.fma(weight, square, *power);
    let mut size = s.mul(square, inverse);
    let far = s.splat(FAR * FAR);
    let beyond = s.less(far, size);
    if beyond != 0 {
        gr = s.select_less(far, size, zero, gr);
        gi = s.select_less(far, size, zero, gi);
        square = s.select_less(far, size, zero, square);
        size = s.select_less(far, size, zero, size);
    }
    let (pr, pi) = (s.load(&point.re), s.load(&point.im));
    let er = s.fma(pr, gr, s.mul(pi, gi));
    let ei = s.fnma(pi, gr, s.mul(pr, gi));
    *a1r = s.fma(pull, er, *a1r);
    *a1i = s.fma(pull, ei, *a1i);
    *bow = s.fma(s.add(weight, pull), square, *bow);
    let (ur, ui) = (s.mul(er, inverse), s.mul(ei, inverse));
    let (tr, ti) = (s.mul(product, ur), s.mul(product, ui));
    // w t |P| u^2, and from it u^3 and |u|^2 u.
    let (sr, si) = (s.fnma(ti, ui, s.mul(tr, ur)), s.fma(ti, ur, s.mul(tr, ui)));
    *a2r = s.add(*a2r, sr);
    *a2i = s.add(*a2i, si);
    *a3r = s.fma(sr, ur, s.fnma(si, ui, *a3r));
    *a3i = s.fma(sr, ui, s.fma(si, ur, *a3i));
    *cr = s.fma(size, tr, *cr);
    *ci = s.fma(size, ti, *ci);
    *rest = s.fma(s.mul(product, size), size, *rest);
    beyond
}

/// What the polynomial takes of a drive z.
#[derive(Clone, Copy)]
pub(super) struct Powers<V> {
    /// |z|^2.
    pub(super) square: V,
    /// z, z^2, z^3 and |z|^2 z.
    pub(super) first: [V; 2],
    pub(super) second: [V; 2],
    pub(super) third: [V; 2],
    pub(super) crossed: [V; 2],
}

/// The powers of the drives (re, im).
#[inline(always)]
pub(super) fn powers<S: Simd>(s: S, re: S::V, im: S::V) -> Powers<S::V> {
    let (re_re, re_im) = (s.mul(re, re), s.mul(re, im));
    let (square, re2) = (s.fma(im, im, re_re), s.fnma(im, im, re_re));
    let im2 = s.add(re_im, re_im);
    let (re3, im3) = (s.fnma(im, im2, s.mul(re, re2)), s.fma(im, re2, s.mul(re, im2)));
    let crossed = [s.mul(square, re), s.mul(square, im)];
    Powers { square, first: [re, im], second: [re2, im2], third: [re3, im3], crossed }
}

/// The change of the energy: `m` are 2 A1, A2/2, -A3/4, C/4 (re before im) and B.
#[inline(always)]
pub(super) fn change<S: Simd>(s: S, m: &[S::V; 9], z: &Powers<S::V>) -> S::V {
    // Two sums, that neither waits long.
    let low = part(s, [m[0], m[1]], z.first, part(s, [m[2], m[3]], z.second, s.mul(m[8], z.square)));
    let high = s.fnma(m[5], z.third[1], s.mul(m[4], z.third[0]));
    s.add(low, part(s, [m[6], m[7]], z.crossed, high))
}

/// Re((re + j im)(c + j d)) + sum.
#[inline(always)]
fn part<S: Simd>(s: S, [re, im]: [S::V; 2], [c, d]: [S::V; 2], sum: S::V) -> S::V {
    s.fma(re, c, s.fnma(im, d, sum))
}

impl Moments {
    /// The moments of a row over the points where the polynomial holds; the others are put into `near`, from
    /// its start, and counted. `energy` comes from [`Sixteen::add`].
    #[inline(always)]
    pub(crate) fn new<S: Simd>(
        s: S,
        points: &[Sixteen],
        row: [&[f32]; 2],
        energy: S::V,
        near: &mut [u32],
    ) -> (Self, usize) {
        let zero = s.splat(0.0);
        let mut parts = [zero; PARTS];
        let mut count = 0;
        let rows = groups(row[0]).iter().zip(groups(row[1]));
        for (group, (point, (gr, gi))) in points.iter().zip(rows).enumerate() {
            let mut bits = add_parts(s, &mut parts, point, [s.load(gr), s.load(gi)]);
            while bits != 0 {
                near[count] = (group * LANES) as u32 + bits.trailing_zeros();
                count += 1;
                bits &= bits - 1;
            }
        }
        let [a1r, a1i, a2r, a2i, a3r, a3i, cr, ci, bow, power, rest, _] = parts;
        let sums =
            s.sums(&[a1r, a1i, a2r, a2i, a3r, a3i, cr, ci, bow, power, rest, energy, zero, zero, zero, zero]);
        let mut m: Lanes = [0.0; LANES];
        m[..PARTS].copy_from_slice(&FACTORS);
        s.store(s.mul(sums, s.load(&m)), &mut m);
        let moments = Self {
            first: [m[0], m[1]],
            second: [m[2], m[3]],
            third: [m[4], m[5]],
            crossed: [m[6], m[7]],
            bow: m[8],
            power: m[9],
            remainder: m[10],
            energy: m[11],
        };
        (moments, count)
    }

    /// The change of the energy under the drives z = (re, im).
    #[inline(always)]
    pub(crate) fn change<S: Simd>(&self, s: S, re: S::V, im: S::V) -> S::V {
        let Self { first: [a, b], second: [c, d], third: [e, f], crossed: [g, h], bow, .. } = *self;
        let m = [
            s.splat(a),
            s.splat(b),
            s.splat(c),
            s.splat(d),
            s.splat(e),
            s.splat(f),
            s.splat(g),
            s.splat(h),
            s.splat(bow),
        ];
        change(s, &m, &powers(s, re, im))
    }

    /// A bound on the second derivative of the change over the phase, at amplitude a.
    pub(crate) fn curvature(&self, a: f32) -> f32 {
        let size = |[re, im]: [f32; 2]| sqrtf(re * re + im * im);
        let cubic = 9.0 * size(self.third) + size(self.crossed);
        a * (size(self.first) + a * (4.0 * size(self.second) + a * cubic))
    }

    /// What the remainder, the tolerance of ties and the rounding of the sums leave open between two drives of
    /// modulus up to `reach`. By Cauchy `sum w |G| |t - |P||` is at most the root of power times energy.
    pub(crate) fn slack(&self, reach: f32) -> f32 {
        let square = reach * reach;
        let rounding = reach * reach * self.power + reach * sqrtf(self.power * self.energy);
        2.0 * square * square * self.remainder + 4e-7 * rounding
    }
}
