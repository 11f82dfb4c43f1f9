//! OpenMPD: for each board 256 bytes of phases, then 256 bytes of pulse widths, in the order of the pins.

use crate::device::boards::planes;
use crate::device::format::{Format, Layout, Levels, Link, Steps, thrice};

const CHANNELS: usize = 256;
/// This bit is set in the first byte of each board's frame.
const BEGIN: u8 = 0x80;

pub(crate) const FORMAT: Format = Format {
    name: "openmpd",
    summary: "OpenMPD boards (AsierInho v2), each on a FIFO of its own",
    source: "OpenMPD FPGA 3.4.2: bytes of a frame, MuxPhase; its driver's pin map, as in the published board files",
    channels: CHANNELS,
    most_boards: 2,
    steps: Steps { phases: 128, levels: Levels::Pulses(&[1; 128]) },
    // The board emits 40 kHz with its initial clock divider, 4.
    link: Link::Fifo { rate: 10e3, one_chip: false },
    frequency: 40e3,
    steady: f64::INFINITY,
    layout: Layout::Preset("openmpd_board"),
    order,
    late: |_| (0, 0.0),
    size: |boards| 2 * CHANNELS * boards,
    encode: |boards, code, frame| planes::write::<CHANNELS>(boards, BEGIN, code, frame),
    decode: |boards, frame, put| planes::read::<CHANNELS>(boards, [BEGIN, 64], frame, put),
    silence: thrice,
};

/// The pin of a transducer. Transducers are numbered with y fastest, from + to -, pins in squares of four columns, two rows at
/// a time.
fn order(transducer: usize) -> usize {
    const PAIR: [[usize; 4]; 2] = [[1, 0, 3, 2], [5, 4, 6, 7]];
    let [x, y] = [transducer / 16, transducer % 16];
    64 * (3 - x / 4) + 8 * (7 - y / 2) + PAIR[y % 2][x % 4]
}
