//! ultrasonic-homies rev 1: two FPGAs of 128 channels.
//!
//! A word of 8 bytes switches a channel off. A burst of bytes sets phases and switches channels on.

use crate::device::format::{Code, Format, Layout, Levels, Link, Reader, Steps, Writer, twice};
use crate::prelude::*;

const CHANNELS: usize = 128;
/// The first byte of a word is SUFFIX, its lowest byte; the last is PREFIX, its highest byte.
const SUFFIX: u8 = 0x55;
const PREFIX: u8 = 0xaa;
/// The command of a word with a phase, a channel and an enable bit.
const ENABLE: u8 = 1;
/// The command of a word with the number of bytes that follow: a phase and a channel for each transducer that is on.
const BURST: u8 = 2;
/// The longest frame of one FPGA has a word for each channel: all channels but one are off. All frames get this length by
/// zeros, which the receiver ignores.
const SIZE: usize = 8 * CHANNELS;

pub(crate) const FORMAT: Format = Format {
    name: "homies",
    summary: "ultrasonic-homies rev 1, an FPGA on each channel of its FT2232H, B first",
    source: "ultrasonic-homies, receiver.sv and phase_parser.sv",
    channels: CHANNELS,
    most_boards: 2,
    steps: Steps { phases: 256, levels: Levels::OnOff },
    // At this rate the FIFO transfers 1 MB/s, far below its limit.
    link: Link::Fifo { rate: 900.0, one_chip: true },
    frequency: 40e3,
    steady: f64::INFINITY,
    layout: Layout::Grid(16, 16, 10.5e-3),
    order: |transducer| transducer,
    late: |_| (0, 0.0),
    size: |boards| SIZE * boards,
    encode,
    decode,
    silence: twice,
};

/// Replaces the two phases whose bytes begin or end a word, because a receiver that has lost a byte would mistake
/// them for the begin or the end. The neighbouring phase step is played instead.
fn spared(phase: u16) -> u8 {
    match phase as u8 {
        SUFFIX => SUFFIX - 1,
        PREFIX => PREFIX + 1,
        phase => phase,
    }
}

fn encode(boards: usize, code: &dyn Fn(usize) -> Code, frame: &mut [u8]) {
    frame.fill(0);
    for (fpga, part) in frame.chunks_exact_mut(SIZE).take(boards).enumerate() {
        let mut bytes = Writer::new(part);
        let codes: [Code; CHANNELS] = core::array::from_fn(|channel| code(fpga * CHANNELS + channel));
        let on = || codes.iter().enumerate().filter(|(_, code)| code.level > 0);
        for channel in (0..CHANNELS).filter(|&channel| codes[channel].level == 0) {
            word(&mut bytes, ENABLE, [0, channel as u8, 0, 0]);
        }
        match (on().count(), on().next()) {
            (1, Some((channel, code))) => word(&mut bytes, ENABLE, [spared(code.phase), channel as u8, 1, 0]),
            (0, _) => {}
            (count, _) => {
                word(&mut bytes, BURST, (2 * count as u32).to_le_bytes());
                for (channel, code) in on() {
                    bytes.put(spared(code.phase));
                    bytes.put(channel as u8);
                }
            }
        }
    }
}

fn word(bytes: &mut Writer<'_>, command: u8, data: [u8; 4]) {
    [SUFFIX].into_iter().chain(data).chain([command, 0, PREFIX]).for_each(|byte| bytes.put(byte));
}

fn decode(boards: usize, frame: &[u8], put: &mut dyn FnMut(usize, Code)) -> Result<()> {
    let mut bytes = Reader::new(frame);
    for fpga in 0..boards {
        let end = (fpga + 1) * SIZE;
        while bytes.at < end {
            if bytes.byte(|byte| byte == SUFFIX || byte == 0, "85 where a word begins, or 0 between words")? == 0 {
                continue;
            }
            let data = [bytes.get()?, bytes.get()?, bytes.get()?, bytes.get()?];
            let command = bytes.byte(|byte| matches!(byte, ENABLE | BURST), "the command 1 or 2")?;
            bytes.byte(|byte| byte == 0, "0 as the command's upper byte")?;
            bytes.byte(|byte| byte == PREFIX, "170 where a word ends")?;
            if command == ENABLE {
                let code = Code { phase: data[0].into(), level: (data[2] & 1).into() };
                put(fpga * CHANNELS + channel(&bytes, data[1])?, code);
                continue;
            }
            let count = u32::from_le_bytes(data);
            refuse_if!(count % 2 > 0, bytes.fault(PREFIX, "an even number of bytes in the word before it"));
            for _ in 0..count / 2 {
                let [phase, number] = [bytes.get()?, bytes.get()?];
                put(fpga * CHANNELS + channel(&bytes, number)?, Code { phase: phase.into(), level: 1 });
            }
        }
    }
    bytes.end()
}

fn channel(bytes: &Reader<'_>, number: u8) -> Result<usize> {
    let channel = usize::from(number);
    if channel < CHANNELS { Ok(channel) } else { Err(bytes.fault(number, "channels of 0 to 127")) }
}
