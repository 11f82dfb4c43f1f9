//! Origin: how an array was made: as a grid, by a preset, or from positions.

/// How an array was made. A scene file can then state the array in short form.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// From a list of positions and normals.
    Positions,
    /// By [`crate::Array::grid`].
    Grid {
        /// Transducers along x.
        nx: usize,
        /// Transducers along y.
        ny: usize,
        /// The distance between neighbours in m.
        pitch: f64,
    },
    /// By [`crate::Array::preset`].
    Preset {
        /// Name of the preset.
        name: &'static str,
        /// Boards along x and y.
        tiles: [usize; 2],
    },
}
