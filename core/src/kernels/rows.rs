//! Where a kernel that passes over all transducers takes its rows from.

use super::row::{Law, Source, Spots, write_row, write_tile};
use super::simd::Simd;
use super::{LANES, Lanes};

/// Rows of G, one a transducer, each a whole number of lane groups long.
#[derive(Clone, Copy)]
pub(crate) enum Rows<'a> {
    /// Made from positions when asked for.
    Computed { law: &'a Law, sources: &'a [Source], spots: Spots<'a> },
    /// Kept: re and im, row after row.
    Stored { re: &'a [f32], im: &'a [f32] },
}

impl Rows<'_> {
    /// Writes row `i` over the whole of `re` and `im`.
    #[inline(always)]
    pub(crate) fn write<S: Simd>(&self, s: S, i: usize, re: &mut [f32], im: &mut [f32]) {
        match *self {
            Self::Computed { law, sources, spots } => write_row(s, law, &sources[i], spots, re, im),
            Self::Stored { re: all_re, im: all_im } => {
                let range = i * re.len()..(i + 1) * re.len();
                re.copy_from_slice(&all_re[range.clone()]);
                im.copy_from_slice(&all_im[range]);
            }
        }
    }

    /// Writes a tile: the transducers from `first` on, at most 16, in the lanes, a row each of the `points` (their index
    /// in a row, and a factor); zeros in the lanes of those beyond the last of `count`.
    #[inline(always)]
    pub(crate) fn write_tile<S: Simd>(
        &self,
        s: S,
        (first, count): (usize, usize),
        points: (&[u32], &[f32]),
        out: [&mut [Lanes]; 2],
    ) {
        let members = first..count.min(first + LANES);
        match *self {
            Self::Computed { law, sources, spots } => {
                write_tile(s, law, &sources[members], spots, points, out);
            }
            Self::Stored { re, im } => {
                let lanes = re.len() / count;
                for (all, tile) in [re, im].into_iter().zip(out) {
                    for ((to, &j), &scale) in tile.iter_mut().zip(points.0).zip(points.1) {
                        *to = [0.0; LANES];
                        for (to, i) in to.iter_mut().zip(members.clone()) {
                            *to = all[i * lanes + j as usize] * scale;
                        }
                    }
                }
            }
        }
    }
}
