//! Contraction: turns gradients by Taylor coefficients of a pressure into gradients by transducers, eight at a time.
//!
//! C_t are the Taylor coefficients of a transducer's wave F around a point, W_t the cotangents of those of the pressure
//! (`kernels::derivatives`). Let Z = sum_t W_t* C_t, and Z_a the same sum for dF/dx_a. Z' has C_t (1 + degree of t) in
//! place of C_t, and L is the sum for x times dF/dx, x the vector from the point. The derivatives of Re(q Z), q the
//! drive, with respect to the drive, the ray d, the unit normal n and the wavenumber k are (u and D as in
//! `kernels::backward`)
//!
//! ```text
//! by q   Z*                            by d   Re q Z_a
//! by n   n x Re q (d x (Z_a) + L)      turning ray and normal together changes nothing
//! by k   Re q (j/u) (Z' + sum_a d_a Z_a), and of dD/dk in place of D Re q Z      F = u f(u d) at constant D
//! ```
//!
//! Plain loops without fused products: every instruction set gives the same bits.

use crate::kernels::backward::{Pull, Senders};
use crate::kernels::derivatives::{MORE_TERMS, TERMS, expand};
use crate::kernels::prelude::*;
use crate::kernels::simd::doubles::{Doubles, EIGHT, V, dot, list, loaded, ray, runs, total};
use crate::kernels::waves::{C, Emitters, Slopes, Waves};

/// Number of blocks of eight transducers between two checks for a stop.
const RUN: usize = 8;

/// The index of a Taylor term, and the factor of its coefficient: real and imaginary part.
pub(crate) type Weight = (usize, [f64; 2]);

/// The terms of each sum of the module's head, with their factors.
#[derive(Default)]
pub(crate) struct Weights {
    /// Terms of the sum Z of the module's head.
    pub(crate) value: Vec<Weight>,
    /// Terms of the sums Z_a of the module's head, for each axis a.
    pub(crate) slopes: [Vec<Weight>; 3],
    /// Terms of the sum Z' of the module's head.
    pub(crate) grown: Vec<Weight>,
    /// Terms of the sums L of the module's head, for each axis.
    pub(crate) turned: [Vec<Weight>; 3],
}

/// Returns the gradients with respect to a point (3 numbers) and to the wavenumber (the last one); adds those with
/// respect to the transducers to `pulls`.
pub(crate) fn contract(
    set: InstructionSet,
    Senders { waves, emitters, drives }: Senders<'_>,
    point: [f64; 3],
    weights: &Weights,
    pulls: &mut [Pull],
    control: &mut Control,
) -> Result<[f64; 4]> {
    let mut sums = [[0.0; EIGHT]; 4];
    for ((blocks, drives), pulls) in emitters.chunks(RUN).zip(drives.chunks(RUN)).zip(pulls.chunks_mut(RUN)) {
        control.pulse()?;
        dispatch!(set, s => {
            for ((block, drive), pull) in blocks.iter().zip(drives).zip(pulls.iter_mut()) {
                for at in runs(s) {
                    let drive = loaded(s, drive, at);
                    let terms = contracted(s, waves, block, at, point, drive, weights, pull);
                    for k in 0..4 {
                        terms[k].onto(&mut sums[k][at..]);
                    }
                }
            }
        });
    }
    Ok(sums.map(total))
}

#[allow(clippy::too_many_arguments, reason = "part of a kernel")]
#[inline(always)]
fn contracted<S: Doubles>(
    s: S,
    waves: &Waves,
    block: &Emitters,
    at: usize,
    point: [f64; 3],
    q: C<S>,
    weights: &Weights,
    pull: &mut Pull,
) -> [V<S>; 4] {
    let c = expand::<S, MORE_TERMS>(s, waves, &waves.slopes, block, at, point);
    let value = summed(s, &weights.value, &c);
    value[0].onto(&mut pull.drive[0][at..]);
    (value[1] * -1.0).onto(&mut pull.drive[1][at..]);
    let d = ray(s, point, (&block.position, at));
    let mut slopes = [[V::all(s, 0.0); 3]; 2];
    for axis in 0..3 {
        let slope = driven(q, summed(s, &weights.slopes[axis], &c));
        (slopes[0][axis], slopes[1][axis]) = (slope[0], slope[1]);
    }
    let mut grown = driven(q, summed(s, &weights.grown, &c));
    for part in 0..2 {
        grown[part] = grown[part] + dot(d, slopes[part]);
    }
    let (k, alpha) = (waves.wavenumber, waves.absorption);
    let mut by_k = (grown[0] * k + grown[1] * alpha) * (1.0 / (k * k + alpha * alpha));
    let v = slopes[0];
    if !matches!(waves.slopes, Slopes::One) {
        let torque = cross(s, d, v);
        let turn = list(s, |axis| torque[axis] + driven(q, summed(s, &weights.turned[axis], &c))[0]);
        let by_normal = cross(s, loaded(s, &block.normal, at), turn);
        for axis in 0..3 {
            by_normal[axis].onto(&mut pull.normal[axis][at..]);
        }
    }
    if let Some(widening) = &waves.widening {
        let c = expand::<S, TERMS>(s, waves, widening, block, at, point);
        by_k = by_k + driven(q, summed(s, &weights.value, &c))[0];
    }
    for axis in 0..3 {
        (v[axis] * -1.0).onto(&mut pull.position[axis][at..]);
    }
    [v[0], v[1], v[2], by_k]
}

#[inline(always)]
fn summed<S: Doubles, const COUNT: usize>(s: S, weights: &[Weight], c: &[[V<S>; COUNT]; 2]) -> C<S> {
    let mut sum = [V::all(s, 0.0); 2];
    for &(term, [re, im]) in weights {
        let [own_re, own_im] = [c[0][term], c[1][term]];
        sum[0] = sum[0] + (own_re * re - own_im * im);
        sum[1] = sum[1] + (own_im * re + own_re * im);
    }
    sum
}

#[inline(always)]
fn driven<S: Doubles>(q: C<S>, z: C<S>) -> C<S> {
    [q[0] * z[0] - q[1] * z[1], q[0] * z[1] + q[1] * z[0]]
}

#[inline(always)]
fn cross<S: Doubles>(s: S, a: [V<S>; 3], b: [V<S>; 3]) -> [V<S>; 3] {
    list(s, |axis| {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        a[next] * b[last] - a[last] * b[next]
    })
}
