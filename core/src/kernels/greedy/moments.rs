//! Moments: eq. (7) as a polynomial of one transducer's drive, with a bound on the remainder.
//!
//! ```text
//! for each group of 16 points: add its terms of A1, A2, A3, C, B, the power and R in each lane;
//!                              list the points with |u| > 1/4, which add only their power
//! sums over the lanes of all 16 at once, times the polynomial's factors
//! change(z) = B |z|^2 + ... for 16 candidates at a time
//! ```
//!
//! 1. Up to 16 moments fill one lane group: their sums over the lanes are one reduction.
//! 2. The factors and signs of the polynomial are multiplied into the moments once ([`FACTORS`]), and it is summed in
//!    two chains. This and reading the moments in the order of storage saved 15 % of a pass.
//! 3. w (1 - t/|P|), w t |P| and 1/|P|^2 are stored with the points: a group then takes 30 instructions.
//!
//! Point j has the pressure P_j, the target t, the weight w, and G_j is the transducer's pressure there at drive 1.
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
//! within R = sum w t |P| |u|^4 / (4 (1 - |u|)). The moments cost O(M) once; each candidate then costs the same for any
//! M. Points with |u| above [`FAR`], frequent at the first transducers, are left out and listed: their terms are
//! evaluated by eq. (7).
//!
//! A large grid has candidates close together. It also uses the terms of the fourth order,
//!
//! ```text
//! 5 Re(z^4 A4)/32 - a^2 Re(z^2 D)/8 - a^4 F/32,
//! A4 = sum w t |P| u^4                D  = sum w t |P| |u|^2 u^2       F = sum w t |P| |u|^4
//! ```
//!
//! and the change is then known within FAR R. The difference of two changes is known better. |1 + w| = sum b_p b_q w^p
//! conj(w)^q with sqrt(1 + x) = sum b_n x^n, and sum |b_n| x^n = 2 - sqrt(1 - x) has the square 5 - x - 4 sqrt(1 - x).
//! So the terms of degree n have a slope of at most 4 n |b_n| |w|^(n-1), which from n = 5 on is at most 35/64
//! |w|^(n-1). For two drives at a distance d the polynomial gives the difference within 35/32 d sum w t |P| |u|^5/(1 -
//! |u|) < 35/8 FAR R d.

use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::greedy::search::Points;
use crate::kernels::prelude::*;
use crate::math::sqrtf;

/// The largest |u| for which the polynomial is used.
pub(crate) const FAR: f32 = 0.25;

/// Number of moments. Their order: A1, A2, A3 and C (re before im), 2 B, the power, 4 R (1 - [`FAR`]), the energy, A4
/// and D.
pub(crate) const PARTS: usize = LANES;

/// Number of moments up to the third order; then the indices of the power (the remainder has the next index) and of the
/// energy.
pub(crate) const THIRD: usize = 12;
pub(crate) const POWER: usize = 9;
pub(crate) const ENERGY: usize = 11;

/// Factors of the moments' sums: the terms of the polynomial become fused products without signs.
pub(crate) const FACTORS: [f32; PARTS] = [
    2.0,
    -2.0,
    0.5,
    -0.5,
    -0.25,
    0.25,
    0.25,
    -0.25,
    0.5,
    1.0,
    0.25 / (1.0 - FAR),
    1.0,
    5.0 / 32.0,
    -5.0 / 32.0,
    -1.0 / 8.0,
    1.0 / 8.0,
];

/// Adds the terms of 16 points to the moments, without the energy; adds those of A4 and D if `FOURTH`. Returns the bits
/// of the points where the polynomial is not accurate: they add only their power.
#[inline(always)]
pub(crate) fn add_parts<S: Elementwise, const FOURTH: bool>(
    s: S,
    parts: &mut [S::V; PARTS],
    point: &PointGroup,
    [mut gr, mut gi]: [S::V; 2],
) -> u32 {
    let zero = s.splat(0.0);
    let [a1r, a1i, a2r, a2i, a3r, a3i, cr, ci, bow, power, rest, _, a4r, a4i, dr, di] = parts;
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
    // The term w t |P| u^2 of the moment A2. The terms of u^3 and of |u|^2 u follow from it.
    let (sr, si) = (s.fnma(ti, ui, s.mul(tr, ur)), s.fma(ti, ur, s.mul(tr, ui)));
    *a2r = s.add(*a2r, sr);
    *a2i = s.add(*a2i, si);
    *a3r = s.fma(sr, ur, s.fnma(si, ui, *a3r));
    *a3i = s.fma(sr, ui, s.fma(si, ur, *a3i));
    *cr = s.fma(size, tr, *cr);
    *ci = s.fma(size, ti, *ci);
    *rest = s.fma(s.mul(product, size), size, *rest);
    if FOURTH {
        let (vr, vi) = (s.fnma(ui, ui, s.mul(ur, ur)), s.mul(s.add(ur, ur), ui));
        *a4r = s.fma(sr, vr, s.fnma(si, vi, *a4r));
        *a4i = s.fma(sr, vi, s.fma(si, vr, *a4i));
        *dr = s.fma(size, sr, *dr);
        *di = s.fma(size, si, *di);
    }
    beyond
}

