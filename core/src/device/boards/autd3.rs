//! AUTD3: for each device 249 phase bytes, then 249 intensity bytes, written by `planes`.

use crate::device::boards::planes;
use crate::device::format::{Format, Layout, Levels, Link, Steps, twice};

const CHANNELS: usize = 249;

pub(crate) const FORMAT: Format = Format {
    name: "autd3",
    summary: "AUTD3 devices over UDP, up to 128",
    source: "AUTD3 SDK 0.12 and 0.13: a pattern's phases and intensities; pulse widths make the pressure proportional to the intensity",
    channels: CHANNELS,
    most_boards: 128,
    steps: Steps { phases: 256, levels: Levels::Even(255) },
    // Frames are acknowledged, up to 1500 per second over loopback; phases need 1 ms to change.
    link: Link::Udp { rate: 1000.0 },
    frequency: 40e3,
    steady: f64::INFINITY,
    layout: Layout::Preset("autd3"),
    order: |transducer| transducer,
    late: |_| (0, 0.0),
    size: |boards| 2 * CHANNELS * boards,
    encode: |boards, code, frame| planes::write::<CHANNELS>(boards, 0, code, frame),
    decode: |boards, frame, put| planes::read::<CHANNELS>(boards, [0, 255], frame, put),
    silence: twice,
};
