//! Closed-form greedy sweep for instruction sets whose code must be short: four points at a time.
//!
//! The steps and their bits are those of [`crate::kernels::closed_form`]. In each kernel here no lane depends on
//! another, so that four points take a quarter of the time of sixteen. Sums over the lanes are taken between the
//! kernels.

use crate::kernels::closed_form::blocks::{MOST, Memory, QUAD, Sweep, own_power, residual, unit};
use crate::kernels::grid::Phases;
use crate::kernels::prelude::*;
use crate::kernels::propagate::octets::write_rows;

/// Runs [`crate::kernels::closed_form::sweep`] on an instruction set of narrow registers.
pub(super) fn sweep(
    set: InstructionSet,
    sweep: Sweep<'_>,
    order: impl Iterator<Item = usize>,
    drive: &mut [Complex32],
    pressures: [&mut [f32]; 2],
    report: impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
    dispatch!(set, s => s.is_short() && run(s, sweep, order, drive, pressures, report))
}

/// Runs the loop of the sweep; returns false if `report` ended it.
fn run<S: Simd>(
    s: S,
    sweep: Sweep<'_>,
    mut order: impl Iterator<Item = usize>,
    drive: &mut [Complex32],
    [re, im]: [&mut [f32]; 2],
    mut report: impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
    let Sweep { rows, target, weight, count, block, own, phases, memory } = sweep;
    let Memory { rows: buffer, residual: [rest_re, rest_im] } = memory;
    let octets = groups_mut(&mut buffer[..2 * MOST * target.len()]).as_chunks_mut().0.as_chunks_mut().0;
    let mut field = Field { requested: [target, weight], pressure: [re, im], residual: [rest_re, rest_im] };
    s.apart(count, &mut Added { field: &mut field, rows: octets, change: &[0.0; LANES], members: 0 });
    let (mut sums, mut goes_on) = ([[0.0; LANES]; LANES], true);
    while goes_on {
        let (mut members, mut some) = ([0; MOST], 0);
        while some < block
            && let Some(i) = order.next()
        {
            members[some] = i;
            some += 1;
        }
        let members = &members[..some];
        if members.is_empty() {
            break;
        }
        write_rows(s, rows, members, 0, octets);
        let mut old = [0.0; LANES];
        for (old, &i) in old.as_chunks_mut::<2>().0.iter_mut().zip(members) {
            *old = if own > 0.0 { [drive[i].re, drive[i].im] } else { [0.0; 2] };
        }
        s.apart(
            count,
            &mut Correlations { field: &field, rows: octets, own, old: &old, members: some, sums: &mut sums },
        );
        let new = directions(s, phases, s.sums(&sums, count));
        let mut change = [0.0; LANES];
        for ((change, new), old) in change.iter_mut().zip(&new).zip(&old).take(2 * some) {
            *change = new - old;
        }
        for (new, &i) in new.as_chunks::<2>().0.iter().zip(members) {
            drive[i] = Complex32::new(new[0], new[1]);
        }
        s.apart(count, &mut Added { field: &mut field, rows: octets, change: &change, members: some });
        goes_on = report([&field.pressure[0][..count], &field.pressure[1][..count]]);
    }
    // Removes the sums that the padding collected.
    field.pressure.into_iter().for_each(|part| part[count..].fill(0.0));
    goes_on
}

