//! Dither between two amplitudes: each transducer in turn takes the one that leaves the smaller errors at the points.
//!
//! ```text
//! for each driven transducer i:
//!     c_j = G_ij q_i / P_j                           the part of a point's pressure that it makes; across counts at quiet points
//!     a   = the one of two parts with the least sum_j |e_j + (a - a_i) c_j|^2
//!     e_j += (a - a_i) c_j;   a_i = a
//! ```
//!
//! A transducer that has not chosen yet counts with the requested part, between the two: its choice leaves an error,
//! which the next ones correct (Floyd and Steinberg, Proc. SID 17(2), 1976).

use core::ops::Range;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::Error;
use crate::kernels::lanes::{groups, groups_mut};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::Simd;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};

/// Values at the points, all lists padded alike.
pub(crate) struct Points<'a> {
    /// e, re and im: im is 0 but at quiet points.
    pub(crate) error: [&'a mut [f32]; 2],
    /// 1 / P; 0 where there is no point.
    pub(crate) inverse: [&'a [f32]; 2],
    /// 1 at quiet points.
    pub(crate) quiet: &'a [f32],
    /// Memory for a row.
    pub(crate) row: [&'a mut [f32]; 2],
}

/// Gives each transducer of a `range` one part of a `pair`, in place of the one that it has.
///
/// # Errors
/// A stop, polled once a transducer: those before have chosen.
pub(crate) fn choose(
    set: InstructionSet,
    rows: Rows<'_>,
    (range, drive): (Range<usize>, &[Complex32]),
    points: Points<'_>,
    parts: &mut [f32],
    pair: [f32; 2],
    control: &mut Control,
) -> Result<(), Error> {
    dispatch!(set, s => {
        let Points { error: [error_re, error_im], inverse, quiet, row: [re, im] } = points;
        for i in range.filter(|&i| drive[i] != Complex32::ZERO) {
            control.pulse()?;
            rows.write(s, i, re, im);
            let [with, square] = along(s, drive[i], inverse, quiet, [&mut *re, &mut *im], [&*error_re, &*error_im]);
            let [below, above] = pair;
            let cost = 2.0 * (with - parts[i] * square) + (below + above) * square;
            let chosen = if cost < 0.0 { above } else { below };
            let change = s.splat(chosen - parts[i]);
            parts[i] = chosen;
            for (error, wave) in [(&mut *error_re, &*re), (&mut *error_im, &*im)] {
                for (error, wave) in groups_mut(error).iter_mut().zip(groups(wave)) {
                    s.store(s.fma(change, s.load(wave), s.load(error)), error);
                }
            }
        }
        Ok(())
    })
}

/// Turns a row into the parts c of a transducer of drive q; the sums of e c and of c^2.
#[inline(always)]
fn along<S: Simd>(
    s: S,
    q: Complex32,
    inverse: [&[f32]; 2],
    quiet: &[f32],
    [re, im]: [&mut [f32]; 2],
    error: [&[f32]; 2],
) -> [f32; 2] {
    let (qr, qi) = (s.splat(q.re), s.splat(q.im));
    let (mut with, mut square) = (s.splat(0.0), s.splat(0.0));
    let known = groups(inverse[0]).iter().zip(groups(inverse[1])).zip(groups(quiet));
    let errors = groups(error[0]).iter().zip(groups(error[1]));
    for (((re, im), ((ir, ii), quiet)), (er, ei)) in
        groups_mut(re).iter_mut().zip(groups_mut(im)).zip(known).zip(errors)
    {
        let (gr, gi, ir, ii) = (s.load(re), s.load(im), s.load(ir), s.load(ii));
        let wave = [s.fnma(gi, qi, s.mul(gr, qr)), s.fma(gr, qi, s.mul(gi, qr))];
        let c = s.fnma(wave[1], ii, s.mul(wave[0], ir));
        let across = s.mul(s.fma(wave[0], ii, s.mul(wave[1], ir)), s.load(quiet));
        with = s.fma(s.load(er), c, s.fma(s.load(ei), across, with));
        square = s.fma(c, c, s.fma(across, across, square));
        s.store(c, re);
        s.store(across, im);
    }
    [s.reduce_add(with), s.reduce_add(square)]
}
