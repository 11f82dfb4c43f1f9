# Trials of docs/extending.md: adds a key of the medium, a board and an obstacle to the copy that extending.sh makes, and
# counts the files that a contributor edits. `make` writes the others: docs/map.md, schemas, stubs, golden bytes.

# A key of the medium: the coefficient of nonlinearity. The second harmonic is proportional to it.
after 'pub struct Medium of "medium" {' core/src/scene/medium.rs <<'RUST'
        /// Coefficient of nonlinearity beta, of the second harmonic; default 1.2, that of air.
        nonlinearity = 1.2, above 0.0, such as 1.2;
RUST
swap '        const BETA: f64 = 1.2;' '        // 3 pi beta |p|/(2 rho c^2).' core/src/scene/medium.rs
swap '* BETA *' '* self.nonlinearity *' core/src/scene/medium.rs
after '| $`\rho`$ | `density`' docs/conventions.md <<<'| $`\beta`$ | `nonlinearity` of the air, of the second harmonic | - | 1.2 |'
append core/src/files/tests/write.rs <<'RUST'

#[test]
fn nonlinearity_is_read_used_and_written() {
    use crate::files::{Format, Provenance, read};

    let text = b"[medium]\nnonlinearity = 2.4\n[array]\npreset = \"paper20\"\n[[points]]\nposition = [0, 0, 0.1]\n";
    let scene = read(text, Format::Toml).expect("a scene");
    let air = crate::scene::Medium::default();
    assert_eq!(scene.medium().second_harmonic(1e3), 2.0 * air.second_harmonic(1e3));
    let written = crate::files::write(&scene, Format::Toml, &Provenance::default()).expect("text");
    assert!(written.contains("nonlinearity = 2.4"), "{written}");
}
RUST
noted nonlinearity
at_most 4 'a key of the medium'

# A board with eight channels and sixteen phases: a start byte, then one byte for each channel.
create core/src/device/boards/eight.rs <<'RUST'
//! Eight: a start byte, then a byte for each of eight channels.

use crate::device::format::{Code, Format, Layout, Levels, Link, Reader, Steps, Writer, twice};
use crate::error::Error;

const START: u8 = 254;
const OFF: u8 = 16;

pub(crate) const FORMAT: Format = Format {
    name: "eight",
    summary: "a board of eight channels over a serial line",
    source: "docs/extending.md",
    channels: 8,
    most_boards: 1,
    steps: Steps { phases: 16, levels: Levels::OnOff },
    link: Link::Serial { baud: 115_200, swap: None, restarts: false },
    frequency: 40e3,
    steady: f64::INFINITY,
    layout: Layout::Grid(4, 2, 10e-3),
    order: |transducer| transducer,
    late: |_| (0, 0.0),
    size: |_| 9,
    encode,
    decode,
    silence: twice,
};

fn encode(_: usize, code: &dyn Fn(usize) -> Code, frame: &mut [u8]) {
    let mut bytes = Writer::new(frame);
    bytes.put(START);
    for channel in 0..8 {
        let Code { phase, level } = code(channel);
        bytes.put(if level == 0 { OFF } else { phase as u8 });
    }
}

fn decode(_: usize, frame: &[u8], put: &mut dyn FnMut(usize, Code)) -> Result<(), Error> {
    let mut bytes = Reader::new(frame);
    bytes.byte(|byte| byte == START, "254 before the phases")?;
    for channel in 0..8 {
        let phase = bytes.byte(|byte| byte <= OFF, "phases of 0 to 15, or 16 for off")?;
        put(channel, if phase == OFF { Code::default() } else { Code { phase: phase.into(), level: 1 } });
    }
    bytes.end()
}
RUST
after 'mod autd3;' core/src/device/boards/mod.rs <<<'mod eight;'
swap '[Format; 7]' '[Format; 8]' core/src/device/boards/mod.rs
after '    homies::FORMAT,' core/src/device/boards/mod.rs <<<'    eight::FORMAT,'
swap '(&str, usize); 11]' '(&str, usize); 12]' core/tests/suite/boards.rs
after '("homies", 256),' core/tests/suite/boards.rs <<<'    ("eight", 8),'
after '("homies", grid(16, 16, 10.5e-3)),' core/tests/suite/boards.rs <<<'            ("eight", grid(4, 2, 10e-3)),'
swap 'class SonicSurface:' 'class Eight:
    """A board of eight: a start byte, then the phase of each channel, 16 for off."""

    def __init__(self) -> None:
        self.phases = [16] * 8
        self.next = 8

    def receive(self, data: bytes) -> None:
        for byte in data:
            if byte == 254:
                self.next = 0
            elif self.next < 8:
                self.phases[self.next] = byte
                self.next += 1

    @property
    def drive(self) -> Complex:
        phases = np.array(self.phases)
        return (phases < 16) * np.exp(2j * np.pi * phases / 16)


class SonicSurface:' python/tests/firmware.py
after '    "nano": Kind(lambda _: [Arduino(24, 1)]' python/tests/firmware.py <<'PYTHON'
    "eight": Kind(lambda _: [Eight()], lambda _: 9, lambda _, frame: frame == b"\xfe" + bytes([16] * 8)),
PYTHON
after '# Boards' docs/boards.md <<<'The board `eight` is a trial.'
noted eight
at_most 7 'a board'

