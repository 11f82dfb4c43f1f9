//! Lane groups: padded slices, sixteen f32 at a time.

/// Numbers worked on at once: one AVX-512 register, four of SSE2, NEON or wasm.
pub(crate) const LANES: usize = 16;

/// One lane group.
pub(crate) type Lanes = [f32; LANES];

/// One that begins on a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Line(pub(crate) Lanes);

/// Rows of tiles that lie together.
pub(crate) const BLOCK: usize = 4;

/// Four rows of a tile.
pub(crate) type Block = [Lanes; BLOCK];

/// A lane group of each of eight rows, re and im.
pub(crate) type Octet = [[Lanes; 2]; 8];

/// The least multiple of [`LANES`] that holds `count`.
pub(crate) const fn padded(count: usize) -> usize {
    count.next_multiple_of(LANES)
}

/// The lane groups of a padded slice.
#[inline(always)]
pub(crate) fn groups(slice: &[f32]) -> &[Lanes] {
    let (groups, rest) = slice.as_chunks();
    debug_assert!(rest.is_empty(), "kernel slices are padded to 16");
    groups
}

/// The lane groups of a padded slice, to write.
#[inline(always)]
pub(crate) fn groups_mut(slice: &mut [f32]) -> &mut [Lanes] {
    let (groups, rest) = slice.as_chunks_mut();
    debug_assert!(rest.is_empty(), "kernel slices are padded to 16");
    groups
}