/// Number of values of a drive z in the polynomial: re and im of z, z^2, z^3 and |z|^2 z, and |z|^2. Value k is
/// multiplied by the moment of index k in [`PARTS`].
pub(crate) const POWERS: usize = 9;

/// Returns the [`POWERS`] values of drives (re, im).
#[inline(always)]
pub(crate) fn powers<S: Elementwise>(s: S, re: S::V, im: S::V) -> [S::V; POWERS] {
    let (re_re, re_im) = (s.mul(re, re), s.mul(re, im));
    let (square, re2) = (s.fma(im, im, re_re), s.fnma(im, im, re_re));
    let im2 = s.add(re_im, re_im);
    let (re3, im3) = (s.fnma(im, im2, s.mul(re, re2)), s.fma(im, re2, s.mul(re, im2)));
    [re, im, re2, im2, re3, im3, s.mul(square, re), s.mul(square, im), square]
}

/// Returns the change of the energy to the third order from moments `m` and values `z` of the drives, [`POWERS`] of
/// each.
#[inline(always)]
pub(crate) fn change<S: Elementwise>(s: S, m: impl Fn(usize) -> S::V, z: impl Fn(usize) -> S::V) -> S::V {
    // There are two independent sums, so the processor can add both at once.
    let low = s.fma(m(2), z(2), s.fma(m(3), z(3), s.mul(m(8), z(8))));
    let low = s.fma(m(0), z(0), s.fma(m(1), z(1), low));
    let high = s.fma(m(5), z(5), s.mul(m(4), z(4)));
    s.add(low, s.fma(m(6), z(6), s.fma(m(7), z(7), high)))
}

/// The terms of points in the moments, one partial sum in each lane. A quarter of the lanes that has no points contains
/// +0.
pub(crate) type Parts = [Lanes; PARTS];

/// Kernel that adds the terms of a group of points to the moments and finds the points that are left out.
struct OfGroup<'a, const FOURTH: bool> {
    parts: &'a mut Parts,
    /// Whether `parts` has no terms yet.
    first: bool,
    point: &'a PointGroup,
    row: [&'a Lanes; 2],
    beyond: u32,
}

impl<const FOURTH: bool> Apart for OfGroup<'_, FOURTH> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let mut parts = [s.splat(0.0); PARTS];
        if !self.first {
            for (part, lanes) in parts.iter_mut().zip(&*self.parts) {
                *part = s.load(lanes);
            }
        }
        self.beyond |= add_parts::<S, FOURTH>(s, &mut parts, self.point, self.row.map(|lanes| s.load(lanes)));
        for (part, lanes) in parts.iter().zip(&mut *self.parts) {
            s.store(*part, lanes);
        }
    }
}

/// The moments of one transducer, multiplied by [`FACTORS`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments(pub(crate) Lanes);

impl Moments {
    /// Computes the moments of a row over the points where the polynomial is accurate, with A4 and D if `FOURTH`.
    /// Writes the indices of the other points to the start of `near`, and returns their number. `energy` comes from
    /// [`PointGroup::add`].
    #[inline(always)]
    pub(crate) fn new<S: Simd, const FOURTH: bool>(
        s: S,
        points: Points<'_>,
        energy: S::V,
        near: &mut [u32],
        parts: &mut Parts,
    ) -> (Self, usize) {
        let mut count = 0;
        // The moments stay in registers if the machine has enough registers, else in memory.
        let mut registers = [s.splat(0.0); PARTS];
        let rows = groups(points.row[0]).iter().zip(groups(points.row[1]));
        for (group, (point, (re, im))) in points.groups.iter().zip(rows).enumerate() {
            let mut bits = if S::SHORT {
                let mut some = OfGroup::<FOURTH> { parts, first: group == 0, point, row: [re, im], beyond: 0 };
                s.apart(points.count - group * LANES, &mut some);
                some.beyond
            } else {
                add_parts::<S, FOURTH>(s, &mut registers, point, [s.load(re), s.load(im)])
            };
            while bits != 0 {
                near[count] = (group * LANES) as u32 + bits.trailing_zeros();
                count += 1;
                bits &= bits - 1;
            }
        }
        let sums = if S::SHORT {
            s.store(energy, &mut parts[ENERGY]);
            s.sums(parts, points.count)
        } else {
            registers[ENERGY] = energy;
            s.reduce_add_each(&registers)
        };
        let mut moments = Self(FACTORS);
        s.store(s.mul(sums, s.load(&FACTORS)), &mut moments.0);
        (moments, count)
    }