/// Values at the points: targets and weights, pressures P and residuals d.
struct Field<'a> {
    requested: [&'a [f32]; 2],
    pressure: [&'a mut [f32]; 2],
    residual: [&'a mut [f32]; 2],
}

/// Kernel of the sums z = `sum_j conj(G_j) d_j + own q sum_j w |G_j|^2` (see [`crate::kernels::closed_form`]) for a
/// block's transducers with old drives q. Each is a partial sum in the lanes; real and imaginary parts are side by
/// side.
struct Correlations<'a> {
    field: &'a Field<'a>,
    rows: &'a [Octet],
    own: f32,
    old: &'a Lanes,
    members: usize,
    sums: &'a mut [Lanes; LANES],
}

impl Apart for Correlations<'_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let [dr, di] = self.field.residual.each_ref().map(|list| groups(list));
        for k in 0..self.members {
            let (mut re, mut im) = (s.splat(0.0), s.splat(0.0));
            for (octet, (dr, di)) in self.rows.iter().zip(dr.iter().zip(di)) {
                let (gr, gi, dr, di) = (s.load(&octet[k][0]), s.load(&octet[k][1]), s.load(dr), s.load(di));
                re = s.fma(gr, dr, s.fma(gi, di, re));
                im = s.fma(gr, di, s.fnma(gi, dr, im));
            }
            if self.own > 0.0 {
                let power = own_power(s, self.rows, k, self.field.requested[1]);
                re = s.fma(power, s.splat(self.own * self.old[2 * k]), re);
                im = s.fma(power, s.splat(self.own * self.old[2 * k + 1]), im);
            }
            s.store(re, &mut self.sums[2 * k]);
            s.store(im, &mut self.sums[2 * k + 1]);
        }
    }
}

/// Kernel that adds the waves `sum_k G_k q_k` to the pressures for drives that change by q_k, and computes the
/// residuals.
struct Added<'a, 'b> {
    field: &'a mut Field<'b>,
    rows: &'a [Octet],
    change: &'a Lanes,
    members: usize,
}

impl Apart for Added<'_, '_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let Field { requested, pressure: [re, im], residual: [rest_re, rest_im] } = &mut *self.field;
        let pressures = groups_mut(re).iter_mut().zip(groups_mut(im));
        for (octet, (re, im)) in self.rows.iter().zip(pressures) {
            let mut real = [s.load(re), s.splat(0.0), s.splat(0.0), s.splat(0.0)];
            let mut imag = [s.load(im), s.splat(0.0), s.splat(0.0), s.splat(0.0)];
            for (c, (real, imag)) in real.iter_mut().zip(&mut imag).enumerate() {
                for k in (c..self.members).step_by(QUAD) {
                    let (qr, qi) = (s.splat(self.change[2 * k]), s.splat(self.change[2 * k + 1]));
                    let (gr, gi) = (s.load(&octet[k][0]), s.load(&octet[k][1]));
                    *real = s.fma(gr, qr, s.fnma(gi, qi, *real));
                    *imag = s.fma(gr, qi, s.fma(gi, qr, *imag));
                }
            }
            s.store(s.add(s.add(real[0], real[2]), s.add(real[1], real[3])), re);
            s.store(s.add(s.add(imag[0], imag[2]), s.add(imag[1], imag[3])), im);
        }
        residual(s, requested[0], requested[1], [re, im], [rest_re, rest_im]);
    }
}

/// Returns the new drives for eight sums z; real and imaginary parts are side by side.
fn directions<S: Simd>(s: S, phases: Option<&Phases>, z: S::V) -> Lanes {
    let mut all = Directions { phases, value: [0.0; LANES], other: [0.0; LANES] };
    s.store(z, &mut all.value);
    s.store(s.swap::<1>(z), &mut all.other);
    s.apart(LANES, &mut all);
    all.value
}

/// Kernel of new drives for sums z: `value` has the real or the imaginary part of each z, `other` the other part.
struct Directions<'a> {
    phases: Option<&'a Phases>,
    value: Lanes,
    other: Lanes,
}

/// 1 in the lanes of imaginary parts.
const ODD: Lanes = [0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0];

impl Apart for Directions<'_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let (value, other) = (s.load(&self.value), s.load(&self.other));
        let new = match self.phases {
            Some(phases) => {
                let (zero, odd) = (s.splat(0.0), s.load(&ODD));
                let z = [s.select_less(zero, odd, other, value), s.select_less(zero, odd, value, other)];
                let [re, im] = phases.nearest(s, z);
                s.select_less(zero, odd, im, re)
            }
            None => unit(s, [value, other])[0],
        };
        s.store(new, &mut self.value);
    }
}
