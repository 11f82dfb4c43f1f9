//! Where a kernel that passes over all transducers takes its rows from.

use super::row::{Law, Source, Spots, write_row};
use super::simd::Simd;

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
}
