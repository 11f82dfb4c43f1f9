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
//!
//! A large grid, whose candidates lie close together, takes the terms of the fourth order too,
//!
//! ```text
//! 5 Re(z^4 A4)/32 - a^2 Re(z^2 D)/8 - a^4 F/32,
//! A4 = sum w t |P| u^4                D  = sum w t |P| |u|^2 u^2       F = sum w t |P| |u|^4
//! ```
//!
//! and is within FAR R. Of a difference less is left. |1 + w| = sum b_p b_q w^p conj(w)^q with sqrt(1 + x) =
//! sum b_n x^n, and sum |b_n| x^n = 2 - sqrt(1 - x) has the square 5 - x - 4 sqrt(1 - x). So the terms of degree n have
//! a slope of at most 4 n |b_n| |w|^(n-1), which from n = 5 on is at most 35/64 |w|^(n-1), and two drives d apart differ
//! by the polynomial's difference within 35/32 d sum w t |P| |u|^5/(1 - |u|) < 35/8 FAR R d.

use super::search::{self, L2, Term};
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

    /// Adds the changes of the terms under the drive q to `total`, as [`search::add_changes`] does.
    #[inline(always)]
    pub(crate) fn add_change<S: Simd>(
        &self,
        s: S,
        [gr, gi]: [&Lanes; 2],
        [qr, qi]: [S::V; 2],
        total: S::V,
    ) -> S::V {
        let (gr, gi) = (s.load(gr), s.load(gi));
        let e = [s.fnma(gi, qi, s.mul(gr, qr)), s.fma(gi, qr, s.mul(gr, qi))];
        let old = [&self.re, &self.im, &self.modulus].map(|x| s.load(x));
        let gap = s.sub(s.load(&self.target), old[2]);
        let change = L2::change(s, search::rise(s, old, e), gap);
        s.fma(s.load(&self.weight), change, total)
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
    /// 5 A4/32, -D/8 and -F/32, if asked for.
    fourth: [f32; 2],
    turning: [f32; 2],
    level: f32,
    /// The energy before.
    pub(crate) energy: f32,
}

impl Moments {
    /// The moments of a row over the points where the polynomial holds, A4 and D if `FOURTH`; the others are put into
    /// `near`, from its start, and counted. `energy` comes from [`Sixteen::add`].
    #[inline(always)]
    pub(crate) fn new<S: Simd, const FOURTH: bool>(
        s: S,
        points: &[Sixteen],
        row: [&[f32]; 2],
        energy: S::V,
        near: &mut [u32],
    ) -> (Self, usize) {
        let zero = s.splat(0.0);
        let [mut a1r, mut a1i, mut a2r, mut a2i, mut a3r, mut a3i] = [zero; 6];
        let [mut cr, mut ci, mut bow, mut power, mut rest] = [zero; 5];
        let [mut a4r, mut a4i, mut dr, mut di] = [zero; 4];
        let mut count = 0;
        let rows = groups(row[0]).iter().zip(groups(row[1]));
        for (group, (point, (gr, gi))) in points.iter().zip(rows).enumerate() {
            let (gr, gi) = (s.load(gr), s.load(gi));
            let (weight, inverse) = (s.load(&point.weight), s.load(&point.inverse));
            let (pull, product) = (s.load(&point.pull), s.load(&point.product));
            let square = s.fma(gr, gr, s.mul(gi, gi));
            power = s.fma(weight, square, power);
            let size = s.mul(square, inverse);
            let beyond = s.less(s.splat(FAR * FAR), size);
            let (mut gr, mut gi, mut square, mut size) = (gr, gi, square, size);
            if beyond != 0 {
                let far = s.splat(FAR * FAR);
                gr = s.select_less(far, size, zero, gr);
                gi = s.select_less(far, size, zero, gi);
                square = s.select_less(far, size, zero, square);
                size = s.select_less(far, size, zero, size);
                let mut bits = beyond;
                while bits != 0 {
                    near[count] = (group * LANES) as u32 + bits.trailing_zeros();
                    count += 1;
                    bits &= bits - 1;
                }
            }
            let (pr, pi) = (s.load(&point.re), s.load(&point.im));
            let er = s.fma(pr, gr, s.mul(pi, gi));
            let ei = s.fnma(pi, gr, s.mul(pr, gi));
            a1r = s.fma(pull, er, a1r);
            a1i = s.fma(pull, ei, a1i);
            bow = s.fma(s.add(weight, pull), square, bow);
            let (ur, ui) = (s.mul(er, inverse), s.mul(ei, inverse));
            let (tr, ti) = (s.mul(product, ur), s.mul(product, ui));
            // w t |P| u^2, and from it u^3 and |u|^2 u.
            let (sr, si) = (s.fnma(ti, ui, s.mul(tr, ur)), s.fma(ti, ur, s.mul(tr, ui)));
            a2r = s.add(a2r, sr);
            a2i = s.add(a2i, si);
            a3r = s.fma(sr, ur, s.fnma(si, ui, a3r));
            a3i = s.fma(sr, ui, s.fma(si, ur, a3i));
            cr = s.fma(size, tr, cr);
            ci = s.fma(size, ti, ci);
            rest = s.fma(s.mul(product, size), size, rest);
            if FOURTH {
                let (vr, vi) = (s.fnma(ui, ui, s.mul(ur, ur)), s.mul(s.add(ur, ur), ui));
                a4r = s.fma(sr, vr, s.fnma(si, vi, a4r));
                a4i = s.fma(sr, vi, s.fma(si, vr, a4i));
                dr = s.fma(size, sr, dr);
                di = s.fma(size, si, di);
            }
        }
        let sums =
            s.sums(&[a1r, a1i, a2r, a2i, a3r, a3i, cr, ci, bow, power, rest, energy, a4r, a4i, dr, di]);
        let factors = [
            2.0,
            2.0,
            0.5,
            0.5,
            -0.25,
            -0.25,
            0.25,
            0.25,
            0.5,
            1.0,
            0.25 / (1.0 - FAR),
            1.0,
            5.0 / 32.0,
            5.0 / 32.0,
            -1.0 / 8.0,
            -1.0 / 8.0,
        ];
        let mut m: Lanes = [0.0; LANES];
        s.store(s.mul(sums, s.load(&factors)), &mut m);
        let moments = Self {
            first: [m[0], m[1]],
            second: [m[2], m[3]],
            third: [m[4], m[5]],
            crossed: [m[6], m[7]],
            bow: m[8],
            power: m[9],
            remainder: m[10],
            energy: m[11],
            fourth: [m[12], m[13]],
            turning: [m[14], m[15]],
            level: -(1.0 - FAR) / 8.0 * m[10],
        };
        (moments, count)
    }

