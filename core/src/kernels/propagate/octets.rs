//! Up to eight rows of G side by side: lane group by lane group, as a block of transducers reads them.
//!
//! The rows are written by a function that is not inlined, and the form is chosen before its loops. So the kernel that
//! calls it keeps its values in registers. Padding is not set to 0.

use crate::kernels::prelude::*;
use crate::kernels::propagate::row::{ControlPoints, element, known, silence};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::propagate::source::{Form, Radiation, SourceList, formed};

/// Writes the rows of `members` from column `first` on.
#[inline(always)]
pub(crate) fn write_rows<S: Simd>(s: S, rows: Rows<'_>, members: &[usize], first: usize, out: &mut [Octet]) {
    match rows {
        Rows::Computed { sources, control_points, amplitudes, .. } if !amplitudes.is_empty() => s.vectorize(
            #[inline(always)]
            || s.apart(control_points.count, &mut Known { sources, control_points, amplitudes, members, first, out }),
        ),
        Rows::Computed { radiation, sources, control_points, .. } => s.vectorize(
            #[inline(always)]
            || {
                formed!(s, radiation, sources.in_phase, form => {
                    let mut columns = Columns { form, radiation, sources, control_points, members, first, out };
                    s.apart(control_points.count, &mut columns);
                });
            },
        ),
        Rows::Stored { re, im } => {
            for (column, &i) in (first..).zip(members) {
                let row = groups(re)[i * out.len()..].iter().zip(&groups(im)[i * out.len()..]);
                row.zip(&mut *out).for_each(|((re, im), octet)| octet[column] = [*re, *im]);
            }
        }
    }
}

/// Kernel that computes the rows of `members` from column `first` on.
struct Columns<'a, F> {
    form: F,
    radiation: &'a Radiation,
    sources: &'a SourceList,
    control_points: ControlPoints<'a>,
    members: &'a [usize],
    first: usize,
    out: &'a mut [Octet],
}

impl<F: Form> Apart for Columns<'_, F> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let [x, y, z] = self.control_points.coordinates.map(groups);
        for (column, &i) in (self.first..).zip(self.members) {
            let from = &self.sources.one(s, i);
            for (((x, y), z), octet) in x.iter().zip(y).zip(z).zip(&mut *self.out) {
                let [re, im] = element(s, self.form, self.radiation, from, [s.load(x), s.load(y), s.load(z)]);
                s.store(re, &mut octet[column][0]);
                s.store(im, &mut octet[column][1]);
            }
        }
    }
}

/// Kernel that computes the rows of `members` where the amplitudes are known.
struct Known<'a> {
    sources: &'a SourceList,
    control_points: ControlPoints<'a>,
    amplitudes: &'a [Line],
    members: &'a [usize],
    first: usize,
    out: &'a mut [Octet],
}

impl Apart for Known<'_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let [x, y, z] = self.control_points.coordinates.map(groups);
        for (column, &i) in (self.first..).zip(self.members) {
            let from = &self.sources.one(s, i);
            let amplitudes = &self.amplitudes[i * x.len()..];
            for ((((x, y), z), amplitude), octet) in x.iter().zip(y).zip(z).zip(amplitudes).zip(&mut *self.out) {
                let [re, im] = known(s, from, [s.load(x), s.load(y), s.load(z)], s.load(&amplitude.0));
                s.store(re, &mut octet[column][0]);
                s.store(im, &mut octet[column][1]);
            }
        }
    }
}

/// Writes the rows of `members` over up to 16/N points. A column contains N members: member k in the lanes from 16 k/N on.
/// The coordinates are repeated in the same way. Lanes without a member contain 0.
#[inline(always)]
pub(crate) fn write_segments<S: Simd, const N: usize>(
    s: S,
    rows: Rows<'_>,
    members: &[usize],
    first: usize,
    out: &mut Octet,
) {
    match rows {
        Rows::Computed { radiation, sources, control_points, .. } => s.vectorize(
            #[inline(always)]
            || {
                let [x, y, z] = control_points.coordinates.map(|list| &groups(list)[0]);
                let place = [s.load(x), s.load(y), s.load(z)];
                formed!(s, radiation, sources.in_phase, form => for (column, some) in (first..).zip(members.chunks(N)) {
                    let from = &sources.segments::<_, N>(s, some);
                    let [re, im] = element(s, form, radiation, from, place);
                    let [to_re, to_im] = &mut out[column];
                    s.store(re, to_re);
                    s.store(im, to_im);
                    if some.len() < N {
                        silence(s, to_re, LANES / N * some.len());
                        silence(s, to_im, LANES / N * some.len());
                    }
                });
            },
        ),
        Rows::Stored { re, im } => {
            for (column, some) in (first..).zip(members.chunks(N)) {
                out[column] = [[0.0; LANES]; 2];
                for (all, out) in [re, im].into_iter().zip(&mut out[column]) {
                    for (segment, &i) in out.chunks_exact_mut(LANES / N).zip(some) {
                        segment.copy_from_slice(&groups(all)[i][..LANES / N]);
                    }
                }
            }
        }
    }
}
