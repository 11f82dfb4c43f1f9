//! SonicSurface: the codes of 256 channels between a start and a swap byte.
//!
//! Two boards are selected one after the other, and both swap at the same time.

use crate::device::format::{Code, Format, Layout, Levels, Link, Reader, Steps, Writer};
use crate::prelude::*;

const CHANNELS: usize = 256;
/// The phase code that switches a channel off.
const OFF: u8 = 32;
/// Selects the primary board for the following bytes. SELECT + 1 selects the secondary board.
const SELECT: u8 = 192;
const START: u8 = 254;
/// Exchanges the two banks of every board.
const SWAP: u8 = 253;
/// Starts the shift clocks; a byte of 150, received by mistake, stops them.
const CLOCKS: u8 = 151;

pub(crate) const FORMAT: Format = Format {
    name: "sonicsurface",
    summary: "SonicSurface boards over a serial line, one or two",
    source: "SonicSurface firmware, Distribute.vhd and PhaseLine.vhd; order of the channels: its Python class",
    channels: CHANNELS,
    most_boards: 2,
    steps: Steps { phases: 32, levels: Levels::OnOff },
    link: Link::Serial { baud: 230_400, swap: Some(SWAP), restarts: false },
    frequency: 40e3,
    steady: f64::INFINITY,
    layout: Layout::Preset("sonicsurface"),
    order,
    late,
    size: |boards| if boards == 1 { CHANNELS + 2 } else { (CHANNELS + 2) * boards + 1 },
    encode,
    decode,
    silence,
};

/// The delay of each channel. The multiplexer samples every eighth channel one tick late. The secondary's counter restarts at
/// half a period of the primary's, after a filter. If this filter has five taps, as in the secondary's diagram, the delay is
/// 186.3 degrees; if it has eight, as in the primary's diagram, 189.0 degrees. The published binary does not show how many it
/// has. The value here is the mean: 17 steps less 0.32 steps.
fn late(channel: usize) -> (u16, f64) {
    let (steps, rest) = if channel < CHANNELS { (0, 0.0) } else { (17, -0.32 / 32.0) };
    (steps + u16::from(channel % 8 == 3), rest)
}

/// The channel of a transducer. Transducers are numbered row by row, channels in squares of four columns, two rows at a time.
fn order(transducer: usize) -> usize {
    const PAIR: [[usize; 4]; 2] = [[0, 7, 1, 2], [4, 3, 6, 5]];
    let [row, column] = [transducer / 16, transducer % 16];
    64 * (column / 4) + 8 * (row / 2) + PAIR[row % 2][column % 4]
}

/// Writes off frames to both boards, twice, for both banks. A board that plays alone is a primary, and is selected last.
fn silence(boards: usize, _: &[u8]) -> Vec<u8> {
    let select = if boards == 1 { [SELECT + 1, SELECT] } else { [SELECT, SELECT + 1] };
    let off = select.map(|board| [&[board, START][..], &[OFF; CHANNELS]].concat()).concat();
    [&[CLOCKS], &off[..], &[SWAP], &off, &[SWAP]].concat()
}

fn encode(boards: usize, code: &dyn Fn(usize) -> Code, frame: &mut [u8]) {
    let mut bytes = Writer::new(frame);
    for board in 0..boards {
        if boards > 1 {
            bytes.put(SELECT + board as u8);
        }
        bytes.put(START);
        for channel in 0..CHANNELS {
            let Code { phase, level } = code(board * CHANNELS + channel);
            bytes.put(if level == 0 { OFF } else { phase as u8 });
        }
    }
    bytes.put(SWAP);
}

fn decode(boards: usize, frame: &[u8], put: &mut dyn FnMut(usize, Code)) -> Result<()> {
    let mut bytes = Reader::new(frame);
    for board in 0..boards {
        if boards > 1 {
            bytes.byte(
                |byte| byte == SELECT + board as u8,
                "192 before the first board's phases, 193 before the second's",
            )?;
        }
        bytes.byte(|byte| byte == START, "254 before the phases")?;
        for channel in 0..CHANNELS {
            let phase = bytes.byte(|byte| byte <= OFF, "phases of 0 to 31, or 32 for off")?;
            let code = Code { phase: phase.into(), level: 1 };
            put(board * CHANNELS + channel, if phase == OFF { Code::default() } else { code });
        }
    }
    bytes.byte(|byte| byte == SWAP, "253 at the end")?;
    bytes.end()
}
