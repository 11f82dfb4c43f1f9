//! Presets: real boards and the paper's arrays, as data with their source.

use alloc::vec::Vec;

use crate::device::quantization::Quantization;
use crate::error;
use crate::error::Error;
use crate::scene::transducer::{Directivity, Transducer};

/// An array known by name.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::exhaustive_structs, reason = "read by every door; built only here")]
pub struct Preset {
    /// Its name in `Array::preset` and in scene files.
    pub name: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// Where its numbers come from.
    pub source: &'static str,
    /// Transducers of one board.
    pub count: usize,
    /// Whether boards can be tiled.
    pub tiles: bool,
    /// Its transducers.
    pub transducer: Transducer,
    /// Phases and amplitudes (evenly spaced from 0 to 1) of its device, where it has such quantization.
    pub grid: Option<[u32; 2]>,
    pub(crate) positions: fn([usize; 2]) -> Vec<[f64; 3]>,
}

impl Preset {
    /// The quantization of its device.
    pub(crate) fn quantization(&self) -> Result<Option<Quantization>, Error> {
        self.grid.map(|[phases, amplitudes]| Quantization::evenly(phases, amplitudes)).transpose()
    }
}

/// P0 = 1e-3 Pa m is eq. (5) with lengths in millimetres.
const PAPER: Transducer = Transducer { source_pressure: 1e-3, directivity: Directivity::Point };
const SUZUKI: &str = "Suzuki et al., IEEE Trans. Haptics 14(4), 2021, section IV";

/// Every preset.
pub const PRESETS: [Preset; 3] = [
    Preset {
        name: "paper20",
        summary: "20 x 20 at 10 mm, the paper's figures 3 to 5",
        source: SUZUKI,
        count: 400,
        tiles: false,
        transducer: PAPER,
        grid: None,
        positions: |_| lattice([20, 20], 10e-3),
    },
    Preset {
        name: "paper36",
        summary: "36 x 36 at 10 mm, the paper's figures 2 and 7",
        source: SUZUKI,
        count: 1296,
        tiles: false,
        transducer: PAPER,
        grid: None,
        positions: |_| lattice([36, 36], 10e-3),
    },
    Preset {
        name: "autd3",
        summary: "AUTD3 boards of 249 transducers, tiles of 192.0 x 151.4 mm",
        source: "AUTD3 software, geometry of the device (18 x 14 at 10.16 mm, three sites missing); its manual, pulse width encoder",
        count: 249,
        tiles: true,
        transducer: Transducer { source_pressure: 4.386, directivity: Directivity::Point },
        // 8 bits each. The firmware's pulse widths make the sound pressure proportional to the intensity value.
        grid: Some([256, 256]),
        positions: autd3,
    },
];

/// The preset of that name.
///
/// # Errors
/// An unknown name; the error lists the known ones.
pub fn find(name: &str) -> Result<&'static Preset, Error> {
    error::find("preset", name, &PRESETS, |preset| preset.name)
}

/// `nx` x `ny` positions `pitch` metres apart, centred, x fastest.
pub(crate) fn lattice([nx, ny]: [usize; 2], pitch: f64) -> Vec<[f64; 3]> {
    let centred = |i: usize, n: usize| (i as f64 - (n as f64 - 1.0) / 2.0) * pitch;
    (0..nx * ny).map(|i| [centred(i % nx, nx), centred(i / nx, ny), 0.0]).collect()
}

/// Boards x fastest, transducers row-major on each, the middle of all lattices at the origin.
fn autd3(tiles: [usize; 2]) -> Vec<[f64; 3]> {
    const SITES: [usize; 2] = [18, 14];
    const PITCH: f64 = 10.16e-3;
    const BOARD: [f64; 2] = [192.0e-3, 151.4e-3];
    /// Sites (x, y) taken by screws and the connector.
    const MISSING: [[usize; 2]; 3] = [[1, 1], [2, 1], [16, 1]];
    let place = |axis: usize, tile: usize, site: usize| {
        let middle = (tiles[axis] as f64 - 1.0) * BOARD[axis] + (SITES[axis] as f64 - 1.0) * PITCH;
        tile as f64 * BOARD[axis] + site as f64 * PITCH - middle / 2.0
    };
    let mut positions = Vec::with_capacity(tiles[0] * tiles[1] * 249);
    for tile in 0..tiles[0] * tiles[1] {
        for site in (0..SITES[0] * SITES[1]).map(|i| [i % SITES[0], i / SITES[0]]) {
            if !MISSING.contains(&site) {
                positions.push([place(0, tile % tiles[0], site[0]), place(1, tile / tiles[0], site[1]), 0.0]);
            }
        }
    }
    positions
}
