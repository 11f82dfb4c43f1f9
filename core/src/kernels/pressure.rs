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
