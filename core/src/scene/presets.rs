//! Presets: the arrays of real boards and of Suzuki et al. 2021, as data with their source.

use crate::device::board;
use crate::device::quantization::Quantization;
use crate::error;
use crate::prelude::*;
use crate::scene::geometry::lattice;
use crate::scene::{Directivity, Transducer};

/// An array with a name.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// The name in `Array::preset` and in scene files.
    pub name: &'static str,
    /// A description in one line.
    pub summary: &'static str,
    /// The publication or file with these numbers.
    pub source: &'static str,
    /// The number of transducers of one board.
    pub count: usize,
    /// Whether boards can be tiled.
    pub tiles: bool,
    /// Source pressure and directivity of the transducers.
    pub transducer: Transducer,
    /// The kind of board that plays any drive of this array, if there is one. The array then has the quantization of this kind,
    /// and its transducers are in the order of [`Board::new`](crate::Board::new).
    pub board: Option<&'static str>,
    /// How many consecutive transducers share one channel.
    pub together: usize,
    pub(crate) positions: fn([usize; 2]) -> Vec<[f64; 3]>,
    /// The normal of a transducer at a position; `None` if all transducers face +z.
    pub(crate) normal: Option<fn([f64; 3]) -> [f64; 3]>,
}

impl Preset {
    /// The phases and amplitudes that its board can play; `None` if there is no board.
    pub(crate) fn quantization(&self) -> Result<Option<Quantization>> {
        self.board.map(|kind| board::format(kind)?.steps.quantization()).transpose()
    }

    /// The responses of `count` transducers that the board causes and cannot correct; `None` if all are 1.
    pub(crate) fn response(&self, count: usize) -> Result<Option<Vec<Complex64>>> {
        let Some(kind) = self.board else { return Ok(None) };
        let format = board::format(kind)?;
        Ok(format.response((0..count).map(|i| format.channel(i))))
    }

    /// The frequency in Hz of real hardware; `None` for the arrays of the paper, which are point sources.
    pub(crate) fn frequency(&self) -> Result<Option<f64>> {
        let frequency = self.board.map_or(Ok(40e3), |kind| Ok(board::format(kind)?.frequency))?;
        Ok((self.transducer != PAPER).then_some(frequency))
    }
}

/// The transducer of Suzuki et al. 2021: their eq. (5), with lengths in millimetres, has the source pressure P0 = 1e-3 Pa m.
const PAPER: Transducer = Transducer { source_pressure: 1e-3, directivity: Directivity::POINT };
/// The 10 mm transducer in Ultraino's files.
const ULTRAINO: Transducer = Transducer { source_pressure: 2.4, directivity: Directivity::sinc(9e-3) };
/// The Murata MA40S4S transducer, driven by 20 V.
const MURATA: Transducer = Transducer { source_pressure: 3.4, directivity: Directivity::piston(4.5e-3) };
const HANDYBEAM: Transducer = Transducer { source_pressure: 3.4, directivity: Directivity::cos(3.376) };
const OPENMPD: &str =
    "OpenMPD board file (16 x 16 at 10.5 mm, x slow, y from + to -) and AcousTools 1.2, Boards.py (gap, P0, piston)";
/// Boards above and below the origin face the plane z = 0.
const INWARDS: fn([f64; 3]) -> [f64; 3] = |[_, _, z]| [0.0, 0.0, -z.signum()];
const SUZUKI: &str = "Suzuki et al., IEEE Trans. Haptics 14(4), 2021, section IV";

/// What most presets have in common.
const PLAIN: Preset = Preset {
    name: "",
    summary: "",
    source: "",
    count: 0,
    tiles: false,
    transducer: PAPER,
    board: None,
    together: 1,
    positions: |_| Vec::new(),
    normal: None,
};

