//! Ultraino's Arduinos: in each tick of a period, one bit for each pin says whether it is high; a byte contains four bits.

use crate::device::format::{Code, Format, Layout, Levels, Link, Reader, Steps, Writer, thrice};
use crate::prelude::*;

/// Exchanges the two buffers.
const SWAP: u8 = 0x00;
/// On a Nano, returns to the first byte of the buffer.
const RESET: u8 = 0x10;

const ARDUINO: Link = Link::Serial { baud: 115_200, swap: None, restarts: true };
const SOURCE: &str = "Ultraino: firmware of the driver boards and the classes of its Java program that write to them";

pub(crate) const MEGA64: Format = Format {
    name: "mega64",
    summary: "Ultraino's Arduino MEGA boards of 64, up to 14 in a chain",
    source: SOURCE,
    channels: 64,
    most_boards: 14,
    steps: Steps { phases: 10, levels: Levels::Pulses(&TICKS) },
    link: ARDUINO,
    frequency: MEGA64_HZ,
    // The interrupt for each byte stops the pins for half a period. At 55 frames per second the boards emit 35 kHz with 0.55 of
    // the amplitude.
    steady: 10.0,
    layout: Layout::Example("ultraino_flat8x8"),
    order: |transducer| transducer,
    late: |channel| (0, (PORTS_LATE[PINS[channel % 64] / 8] - BEFORE) / PERIOD),
    size: |boards| 200 * boards + DURATIONS.len() + 1,
    encode: |boards, code, frame| {
        let mut bytes = Writer::new(frame);
        for board in 0..boards {
            write::<64>(10, 10, board, &|channel| PINS[channel], code, &mut bytes);
        }
        DURATIONS.into_iter().chain([SWAP]).for_each(|byte| bytes.put(byte));
    },
    decode: |boards, frame, put| {
        let mut bytes = Reader::new(frame);
        for board in 0..boards {
            read::<64>(10, 10, board, &|channel| PINS[channel], None, put, &mut bytes)?;
        }
        for expected in DURATIONS.into_iter().chain([SWAP]) {
            bytes.byte(|byte| byte == expected, "the durations 1 and 0, 16 and 0 after the data")?;
        }
        bytes.end()
    },
    silence: thrice,
};

/// The length of each of the ten ticks of a period, in clock cycles at 16 MHz, as in the published binary.
const TICKS: [u8; 10] = [38, 42, 34, 35, 35, 36, 43, 43, 34, 56];
const PERIOD: f64 = 396.0;
/// How many cycles these ticks begin before ticks of equal length, on average.
const BEFORE: f64 = 8.8;
const MEGA64_HZ: f64 = 16e6 / PERIOD;

/// Cycles from the first port to each port, in the order of [`PINS`]: the ports are written one after another.
const PORTS_LATE: [f64; 10] = [0.0, 3.0, 7.0, 10.0, 14.0, 17.0, 20.0, 24.0, 27.0, 30.0];

/// How long the pattern of a period is repeated: the durations 1 and 0, two bits in each byte, the most significant
/// bits first. The last byte marks the end.
const DURATIONS: [u8; 9] = [0x30, 0x30, 0x30, 0x70, 0x30, 0x30, 0x30, 0x30, 0x10];

/// The pin of each channel of a MEGA64: 8 times the index of its port in A C L B K F H D G J, plus its bit in the port.
const PINS: [usize; 64] = [
    51, 52, 53, 54, 28, 29, 30, 31, 47, 46, 45, 44, 43, 42, 41, 40, 56, 57, 58, 59, 48, 49, 72, 69, 39, 38, 37, 36, 35,
    34, 33, 32, 21, 23, 65, 63, 9, 11, 13, 15, 20, 22, 64, 66, 8, 10, 12, 14, 24, 25, 26, 27, 16, 17, 18, 19, 7, 6, 5,
    4, 3, 2, 1, 0,
];

pub(crate) const NANO16: Format = Format {
    name: "nano16",
    summary: "Ultraino's Arduino Nano of 16 channels",
    source: SOURCE,
    channels: 16,
    most_boards: 1,
    steps: Steps { phases: 16, levels: Levels::OnOff },
    link: ARDUINO,
    frequency: 40e3,
    steady: f64::INFINITY,
    layout: Layout::Grid(4, 4, 10e-3),
    order: |transducer| transducer,
    late: |_| (0, 0.0),
    size: |_| 65,
    encode: |_, code, frame| write_nano::<16>(16, code, frame),
    decode: |_, frame, put| read_nano::<16>(16, frame, put),
    silence: |_, off| [&[RESET], off, off].concat(),
};