# An obstacle: a soft ball, small beside the wavelength, which scatters a spherical wave.
swap '        ---' '        /// A soft ball that is small beside the wavelength.
        Bubble = "bubble" {
            /// its middle, x, y, z in m.
            middle: [f64; 3], such as "[0.0, 0.0, 0.1]";
            /// its radius in m.
            size: f64, such as "0.0001";
        }
        ---' core/src/scene/obstacle.rs
swap '                Obstacle::Mesh(mesh) => check_mesh' '                Obstacle::Bubble { middle, size, .. } => check_sphere(&item, *middle, *size, array, medium)?,
                Obstacle::Mesh(mesh) => check_mesh' core/src/scene/obstacle.rs
after '                Obstacle::Wall { .. } => false,' core/src/scene/obstacle.rs <<'RUST'
                Obstacle::Bubble { middle, size, .. } => distance(*middle, place) < size - ON,
RUST
create core/src/propagation/scattering/bubble.rs <<'RUST'
//! Bubble: the wave that a small soft ball scatters, -a p e^{jkr}/r, for the pressure p at its middle.

use num_complex::Complex64;

use crate::math;
use crate::propagation::sources::Sources;
use crate::scene::{Obstacle, Obstacles, distance};

/// Adds the pressure that each transducer gives at a point by way of the bubbles, in Pa.
pub(crate) fn add(obstacles: &Obstacles, sources: &Sources, point: [f64; 3], row: &mut [Complex64]) {
    for obstacle in obstacles.list() {
        let Obstacle::Bubble { middle, size, .. } = obstacle else { continue };
        let (r, k) = (distance(*middle, point), sources.medium.complex_wavenumber());
        let wave = Complex64::new(math::cos(k.re * r), math::sin(k.re * r)) * (-size / r * math::exp(-k.im * r));
        row.iter_mut().enumerate().for_each(|(i, g)| *g += wave * sources.exact(i, *middle));
    }
}

#[cfg(test)]
#[path = "tests/bubble.rs"]
mod tests;
RUST
create core/src/propagation/scattering/tests/bubble.rs <<'RUST'
//! Compares a bubble with the series of a soft sphere.

use crate::control::Control;
use crate::kernels::InstructionSet;
use crate::propagation::Model;
use crate::scene::{Array, Medium, Obstacle, Surface};

#[test]
fn a_bubble_is_a_small_soft_sphere() {
    let (center, radius, kind) = ([0.0, 0.0, 0.05], 20e-6, Surface::Soft);
    let array = Array::grid(3, 2, 10e-3).expect("a grid");
    let row = |obstacles: &[Obstacle]| {
        let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("a model");
        let model = model.with_obstacles(obstacles).expect("obstacles");
        model.propagation(&[[0.0, 1e-3, 0.051]]).expect("G").matrix(&mut Control::none()).expect("numbers")
    };
    let free = row(&[]);
    let [bubble, sphere] = [
        row(&[Obstacle::Bubble { middle: center, size: radius, kind }]),
        row(&[Obstacle::Sphere { center, radius, kind }]),
    ];
    for ((free, bubble), sphere) in free.iter().zip(&bubble).zip(&sphere) {
        assert!((sphere - free).norm() > 1e-3 * free.norm());
        assert!((bubble - sphere).norm() < 0.05 * (sphere - free).norm(), "{free} {bubble} {sphere}");
    }
}
RUST
after 'pub(crate) mod boundary;' core/src/propagation/scattering/mod.rs <<<'pub(crate) mod bubble;'
swap '        for image in &*self.images {' '        for (&point, row) in points.iter().zip(&mut *rows) {
            bubble::add(&self.obstacles, sources, point, row);
        }
        for image in &*self.images {' core/src/propagation/scattering/mod.rs
swap '        radius: f64,' '        radius: f64,
    }
    /// A soft ball that is small beside the wavelength.
    Bubble {
        /// Its middle (x, y, z) in m.
        middle: (f64, f64, f64),
        /// Its radius in m.
        size: f64,' python/src/bodies.rs
after '        Bead as Bead,' python/midair/__init__.py <<<'        Bubble as Bubble,'
swap '#: The function that draws each kind of obstacle' 'def _bubble(bubble: Bubble, plane: Plane, ax: Axes, axes: tuple[int, int]) -> None:
    ax.plot(1e3 * bubble.middle[axes[0]], 1e3 * bubble.middle[axes[1]], ".", color=COLOUR)


#: The function that draws each kind of obstacle' python/midair/_pictures/panel.py
swap 'Sphere: _sphere,' 'Sphere: _sphere, Bubble: _bubble,' python/midair/_pictures/panel.py
swap 'import Field,' 'import Bubble, Field,' python/midair/_pictures/panel.py
after '- `Sphere(center, radius' docs/obstacles.md <<<'- `Bubble(middle, size, kind="soft")` is a ball small beside the wavelength.'
append python/tests/test_obstacles.py <<'PYTHON'


def test_a_bubble_is_kept() -> None:
    bubble = midair.Bubble([0, 0, 0.1], 1e-4, "soft")
    scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]], obstacles=[bubble])
    assert midair.Scene.parse(scene.json()).obstacles == [bubble]
PYTHON
noted bubble
at_most 11 'an obstacle'
