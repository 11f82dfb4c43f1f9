//! The pressures at the points: adding a transducer, moduli, projections, squares.

use core::array::from_fn;

use super::{LANES, Lanes, groups, groups_mut};
use crate::math::sqrtf;

/// P += G q, q = (re, im).
pub(crate) fn accumulate(row: [&[f32]; 2], drive: [f32; 2], re: &mut [f32], im: &mut [f32]) {
    let [qr, qi] = drive;
    let rows = groups(row[0]).iter().zip(groups(row[1]));
    for ((gr, gi), (pr, pi)) in rows.zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
        *pr = from_fn(|l| pr[l] + (gr[l] * qr - gi[l] * qi));
        *pi = from_fn(|l| pi[l] + (gr[l] * qi + gi[l] * qr));
    }
}

/// out = |P|.
pub(crate) fn modulus(re: &[f32], im: &[f32], out: &mut [f32]) {
    for ((re, im), out) in groups(re).iter().zip(groups(im)).zip(groups_mut(out)) {
        *out = from_fn(|l| sqrtf(re[l] * re[l] + im[l] * im[l]));
    }
}

/// sum_j conj(G_j) t_j for real t: (re, im).
pub(crate) fn project(row: [&[f32]; 2], targets: &[f32]) -> [f32; 2] {
    let mut re = [0.0; LANES];
    let mut im = [0.0; LANES];
    for ((gr, gi), t) in groups(row[0]).iter().zip(groups(row[1])).zip(groups(targets)) {
        re = from_fn(|l| re[l] + gr[l] * t[l]);
        im = from_fn(|l| im[l] - gi[l] * t[l]);
    }
    [sum(&re), sum(&im)]
}

/// sum_j conj(G_j) p_j for complex p: (re, im).
pub(crate) fn correlate(row: [&[f32]; 2], pressure: [&[f32]; 2]) -> [f32; 2] {
    let mut re = [0.0; LANES];
    let mut im = [0.0; LANES];
    let pressures = groups(pressure[0]).iter().zip(groups(pressure[1]));
    for ((gr, gi), (pr, pi)) in groups(row[0]).iter().zip(groups(row[1])).zip(pressures) {
        re = from_fn(|l| re[l] + (gr[l] * pr[l] + gi[l] * pi[l]));
        im = from_fn(|l| im[l] + (gr[l] * pi[l] - gi[l] * pr[l]));
    }
    [sum(&re), sum(&im)]
}

/// sum_j a_j b_j.
pub(crate) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut total = [0.0; LANES];
    for (a, b) in groups(a).iter().zip(groups(b)) {
        total = from_fn(|l| total[l] + a[l] * b[l]);
    }
    sum(&total)
}

/// out += f a for four vectors at once: `out += sum_b factors_b vectors_b`.
pub(crate) fn add_scaled(factors: [f32; 4], vectors: [&[f32]; 4], out: &mut [f32]) {
    let [a, b, c, d] = vectors.map(groups);
    let pairs = a.iter().zip(b).zip(c.iter().zip(d));
    for (((a, b), (c, d)), out) in pairs.zip(groups_mut(out)) {
        *out = from_fn(|l| {
            out[l] + ((factors[0] * a[l] + factors[1] * b[l]) + (factors[2] * c[l] + factors[3] * d[l]))
        });
    }
}

/// out += |G|^2.
pub(crate) fn squares(row: [&[f32]; 2], out: &mut [f32]) {
    for ((re, im), out) in groups(row[0]).iter().zip(groups(row[1])).zip(groups_mut(out)) {
        *out = from_fn(|l| out[l] + (re[l] * re[l] + im[l] * im[l]));
    }
}

/// The sum over lanes, halves upon halves: a fixed tree, so that its rounding is part of the contract.
#[inline(always)]
fn sum(lanes: &Lanes) -> f32 {
    let eight: [f32; 8] = from_fn(|l| lanes[l] + lanes[l + 8]);
    let four: [f32; 4] = from_fn(|l| eight[l] + eight[l + 4]);
    (four[0] + four[2]) + (four[1] + four[3])
}