pub(crate) const NANO: Format = Format {
    name: "nano",
    summary: "Ultraino's Arduino Nano of 8 channels",
    channels: 8,
    steps: Steps { phases: 24, levels: Levels::OnOff },
    layout: Layout::Grid(4, 2, 10e-3),
    size: |_| 49,
    encode: |_, code, frame| write_nano::<8>(24, code, frame),
    decode: |_, frame, put| read_nano::<8>(24, frame, put),
    silence: thrice,
    ..NANO16
};

/// Writes the frame of a Nano. Its pulses are half a period long, so level 1 becomes `ticks` / 2.
fn write_nano<const N: usize>(ticks: u16, code: &dyn Fn(usize) -> Code, frame: &mut [u8]) {
    let mut bytes = Writer::new(frame);
    let pulse = |channel| {
        let Code { phase, level } = code(channel);
        Code { phase, level: level * ticks / 2 }
    };
    write::<N>(ticks, N / 8, 0, &|channel| channel, &pulse, &mut bytes);
    bytes.put(SWAP);
}

fn read_nano<const N: usize>(ticks: u16, frame: &[u8], put: &mut dyn FnMut(usize, Code)) -> Result<()> {
    let mut bytes = Reader::new(frame);
    let mut on = |channel, Code { phase, level }| put(channel, Code { phase, level: level.min(1) });
    read::<N>(ticks, N / 8, 0, &|channel| channel, Some(ticks / 2), &mut on, &mut bytes)?;
    bytes.byte(|byte| byte == SWAP, "0 at the end")?;
    bytes.end()
}

/// Writes the ports of a board's N channels in each tick: a pin is high for `level` ticks from `phase` on. The lower half of a
/// byte is the number of the board, counted from 1. Each board of a chain subtracts 1 and passes the byte on.
fn write<const N: usize>(
    ticks: u16,
    ports: usize,
    board: usize,
    pin: &dyn Fn(usize) -> usize,
    code: &dyn Fn(usize) -> Code,
    bytes: &mut Writer<'_>,
) {
    let mut channels = [None; 80];
    for channel in 0..N {
        channels[pin(channel)] = Some(code(board * N + channel));
    }
    let address = board as u8 + 1;
    for tick in 0..ticks {
        for port in 0..ports {
            let high = |&bit: &usize| {
                channels[8 * port + bit].is_some_and(|Code { phase, level }| (tick + ticks - phase) % ticks < level)
            };
            let byte: u8 = (0..8).filter(high).map(|bit| 1 << bit).sum();
            bytes.put(byte & 0xf0 | address);
            bytes.put(byte << 4 | address);
        }
    }
}

/// Reads the pulses back from their ticks. Each channel has one pulse, of `width` ticks if that is given.
fn read<const N: usize>(
    ticks: u16,
    ports: usize,
    board: usize,
    pin: &dyn Fn(usize) -> usize,
    width: Option<u16>,
    put: &mut dyn FnMut(usize, Code),
    bytes: &mut Reader<'_>,
) -> Result<()> {
    let mut high = [0_u32; 80];
    let addressed = |byte: u8| usize::from(byte & 0x0f) == board + 1;
    for tick in 0..ticks {
        for port in 0..ports {
            let upper = bytes.byte(addressed, "the board's number, counted from 1, in the lower four bits")?;
            let lower = bytes.byte(addressed, "the board's number, counted from 1, in the lower four bits")?;
            let byte = upper & 0xf0 | lower >> 4;
            for bit in 0..8 {
                high[8 * port + bit] |= u32::from(byte >> bit & 1) << tick;
            }
        }
    }
    for channel in 0..N {
        let pulse = high[pin(channel)];
        let at = |tick: u16| pulse >> (tick % ticks) & 1;
        let mut begins = (0..ticks).filter(|&tick| at(tick) == 1 && at(tick + ticks - 1) == 0);
        let level = pulse.count_ones() as u16;
        let code = match (begins.clone().count(), begins.next_back()) {
            (0, _) if pulse == 0 => Code::default(),
            (1, Some(phase)) if level <= ticks / 2 && width.is_none_or(|width| level == width) => Code { phase, level },
            _ => {
                let cure = "give one pulse a period, at most half of it long";
                return Err(Error::invalid(
                    format!("pulse of channel {}", board * N + channel),
                    format!("{pulse:#b}"),
                    cure,
                ));
            }
        };
        put(board * N + channel, code);
    }
    Ok(())
}
