//! Dither between two amplitudes: each transducer in turn takes the amplitude with the smaller errors at the points.
//!
//! ```text
//! for each driven transducer i with row G_i, drive q_i and part a_i of its amplitude:
//!     c_j = G_ij q_i / P_j                the share of the transducer in the pressure P_j of point j; only its real part
//!                                         counts, except at quiet points
//!     a   = the value of the pair with the least sum_j |e_j + (a - a_i) c_j|^2
//!     e_j += (a - a_i) c_j;   a_i = a     e_j is the error at point j relative to P_j
//! ```
//!
//! Before its turn a transducer counts with its requested part, between the two values. Its choice leaves an error,
//! which the later transducers correct (Floyd and Steinberg, Proc. SID 17(2), 1976).

use crate::kernels::prelude::*;
use crate::kernels::propagate::rows::Rows;

/// Values at the points; all lists have the same padded length.
pub(crate) struct Points<'a> {
    /// The errors e at the points, real and imaginary parts; the imaginary part is 0 except at quiet points.
    pub(crate) error: [&'a mut [f32]; 2],
    /// 1/P of the pressures P; 0 in the padding.
    pub(crate) inverse: [&'a [f32]; 2],
    /// 1 at quiet points, 0 elsewhere.
    pub(crate) quiet: &'a [f32],
    /// Working memory for one row of G.
    pub(crate) row: [&'a mut [f32]; 2],
}

/// Sets the part of each driven transducer of a `range` to one value of `pair`.
///
/// # Errors
/// A requested stop, which is checked once a transducer. The parts of the transducers before it are set.
pub(crate) fn choose(
    set: InstructionSet,
    rows: Rows<'_>,
    (range, drive): (Range<usize>, &[Complex32]),
    points: Points<'_>,
    parts: &mut [f32],
    pair: [f32; 2],
    control: &mut Control,
) -> Result<()> {
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

/// Replaces a row of G by the shares c of a transducer of drive q. Returns the sums over the points of e c and c^2, with
/// the errors e. The module's head defines c and e.
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
