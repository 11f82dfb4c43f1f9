//! Rows of G for a kernel, computed from positions or stored.

use core::ops::Range;

use crate::kernels::lanes::Block;
use crate::kernels::prelude::*;
use crate::kernels::propagate::row::{ControlPoints, write_known_row, write_row, write_tile};
use crate::kernels::propagate::source::{Radiation, SourceList};

/// Rows of the propagation matrix G, one for each transducer; a row is a whole number of lane groups.
#[derive(Clone, Copy)]
pub(crate) enum Rows<'a> {
    /// Rows that are computed from positions when they are needed. `amplitudes` are the amplitudes |c| D e^{-alpha r}/r
    /// of eq. (5), row after row, or empty if they are not known.
    Computed {
        radiation: &'a Radiation,
        sources: &'a SourceList,
        control_points: ControlPoints<'a>,
        amplitudes: &'a [Line],
    },
    /// Stored rows, one after another: real and imaginary parts.
    Stored { re: &'a [f32], im: &'a [f32] },
}

impl Rows<'_> {
    /// Writes row `i` to the whole of `re` and `im`.
    #[inline(always)]
    pub(crate) fn write<S: Simd>(&self, s: S, i: usize, re: &mut [f32], im: &mut [f32]) {
        match *self {
            Self::Computed { sources, control_points, amplitudes, .. } if !amplitudes.is_empty() => {
                let wide = re.len() / LANES;
                let amplitudes = &amplitudes[i * wide..(i + 1) * wide];
                write_known_row(s, sources, i, control_points, amplitudes, re, im);
            }
            Self::Computed { radiation, sources, control_points, .. } => {
                write_row(s, radiation, sources, i, control_points, re, im);
            }
            Self::Stored { re: all_re, im: all_im } => {
                let range = i * re.len()..(i + 1) * re.len();
                re.copy_from_slice(&all_re[range.clone()]);
                im.copy_from_slice(&all_im[range]);
            }
        }
    }

    /// Writes a tile of [`crate::kernels::tiles`], with 16 transducers in the lanes. The first of `members` is a
    /// multiple of 16; there are fewer than 16 only at the end of the array. Each point has a row, in the order of
    /// `order`. Lanes without a transducer get 0.
    #[inline(always)]
    pub(crate) fn write_tile<S: Simd>(
        &self,
        s: S,
        tile: usize,
        stride: usize,
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