    /// The change of the energy under the drives z = (re, im).
    #[inline(always)]
    pub(crate) fn change<S: Simd>(&self, s: S, re: S::V, im: S::V) -> S::V {
        let (re_re, re_im) = (s.mul(re, re), s.mul(re, im));
        let (square, re2) = (s.fma(im, im, re_re), s.fnma(im, im, re_re));
        let im2 = s.add(re_im, re_im);
        let (re3, im3) = (s.fnma(im, im2, s.mul(re, re2)), s.fma(im, re2, s.mul(re, im2)));
        let bow = s.add(s.splat(self.bow), part(s, self.crossed, re, im, s.splat(0.0)));
        let sum = part(s, self.first, re, im, s.mul(square, bow));
        part(s, self.third, re3, im3, part(s, self.second, re2, im2, sum))
    }

    /// The change to the fourth order.
    #[inline(always)]
    pub(crate) fn fine_change<S: Simd>(&self, s: S, re: S::V, im: S::V) -> S::V {
        let square = s.fma(re, re, s.mul(im, im));
        let (re2, im2) = (s.fnma(im, im, s.mul(re, re)), s.mul(s.add(re, re), im));
        let (re4, im4) = (s.fnma(im2, im2, s.mul(re2, re2)), s.mul(s.add(re2, re2), im2));
        let even = part(s, self.turning, re2, im2, s.mul(square, s.splat(self.level)));
        part(s, self.fourth, re4, im4, s.fma(square, even, self.change(s, re, im)))
    }

    /// A bound on the second derivative of the change over the phase, at amplitude a.
    #[inline(always)]
    pub(crate) fn curvature(&self, a: f32) -> f32 {
        let size = |[re, im]: [f32; 2]| sqrtf(re * re + im * im);
        let cubic = 9.0 * size(self.third) + size(self.crossed);
        a * (size(self.first) + a * (4.0 * size(self.second) + a * cubic))
    }

    /// A bound on g2 + (1 + a) g3 for a up to 1, where the change is a g1 + a^2 g2 + a^3 g3 at any phase.
    #[inline(always)]
    pub(crate) fn bow(&self) -> f32 {
        let size = |[re, im]: [f32; 2]| sqrtf(re * re + im * im);
        self.bow + size(self.second) + 2.0 * (size(self.third) + size(self.crossed))
    }

    /// What the remainder, the tolerance of ties and the rounding of the sums leave open between two drives of
    /// modulus up to `reach`.
    #[inline(always)]
    pub(crate) fn slack(&self, reach: f32) -> f32 {
        let square = reach * reach;
        2.0 * square * square * self.remainder + self.rounding(reach)
    }

    /// What the tolerance of ties and the rounding of the sums leave open. By Cauchy `sum w |G| |t - |P||` is at most
    /// the root of power times energy.
    #[inline(always)]
    pub(crate) fn rounding(&self, reach: f32) -> f32 {
        4e-7 * (reach * reach * self.power + reach * sqrtf(self.power * self.energy))
    }

    /// The remainder to the fourth order: |u| is below [`FAR`].
    #[inline(always)]
    pub(crate) fn fine_remainder(&self) -> f32 {
        FAR * self.remainder
    }

    /// A bound on the fine remainder of the difference between two drives of modulus up to 1, for each unit that
    /// they are apart.
    #[inline(always)]
    pub(crate) fn steepness(&self) -> f32 {
        35.0 / 8.0 * FAR * self.remainder
    }
}

/// Re((re + j im)(c + j d)) + sum.
#[inline(always)]
fn part<S: Simd>(s: S, [re, im]: [f32; 2], c: S::V, d: S::V, sum: S::V) -> S::V {
    s.fma(s.splat(re), c, s.fnma(s.splat(im), d, sum))
}
