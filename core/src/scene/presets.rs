//! Presets: real boards and the paper's arrays, as data with their source.

use alloc::vec::Vec;

use crate::device::quantization::Quantization;
use crate::error;
use crate::error::Error;
use crate::math;
use crate::scene::geometry::lattice;
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
    /// Where the transducers face from their positions, unless all face +z.
    pub(crate) normal: Option<fn([f64; 3]) -> [f64; 3]>,
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
pub const PRESETS: [Preset; 5] = [
    Preset {
        name: "paper20",
        summary: "20 x 20 at 10 mm, the paper's figures 3 to 5",
        source: SUZUKI,
        count: 400,
        tiles: false,
        transducer: PAPER,
        grid: None,
        positions: |_| lattice([20, 20], 10e-3),
        normal: None,
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
        normal: None,
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
        normal: None,
    },
    Preset {
        name: "openmpd_pair",
        summary: "two OpenMPD boards of 256 transducers, face to face 236.5 mm apart around the origin",
        source: "OpenMPD board file (16 x 16 at 10.5 mm, x slow, y from + to -) and AcousTools 1.2, Boards.py (gap, P0, piston)",
        count: 512,
        tiles: false,
        transducer: Transducer { source_pressure: 3.4, directivity: Directivity::Piston(4.5e-3) },
        grid: Some([128, 64]),
        positions: |_| openmpd_pair(),
        normal: Some(|[_, _, z]| [0.0, 0.0, -z.signum()]),
    },
    Preset {
        name: "tinylev",
        summary: "TinyLev: two caps of 36 transducers around the origin, on a sphere of 120 mm",
        source: "Marzo, Barnes, Drinkwater, Rev. Sci. Instrum. 88, 085105, 2017; rings, P0 and sinc of Ultraino's TinyLev file",
        count: 72,
        tiles: false,
        transducer: Transducer { source_pressure: 2.53, directivity: Directivity::Sinc(9e-3) },
        grid: None,
        positions: |_| tinylev(),
        normal: Some(|place| place.map(|x| -x)),
    },
];

/// The preset of that name.
///
/// # Errors
/// An unknown name; the error lists the known ones.
pub fn find(name: &str) -> Result<&'static Preset, Error> {
    error::find("preset", name, &PRESETS, |preset| preset.name)
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

/// The board below, then the one above.
fn openmpd_pair() -> Vec<[f64; 3]> {
    const SITES: usize = 16;
    const PITCH: f64 = 10.5e-3;
    const GAP: f64 = 236.5e-3;
    let place = |site: usize| (site as f64 - 0.5 * (SITES as f64 - 1.0)) * PITCH;
    let board = |z: f64| (0..SITES * SITES).map(move |i| [place(i / SITES), -place(i % SITES), z]);
    board(-0.5 * GAP).chain(board(0.5 * GAP)).collect()
}

/// The cap below, then the one above, each from its innermost ring outwards.
fn tinylev() -> Vec<[f64; 3]> {
    /// Transducers, radius and distance from the middle plane.
    const RINGS: [(u32, f64, f64); 3] = [(6, 10.3e-3, 59.11e-3), (12, 20.5e-3, 56.38e-3), (18, 30.0e-3, 51.96e-3)];
    let ring = |side: f64, (count, radius, height): (u32, f64, f64)| {
        (0..count).map(move |k| {
            let angle = core::f64::consts::TAU * f64::from(k) / f64::from(count);
            [radius * math::cos(angle), radius * math::sin(angle), side * height]
        })
    };
    [-1.0, 1.0].into_iter().flat_map(|side| RINGS.into_iter().flat_map(move |rings| ring(side, rings))).collect()
}
