//! AUTD3: of each device 249 phase bytes, then 249 intensity bytes.

use crate::device::code::{Code, Levels, Steps};
use crate::device::format::{Format, Line, Reader, twice};
use crate::error::Error;

const CHANNELS: usize = 249;

pub(crate) const FORMAT: Format = Format {
    name: "autd3",
    summary: "AUTD3 devices over UDP, up to 128",
    source: "AUTD3 SDK 0.12: a pattern's phases and intensities; pulse widths make the pressure proportional to the intensity",
    channels: CHANNELS,
    most_boards: 128,
    steps: Steps { phases: 256, levels: Levels::Even(255) },
    // Frames are acknowledged (up to 1500 a second over loopback), and phases take 1 ms to follow.
    line: Line::Frames(1000.0),
    apart: false,
    order: |transducer| transducer,
    size: |boards| 2 * CHANNELS * boards,
    encode,
    decode,
    silence: twice,
};

fn encode(boards: usize, code: &dyn Fn(usize) -> Code, frame: &mut [u8]) {
    for (board, bytes) in frame.chunks_exact_mut(2 * CHANNELS).take(boards).enumerate() {
        for channel in 0..CHANNELS {
            let Code { phase, level } = code(board * CHANNELS + channel);
            bytes[channel] = phase as u8;
            bytes[CHANNELS + channel] = level as u8;
        }
    }
}

fn decode(boards: usize, frame: &[u8], put: &mut dyn FnMut(usize, Code)) -> Result<(), Error> {
    let mut bytes = Reader::new(frame);
    for board in 0..boards {
        let mut phases = [0; CHANNELS];
        for phase in &mut phases {
            *phase = bytes.get()?;
        }
        for (channel, phase) in phases.into_iter().enumerate() {
            let level = bytes.get()?;
            put(board * CHANNELS + channel, Code { phase: phase.into(), level: level.into() });
        }
    }
    bytes.end()
}
