//! Every loop worth vectorising, behind safe functions of slices.
//!
//! Numbers are f32, complex ones planar (re and im apart), slices padded to a multiple of [`LANES`]. Each loop
//! is written once over [`simd::Simd`], 16 lanes and a fixed order of sums, and compiled for every [`Level`].

pub(crate) mod abreast;
pub(crate) mod cholesky;
mod energies;
pub(crate) mod fast;
mod fine;
pub(crate) mod greedy;
pub(crate) mod greedy_abreast;
pub(crate) mod level;
mod matrix;
mod moments;
pub(crate) mod phases;
mod pressure;
pub(crate) mod products;
mod row;
mod rows;
mod search;
mod shortlist;
pub(crate) mod simd;
mod sixteen;
mod table;
#[cfg(test)]
mod tests;
pub(crate) mod tiles;
mod turn;
mod turns;

pub use level::Level;
pub(crate) use matrix::{add_waves, combine_rows, correlate_rows, gram, gram_floats};
pub(crate) use pressure::{accumulate, add_outer, correlate, dot, modulus, project, squares};
pub(crate) use row::{Law, Row, Source, Spots, add_moduli, row};
pub(crate) use rows::Rows;
pub(crate) use search::{Candidates, L1, L2, table};
pub(crate) use sixteen::Sixteen;
pub(crate) use table::Table;
pub(crate) use turn::{keep, turn};

/// Numbers worked on at once: one AVX-512 register, four of SSE2, NEON or wasm.
pub(crate) const LANES: usize = 16;

/// One group of lanes.
pub(crate) type Lanes = [f32; LANES];

/// The least multiple of [`LANES`] that holds `count`.
pub(crate) const fn padded(count: usize) -> usize {
    count.next_multiple_of(LANES)
}

/// The groups of lanes of a padded slice.
#[inline(always)]
fn groups(slice: &[f32]) -> &[Lanes] {
    let (groups, rest) = slice.as_chunks();
    debug_assert!(rest.is_empty(), "kernel slices are padded to 16");
    groups
}

/// The groups of lanes of a padded slice, to write.
#[inline(always)]
fn groups_mut(slice: &mut [f32]) -> &mut [Lanes] {
    let (groups, rest) = slice.as_chunks_mut();
    debug_assert!(rest.is_empty(), "kernel slices are padded to 16");
    groups
}
