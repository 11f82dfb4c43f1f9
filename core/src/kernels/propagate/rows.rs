//! Rows of G for a kernel, computed from positions or stored.

use core::ops::Range;

use crate::kernels::lanes::{BLOCK, Block};
use crate::kernels::lanes::{LANES, Lanes, groups, padded};
use crate::kernels::propagate::form::Radiation;
use crate::kernels::propagate::row::{ControlPoints, write_row, write_segments, write_tile};
use crate::kernels::propagate::source::SourceList;
use crate::kernels::simd::Simd;

/// Rows of G, one a transducer, each a whole number of lane groups long.
#[derive(Clone, Copy)]
pub(crate) enum Rows<'a> {
    /// Made from positions when asked for.
    Computed { radiation: &'a Radiation, sources: &'a SourceList, control_points: ControlPoints<'a> },
    /// Kept: re and im, row after row.
    Stored { re: &'a [f32], im: &'a [f32] },
}

impl Rows<'_> {
    /// Writes row `i`, lane group after lane group.
    #[inline(always)]
    pub(crate) fn write<'o, S: Simd>(&self, s: S, i: usize, out: impl ExactSizeIterator<Item = [&'o mut Lanes; 2]>) {
        match *self {
            Self::Computed { radiation, sources, control_points } => {
                write_row(s, radiation, (sources, i), control_points, out);
            }
            Self::Stored { re, im } => {
                let first = i * out.len();
                let row = groups(re)[first..].iter().zip(&groups(im)[first..]);
                row.zip(out).for_each(|((re, im), out)| [*out[0], *out[1]] = [*re, *im]);
            }
        }
    }

    /// Writes the rows of `members`, at most N, over up to 16/N points side by side, zeros for members that there are not:
    /// see [`write_segments`]. Computed ones have coordinates that are repeated likewise.
    #[inline(always)]
    pub(crate) fn write_segments<S: Simd, const N: usize>(&self, s: S, members: &[usize], out: [&mut Lanes; 2]) {
        match *self {
            Self::Computed { radiation, sources, control_points } => {
                let coordinates = control_points.coordinates.map(|list| &groups(list)[0]);
                write_segments::<_, N>(s, radiation, (sources, members), coordinates, out);
            }
            Self::Stored { re, im } => {
                for (all, out) in [re, im].into_iter().zip(out) {
                    *out = [0.0; LANES];
                    for (segment, &i) in out.chunks_exact_mut(LANES / N).zip(members) {
                        segment.copy_from_slice(&groups(all)[i][..LANES / N]);
                    }
                }
            }
        }
    }

    /// Writes a tile of [`crate::kernels::tiles`]: 16 transducers in the lanes, the first a multiple of 16 and fewer only
    /// where there are no more; row after row all the points in their `order`, zeros in the lanes of transducers that there
    /// are not.
    #[inline(always)]
    pub(crate) fn write_tile<S: Simd>(
        &self,
        s: S,
        (tile, stride): (usize, usize),
        members: Range<usize>,
        order: &[u32],
        out: [&mut [Block]; 2],
    ) {
        match *self {
            Self::Computed { radiation, sources, control_points } if !members.is_empty() => {
                debug_assert!(
                    members.start.is_multiple_of(LANES) && members.len() == LANES.min(sources.len() - members.start)
                );
                let group = (sources, members.start / LANES);
                write_tile(s, radiation, group, control_points, order, (tile, stride), out);
            }
            Self::Stored { re, im } => {
                let lanes = padded(order.len());
                for (all, out) in [re, im].into_iter().zip(out) {
                    for (k, &j) in order.iter().enumerate() {
                        let to = &mut out[tile + k / BLOCK * stride][k % BLOCK];
                        *to = [0.0; LANES];
                        for (to, i) in to.iter_mut().zip(members.clone()) {
                            *to = all[i * lanes + j as usize];
                        }
                    }
                }
            }
            Self::Computed { .. } => {
                for out in out {
                    (0..order.len()).for_each(|k| out[tile + k / BLOCK * stride][k % BLOCK] = [0.0; LANES]);
                }
            }
        }
    }
}
