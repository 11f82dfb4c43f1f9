//! Origin of an array: a grid, a preset or positions.

/// The origin of an array, so that a scene file can state it in short form.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// Positions and normals one by one.
    Positions,
    /// [`crate::Array::grid`].
    Grid {
        /// Transducers along x.
        nx: usize,
        /// Transducers along y.
        ny: usize,
        /// Their distance in m.
        pitch: f64,
    },
    /// [`crate::Array::preset`].
    Preset {
        /// Name of the preset.
        name: &'static str,
        /// Boards along x and y.
        tiles: [usize; 2],
    },
}
