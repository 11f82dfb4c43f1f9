//! Every loop worth vectorising, behind safe functions of slices.
//!
//! Numbers are f32, complex ones planar (re and im apart), slices padded to a multiple of [`LANES`]. Each loop
//! works on a fixed array of 16 lanes in a fixed order and never asks what the machine is, so the compiler
//! vectorises it for whatever it compiles for and the result has the same bits everywhere.

mod pressure;
mod row;
mod search;
#[cfg(test)]
mod tests;
mod turns;

pub(crate) use pressure::{accumulate, add_scaled, correlate, dot, modulus, project, squares};
pub(crate) use row::{Law, Row, Source, Spots, magnitudes, row};
pub(crate) use search::{Candidates, L1, L2, Points, Term, best, tolerance};

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
