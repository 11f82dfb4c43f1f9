//! Field of a drive, P += G q: elements of G are added in registers, and no row is written.
//!
//! ```text
//! for each run of 512 transducers, each lane group of points:
//!     load P;  for each driven transducer:  P += element q;  store P
//! ```
//!
//! 1. P is loaded and stored once a run, so that an element costs its own instructions and four more.
//! 2. Up to four points would leave most lanes empty. Then the lanes contain sixteen transducers, and their waves are
//!    added one after another, so that the bits are the same. At M = 1 and 4 points this takes half of the time.
//! 3. The sources of a run, 16 KB, stay in the nearest cache. (Where the code must be short, the stack must be small
//!    too: a run then has 64 transducers.)

use crate::kernels::prelude::*;
use crate::kernels::propagate::row::{ControlPoints, element, silence};
use crate::kernels::propagate::source::{Form, Radiation, SourceList, formed};
use crate::kernels::vector::add_wave;

/// Number of transducers in a run: their waves are added before the next points follow.
const RUN: usize = 512;

/// Number of transducers in a run where the stack is small.
const SHORT_RUN: usize = 64;

/// Largest number of points for which the lanes contain transducers.
const FEW: usize = 4;

/// Adds the waves G q of all transducers whose drive q is not 0 to the field.
///
/// # Errors
/// A requested stop, which is checked at least once every [`RUN`] elements.
pub(crate) fn add_field(
    set: InstructionSet,
    radiation: &Radiation,
    sources: &SourceList,
    drive: &[Complex32],
    points: ControlPoints<'_>,
    field: [&mut [f32]; 2],
    control: &mut Control,
) -> Result<()> {
    if points.count <= FEW && !set.is_short() {
        return dispatch!(set, s => formed!(s, radiation, sources.in_phase, form => {
            add_few(s, form, (radiation, sources), drive, points, field, control)
        }));
    }
    dispatch!(set, s => formed!(s, radiation, sources.in_phase, form => {
        let mut sum = Sum { form, radiation, sources, drive, points, field, control, ended: Ok(()) };
        s.apart(points.count, &mut sum);
        sum.ended
    }))
}

/// Does the same as [`add_field`] at up to [`FEW`] points.
#[inline(always)]
fn add_few<S: Elementwise, F: Form>(
    s: S,
    form: F,
    (radiation, sources): (&Radiation, &SourceList),
    drive: &[Complex32],
    points: ControlPoints<'_>,
    [re, im]: [&mut [f32]; 2],
    control: &mut Control,
) -> Result<()> {
    let [x, y, z] = points.coordinates;
    let mut sums = [[s.splat(0.0); 2]; FEW];
    for (j, sum) in sums.iter_mut().enumerate().take(points.count) {
        *sum = [s.splat(re[j]), s.splat(im[j])];
    }
    for (group, drive) in sources.groups.iter().zip(drive.chunks(LANES)) {
        control.pulse()?;
        let (from, mut tile) = (group.all(s), [[[0.0; LANES]; 2]; FEW]);
        for (j, [real, imag]) in tile.iter_mut().enumerate().take(points.count) {
            let g = element(s, form, radiation, &from, [s.splat(x[j]), s.splat(y[j]), s.splat(z[j])]);
            s.store(g[0], real);
            s.store(g[1], imag);
        }
        for (lane, q) in drive.iter().enumerate().filter(|(_, q)| **q != Complex32::ZERO) {
            let q = [s.splat(q.re), s.splat(q.im)];
            for (sum, [real, imag]) in sums.iter_mut().zip(&tile) {
                *sum = add_wave(s, [s.splat(real[lane]), s.splat(imag[lane])], q, *sum);
            }
        }
    }
    for (j, sum) in sums.iter().enumerate().take(points.count) {
        for (part, sum) in [&mut *re, &mut *im].into_iter().zip(sum) {
            let mut lanes = [0.0; LANES];
            s.store(*sum, &mut lanes);
            part[j] = lanes[0];
        }
    }
    silence(s, re, points.count);
    silence(s, im, points.count);
    Ok(())
}