/// Every preset.
pub const PRESETS: [Preset; 13] = [
    Preset {
        name: "paper20",
        summary: "20 x 20 at 10 mm, the paper's figures 3 to 5",
        source: SUZUKI,
        count: 400,
        transducer: PAPER,
        positions: |_| lattice([20, 20], 10e-3),
        ..PLAIN
    },
    Preset {
        name: "paper36",
        summary: "36 x 36 at 10 mm, the paper's figures 2 and 7",
        source: SUZUKI,
        count: 1296,
        transducer: PAPER,
        positions: |_| lattice([36, 36], 10e-3),
        ..PLAIN
    },
    Preset {
        name: "autd3",
        summary: "AUTD3 boards of 249 transducers, tiles of 192.0 x 151.4 mm",
        source: "AUTD3 software, geometry of the device (18 x 14 at 10.16 mm, three sites missing), P0, lobe; its manual, pulse width encoder",
        count: 249,
        tiles: true,
        transducer: Transducer { source_pressure: 4.386, directivity: Directivity::T4010A1 },
        board: Some("autd3"),
        positions: autd3,
        ..PLAIN
    },
    Preset {
        name: "sonicsurface",
        summary: "SonicSurface, 16 x 16 at 10.5 mm",
        source: "SonicSurface, Python class (positions, centred as in Ultraino's file of the board); P0 and sinc of that file",
        count: 256,
        transducer: ULTRAINO,
        board: Some("sonicsurface"),
        positions: |_| lattice([16, 16], 10.5e-3),
        ..PLAIN
    },
    Preset {
        name: "sonicsurface_pair",
        summary: "two SonicSurfaces face to face 243 mm apart around the origin, the upper turned about y",
        source: "as sonicsurface; the gap: 3dprintzothar, SonicSurface build log",
        count: 512,
        transducer: ULTRAINO,
        board: Some("sonicsurface"),
        positions: |_| facing(&lattice([16, 16], 10.5e-3), 243e-3),
        normal: Some(INWARDS),
        ..PLAIN
    },
    Preset {
        name: "openmpd_board",
        summary: "OpenMPD board, 16 x 16 at 10.5 mm, x slow, y from + to -",
        source: OPENMPD,
        count: 256,
        transducer: MURATA,
        board: Some("openmpd"),
        positions: |_| openmpd(),
        ..PLAIN
    },
    Preset {
        name: "openmpd_pair",
        summary: "two OpenMPD boards face to face 236.5 mm apart around the origin, the upper turned about y",
        source: OPENMPD,
        count: 512,
        transducer: MURATA,
        board: Some("openmpd"),
        positions: |_| facing(&openmpd(), 236.5e-3),
        normal: Some(INWARDS),
        ..PLAIN
    },
    Preset {
        name: "tinylev",
        summary: "TinyLev: two caps of 36 transducers around the origin, on a sphere 120 mm across, each cap on one channel",
        source: "Marzo, Barnes, Drinkwater, Rev. Sci. Instrum. 88, 085105, 2017; rings, P0 and sinc of Ultraino's TinyLev file",
        count: 72,
        transducer: Transducer { source_pressure: 2.53, directivity: Directivity::sinc(9e-3) },
        together: 36,
        positions: |_| levitator([(6, 10.3e-3, 59.11e-3), (12, 20.5e-3, 56.38e-3), (18, 30.0e-3, 51.96e-3)]),
        normal: Some(|place| place.map(|x| -x)),
        ..PLAIN
    },
    Preset {
        name: "biglev",
        summary: "BigLev: two caps of 36 transducers of 16 mm around the origin, on a sphere 192 mm across",
        source: "Ultraino's BigLev file: rings and P0; sinc as wide as its transducers",
        count: 72,
        transducer: Transducer { source_pressure: 5.4, directivity: Directivity::sinc(16e-3) },
        positions: |_| levitator([(6, 16.4e-3, 94.58e-3), (12, 32.8e-3, 90.21e-3), (18, 48.0e-3, 83.14e-3)]),
        normal: Some(|place| place.map(|x| -x)),
        ..PLAIN
    },
    Preset {
        name: "ultraino_flat8x8",
        summary: "Ultraino's flat array, 8 x 8 at 10 mm",
        source: "Ultraino's file flat 8x8: order, P0 and sinc",
        count: 64,
        transducer: ULTRAINO,
        board: Some("mega64"),
        positions: |_| lattice([8, 8], 10e-3),
        ..PLAIN
    },
    Preset {
        name: "spherical_cap64",
        summary: "Ultraino's bowl of 64 transducers around a focus 55.5 mm above the origin",
        source: "Ultraino's file sphericalCap64: rings, order, P0 and sinc",
        count: 64,
        transducer: ULTRAINO,
        board: Some("mega64"),
        positions: |_| bowl(),
        normal: Some(|[x, y, z]| [-x, -y, BOWL_FOCUS - z]),
        ..PLAIN
    },
    Preset {
        name: "dragonfly",
        summary: "Ultrahaptics UHEV1 and Dragonfly, 16 x 16 at 10.47 mm; the device plays no drives of your own",
        source: "HandyBeam, tx_array_library (pitch) and its cos^3.376; P0 assumed, as of the Murata MA40S4S",
        count: 256,
        transducer: HANDYBEAM,
        positions: |_| lattice([16, 16], 10.47e-3),
        ..PLAIN
    },
    Preset {
        name: "stratos",
        summary: "Ultraleap STRATOS USX, 16 x 16 at 10.3 mm; the device plays no drives of your own",
        source: "HandyBeam, tx_array_library (pitch) and its cos^3.376; P0 assumed, as of the Murata MA40S4S",
        count: 256,
        transducer: HANDYBEAM,
        positions: |_| lattice([16, 16], 10.3e-3),
        ..PLAIN
    },
];

