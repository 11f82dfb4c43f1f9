//! Lane groups: padded slices, sixteen f32 at a time.

/// Numbers in a lane group: one AVX-512 register, four registers of SSE2, NEON or wasm.
pub(crate) const LANES: usize = 16;

/// A lane group: sixteen numbers that a kernel processes at once.
pub(crate) type Lanes = [f32; LANES];

/// A lane group that begins on a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Line(pub(crate) Lanes);

/// Number of rows of a tile that are stored together.
pub(crate) const BLOCK: usize = 4;

/// Lane groups of four rows of a tile.
pub(crate) type Block = [Lanes; BLOCK];

/// One lane group of each of eight rows, real and imaginary parts.
pub(crate) type Octet = [[Lanes; 2]; 8];

/// Returns the least multiple of [`LANES`] that is at least `count`.
pub(crate) const fn padded(count: usize) -> usize {
    count.next_multiple_of(LANES)
}

/// Returns the lane groups of a padded slice.
#[inline(always)]
pub(crate) fn groups(slice: &[f32]) -> &[Lanes] {
    let (groups, rest) = slice.as_chunks();
    debug_assert!(rest.is_empty(), "kernel slices are padded to 16");
    groups
}

/// Returns the lane groups of a padded slice, for writing.
#[inline(always)]
pub(crate) fn groups_mut(slice: &mut [f32]) -> &mut [Lanes] {
    let (groups, rest) = slice.as_chunks_mut();
    debug_assert!(rest.is_empty(), "kernel slices are padded to 16");
    groups
}