/// Kernel that adds the waves G q to a field over some lanes. It does nothing after a stop in other lanes, see `ended`.
struct Sum<'a, 'b, F> {
    form: F,
    radiation: &'a Radiation,
    sources: &'a SourceList,
    drive: &'a [Complex32],
    points: ControlPoints<'a>,
    field: [&'a mut [f32]; 2],
    control: &'a mut Control<'b>,
    ended: Result<()>,
}

impl<F: Form> Apart for Sum<'_, '_, F> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let Self { form, radiation, sources, drive, points, field: [re, im], control, ended } = self;
        let (from, to) = ((*radiation, *sources), [&mut **re, &mut **im]);
        if ended.is_ok() {
            *ended = if S::SHORT {
                add_form::<_, _, SHORT_RUN>(s, *form, from, drive, *points, to, control)
            } else {
                add_form::<_, _, RUN>(s, *form, from, drive, *points, to, control)
            };
        }
    }
}

#[inline(always)]
fn add_form<S: Elementwise, F: Form, const RUN: usize>(
    s: S,
    form: F,
    (radiation, sources): (&Radiation, &SourceList),
    drive: &[Complex32],
    points: ControlPoints<'_>,
    [re, im]: [&mut [f32]; 2],
    control: &mut Control,
) -> Result<()> {
    for (run, drive) in drive.chunks(RUN).enumerate() {
        let mut driven = [(0, Complex32::ZERO); RUN];
        let mut count = 0;
        for (i, &q) in drive.iter().enumerate().filter(|(_, q)| **q != Complex32::ZERO) {
            driven[count] = (run * RUN + i, q);
            count += 1;
        }
        let [x, y, z] = points.coordinates.map(groups);
        let sums = groups_mut(re).iter_mut().zip(groups_mut(im));
        for (((x, y), z), (re, im)) in x.iter().zip(y).zip(z).zip(sums) {
            control.pulse()?;
            let place = [s.load(x), s.load(y), s.load(z)];
            let mut sum = [s.load(re), s.load(im)];
            for (i, q) in &driven[..count] {
                let g = element(s, form, radiation, &sources.one(s, *i), place);
                sum = add_wave(s, g, [s.splat(q.re), s.splat(q.im)], sum);
            }
            s.store(sum[0], re);
            s.store(sum[1], im);
        }
    }
    silence(s, re, points.count);
    silence(s, im, points.count);
    Ok(())
}

/// Does the same as [`add_field`] for the points of up to 16 problems, one problem in each lane, with the same bits.
/// `drive` has two lane groups for each transducer: the real and the imaginary parts.
pub(crate) fn interleaved_field(
    set: InstructionSet,
    radiation: &Radiation,
    sources: &SourceList,
    drive: &[f32],
    points: ControlPoints<'_>,
    field: [&mut [f32]; 2],
) {
    dispatch!(set, s => formed!(s, radiation, sources.in_phase, form => {
        s.apart(LANES, &mut InterleavedSum { form, radiation, sources, drive, points, field });
    }));
}

/// Kernel of [`interleaved_field`].
struct InterleavedSum<'a, F> {
    form: F,
    radiation: &'a Radiation,
    sources: &'a SourceList,
    drive: &'a [f32],
    points: ControlPoints<'a>,
    field: [&'a mut [f32]; 2],
}

impl<F: Form> Apart for InterleavedSum<'_, F> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let Self { form, radiation, sources, drive, points, field: [re, im] } = self;
        let drives = groups(drive).as_chunks::<2>().0;
        // The drives of a run, 8 KB, stay in the nearest cache.
        for first in (0..sources.len()).step_by(SHORT_RUN) {
            let run = first..sources.len().min(first + SHORT_RUN);
            let [x, y, z] = points.coordinates.map(groups);
            for (((x, y), z), (re, im)) in x.iter().zip(y).zip(z).zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
                let place = [s.load(x), s.load(y), s.load(z)];
                let mut sum = [s.load(re), s.load(im)];
                for (i, [qr, qi]) in run.clone().zip(&drives[run.clone()]) {
                    let g = element(s, *form, radiation, &sources.one(s, i), place);
                    sum = add_wave(s, g, [s.load(qr), s.load(qi)], sum);
                }
                s.store(sum[0], re);
                s.store(sum[1], im);
            }
        }
    }
}
