//! Rows of G for a kernel, computed from positions or stored.

use core::ops::Range;

use crate::kernels::lanes::{BLOCK, Block};
use crate::kernels::lanes::{LANES, Line, padded};
use crate::kernels::propagate::form::Radiation;
use crate::kernels::propagate::row::{ControlPoints, write_known_row, write_row, write_tile};
use crate::kernels::propagate::source::SourceList;
use crate::kernels::simd::Simd;

/// Rows of G, one a transducer, each a whole number of lane groups long.
#[derive(Clone, Copy)]
pub(crate) enum Rows<'a> {
    /// Rows that are made from positions on request; `amplitudes` |c| D e^{-alpha r}/r where they are known, row
    /// after row, else none.
    Computed {
        radiation: &'a Radiation,
        sources: &'a SourceList,
        control_points: ControlPoints<'a>,
        amplitudes: &'a [Line],
    },
    /// Stored rows: re and im, row after row.
    Stored { re: &'a [f32], im: &'a [f32] },
}

impl Rows<'_> {
    /// Writes row `i` over the whole of `re` and `im`.
    #[inline(always)]
    pub(crate) fn write<S: Simd>(&self, s: S, i: usize, re: &mut [f32], im: &mut [f32]) {
        match *self {
            Self::Computed { sources, control_points, amplitudes, .. } if !amplitudes.is_empty() => {
                let wide = re.len() / LANES;
                let amplitudes = &amplitudes[i * wide..(i + 1) * wide];
                write_known_row(s, (sources, i), control_points, amplitudes, re, im);
            }
            Self::Computed { radiation, sources, control_points, .. } => {
                write_row(s, radiation, (sources, i), control_points, re, im);
            }
            Self::Stored { re: all_re, im: all_im } => {
                let range = i * re.len()..(i + 1) * re.len();
                re.copy_from_slice(&all_re[range.clone()]);
                im.copy_from_slice(&all_im[range]);
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
            Self::Computed { radiation, sources, control_points, .. } if !members.is_empty() => {
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