/// Returns the preset of this name.
///
/// # Errors
/// An unknown name; the error lists the known ones.
pub fn find(name: &str) -> Result<&'static Preset> {
    error::find("preset", name, &PRESETS, |preset| preset.name)
}

/// Returns the positions of AUTD3 boards in m: the boards in rows, and the transducers of each board in rows; x varies fastest.
/// The origin is the middle of all transducers.
fn autd3(tiles: [usize; 2]) -> Vec<[f64; 3]> {
    const SITES: [usize; 2] = [18, 14];
    const PITCH: f64 = 10.16e-3;
    const BOARD: [f64; 2] = [192.0e-3, 151.4e-3];
    /// Sites (x, y) without a transducer: screws and the connector are there.
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

/// Returns a board below z = 0 and the same board above it, turned about y to face the first. Each board keeps the
/// order of its transducers.
fn facing(board: &[[f64; 3]], gap: f64) -> Vec<[f64; 3]> {
    let below = board.iter().map(|&[x, y, _]| [x, y, -0.5 * gap]);
    below.chain(board.iter().map(|&[x, y, _]| [-x, y, 0.5 * gap])).collect()
}

/// The positions of one OpenMPD board, in its own order.
fn openmpd() -> Vec<[f64; 3]> {
    let grid = lattice([16, 16], 10.5e-3);
    (0..256).map(|i| [grid[i / 16][0], -grid[i % 16][0], 0.0]).collect()
}

/// A ring of transducers, counterclockwise. `first` is the angle of the first from +x, in rad.
fn ring(count: u32, radius: f64, height: f64, first: f64) -> impl Iterator<Item = [f64; 3]> {
    (0..count).map(move |k| {
        let angle = first + TAU * f64::from(k) / f64::from(count);
        [radius * math::cos(angle), radius * math::sin(angle), height]
    })
}

/// Returns the positions of two caps of rings, first the lower cap, then the upper one; each cap from its innermost ring
/// outwards. A ring is (count, radius, distance from the middle plane).
fn levitator(rings: [(u32, f64, f64); 3]) -> Vec<[f64; 3]> {
    let cap =
        |side: f64| rings.into_iter().flat_map(move |(count, radius, height)| ring(count, radius, side * height, 0.0));
    [-1.0, 1.0].into_iter().flat_map(cap).collect()
}

/// The height in m of the focus of Ultraino's bowl; the bowl's radius is 72.7 mm.
const BOWL_FOCUS: f64 = 55.5e-3;

/// Returns rings from the rim to the middle, in the order of Ultraino's file. Each ring begins at +y, the third half
/// a step later.
fn bowl() -> Vec<[f64; 3]> {
    const RINGS: [(u32, f64, f64, f64); 5] = [
        (28, 56.75e-3, 10.14e-3, 0.0),
        (14, 45.26e-3, -1.35e-3, 0.0),
        (14, 31.49e-3, -10.0e-3, 0.5),
        (7, 16.0e-3, -15.41e-3, 0.0),
        (1, 0.0, -17.19e-3, 0.0),
    ];
    let first = |count: u32, steps: f64| TAU * (0.25 + steps / f64::from(count));
    RINGS
        .into_iter()
        .flat_map(|(count, radius, height, steps)| ring(count, radius, height, first(count, steps)))
        .collect()
}
