//! OpenMPD: of each board 256 bytes of phases, then 256 of pulse widths, by pin.

use crate::device::code::{Code, Levels, Steps};
use crate::device::format::{Format, Line, Reader, thrice};
use crate::error::Error;

const CHANNELS: usize = 256;
/// Marks the first byte of a frame, which may not be missed.
const BEGIN: u8 = 0x80;
const PHASE: u8 = 0x7f;

pub(crate) const FORMAT: Format = Format {
    name: "openmpd",
    summary: "OpenMPD boards (AsierInho v2), each on a FIFO of its own",
    source: "OpenMPD FPGA 3.4.2: bytes of a frame, MuxPhase; its driver's pin map, as in the published board files",
    channels: CHANNELS,
    most_boards: 2,
    steps: Steps { phases: 128, levels: Levels::Widths },
    // 40 kHz by the divider it begins with, 4.
    line: Line::Frames(10e3),
    apart: true,
    order,
    size: |boards| 2 * CHANNELS * boards,
    encode,
    decode,
    silence: thrice,
};

/// Transducers with x slow and y downwards; pins in squares of four columns, two rows at a time.
fn order(transducer: usize) -> usize {
    const PAIR: [[usize; 4]; 2] = [[1, 0, 3, 2], [5, 4, 6, 7]];
    let [x, y] = [transducer / 16, transducer % 16];
    64 * (3 - x / 4) + 8 * (7 - y / 2) + PAIR[y % 2][x % 4]
}

fn encode(boards: usize, code: &dyn Fn(usize) -> Code, frame: &mut [u8]) {
    for (board, bytes) in frame.chunks_exact_mut(2 * CHANNELS).take(boards).enumerate() {
        for pin in 0..CHANNELS {
            let Code { phase, level } = code(board * CHANNELS + pin);
            bytes[pin] = phase as u8;
            bytes[CHANNELS + pin] = level as u8;
        }
        bytes[0] |= BEGIN;
    }
}

fn decode(boards: usize, frame: &[u8], put: &mut dyn FnMut(usize, Code)) -> Result<(), Error> {
    let mut bytes = Reader::new(frame);
    for board in 0..boards {
        let mut phases = [0; CHANNELS];
        phases[0] = bytes.byte(|byte| byte & BEGIN != 0, "128 or more where a board's frame begins")?;
        for phase in &mut phases[1..] {
            *phase = bytes.get()?;
        }
        for (pin, phase) in phases.into_iter().enumerate() {
            let level = bytes.byte(|byte| byte <= 64, "pulse widths of 0 to 64")?;
            put(board * CHANNELS + pin, Code { phase: (phase & PHASE).into(), level: level.into() });
        }
    }
    bytes.end()
}