    /// Returns the power, sum w |G|^2.
    #[inline(always)]
    pub(crate) fn power(&self) -> f32 {
        self.0[POWER]
    }

    /// Returns the remainder R of the module's head, for drives of modulus 1.
    #[inline(always)]
    pub(crate) fn remainder(&self) -> f32 {
        self.0[POWER + 1]
    }

    /// Returns twice the moment A1 of the module's head: real and imaginary part.
    #[inline(always)]
    pub(crate) fn first(&self) -> [f32; 2] {
        [self.0[0], -self.0[1]]
    }

    /// Returns the change of the energy by the drives z = (re, im), to the third order.
    #[inline(always)]
    pub(crate) fn change<S: Elementwise>(&self, s: S, re: S::V, im: S::V) -> S::V {
        let z = powers(s, re, im);
        change(
            s,
            #[inline(always)]
            |k| s.splat(self.0[k]),
            #[inline(always)]
            |k| z[k],
        )
    }

    /// Returns the change of the energy by the drives z = (re, im), to the fourth order.
    #[inline(always)]
    pub(crate) fn fine_change<S: Elementwise>(&self, s: S, re: S::V, im: S::V) -> S::V {
        let square = s.fma(re, re, s.mul(im, im));
        let (re2, im2) = (s.fnma(im, im, s.mul(re, re)), s.mul(s.add(re, re), im));
        let (re4, im4) = (s.fnma(im2, im2, s.mul(re2, re2)), s.mul(s.add(re2, re2), im2));
        let [a4r, a4i, dr, di] = [s.splat(self.0[12]), s.splat(self.0[13]), s.splat(self.0[14]), s.splat(self.0[15])];
        // The moment F of the module's head is computed from the remainder R.
        let constant = s.splat(-(1.0 - FAR) / 8.0 * self.remainder());
        let even = s.fma(dr, re2, s.fma(di, im2, s.mul(square, constant)));
        let low = s.fma(square, even, self.change(s, re, im));
        s.fma(a4r, re4, s.fma(a4i, im4, low))
    }

    /// Returns a bound on the second derivative of the change over the phase, at amplitude a.
    #[inline(always)]
    pub(crate) fn curvature(&self, a: f32) -> f32 {
        let size = |k: usize| sqrtf(self.0[k] * self.0[k] + self.0[k + 1] * self.0[k + 1]);
        let cubic = 9.0 * size(4) + size(6);
        a * (size(0) + a * (4.0 * size(2) + a * cubic))
    }

    /// Returns a bound on g2 + (1 + a) g3 for a up to 1, where the change is a g1 + a^2 g2 + a^3 g3 at any phase.
    #[inline(always)]
    pub(crate) fn bow(&self) -> f32 {
        let size = |k: usize| sqrtf(self.0[k] * self.0[k] + self.0[k + 1] * self.0[k + 1]);
        self.0[8] + size(2) + 2.0 * (size(4) + size(6))
    }

    /// Returns the [`slack`] of these moments.
    #[inline(always)]
    pub(crate) fn slack(&self, reach: f32) -> f32 {
        slack(self.power(), self.remainder(), self.0[ENERGY], reach)
    }

    /// Returns the [`rounding`] of these moments.
    #[inline(always)]
    pub(crate) fn rounding(&self, reach: f32) -> f32 {
        rounding(self.power(), self.0[ENERGY], reach)
    }

    /// Returns the remainder of the fourth order: |u| is below [`FAR`].
    #[inline(always)]
    pub(crate) fn fine_remainder(&self) -> f32 {
        FAR * self.remainder()
    }

    /// Returns a bound of the fourth order's remainder in the difference of two changes, for each unit of distance
    /// between the drives, whose modulus is at most 1.
    #[inline(always)]
    pub(crate) fn steepness(&self) -> f32 {
        35.0 / 8.0 * FAR * self.remainder()
    }
}

/// Returns the uncertainty of the difference between two changes by drives of modulus up to `reach`: remainder,
/// tolerance of ties and rounding of the sums.
#[inline(always)]
pub(crate) fn slack(power: f32, remainder: f32, energy: f32, reach: f32) -> f32 {
    let square = reach * reach;
    2.0 * square * square * remainder + rounding(power, energy, reach)
}

/// Returns the part of the uncertainty that comes from the tolerance of ties and the rounding of the sums. By Cauchy
/// `sum w |G| |t - |P||` is at most the root of power times energy.
#[inline(always)]
fn rounding(power: f32, energy: f32, reach: f32) -> f32 {
    4e-7 * (reach * reach * power + reach * sqrtf(power * energy))
}
