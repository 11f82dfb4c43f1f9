//! Board: conversion of drives to the bytes of an array's boards, and back.

use alloc::borrow::Cow;
use alloc::format;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::{Complex32, Complex64};

use crate::device::boards::FORMATS;
use crate::device::channels::Channels;
use crate::device::code::{Code, of_pulse, pulse};
use crate::device::format::Format;
use crate::device::link::Link;
use crate::device::quantization::Quantization;
use crate::error::{self, Error, one_each};
use crate::kernels::pulses::Pulses;
use crate::math;

/// A drive may exceed 1 by its rounding to f32.
const SLACK: f64 = 1e-6;

/// The boards behind an array of N transducers.
///
/// ```
/// use midair::{Board, Complex32};
///
/// let board = Board::new("sonicsurface", 256)?;
/// let mut frame = vec![0; board.frame_size()];
/// let mut drive = vec![Complex32::from_polar(1.0, 0.4); 256];
/// drive[7] = Complex32::ZERO;
/// board.encode(&drive, &mut frame)?;
/// // 0.4 rad of 32 phases is the second, 32 is off; transducer 7 is channel 66.
/// assert_eq!(frame[..3], [254, 2, 2]);
/// assert_eq!(frame[1 + 66], 32);
/// board.decode(&frame, &mut drive)?;
/// assert!((drive[0].arg() - 2.0 * std::f32::consts::TAU / 32.0).abs() < 1e-6);
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone)]
pub struct Board {
    format: &'static Format,
    boards: usize,
    /// The pulses that it makes, if it makes pulses.
    pulses: Option<Pulses>,
    /// Which transducers one channel drives; `None` if each has its own. The lists below have one entry for each driven
    /// channel.
    wiring: Option<Channels>,
    /// Which drive each channel of the boards has.
    driven: Vec<Option<usize>>,
    /// The channel of each drive.
    channels: Vec<usize>,
    /// The delay of each drive's transducers themselves, in turns.
    corrections: Vec<f64>,
    live: Vec<bool>,
}

impl Board {
    /// As many boards of a kind as `transducers` need, in the order of its preset. [`Board::names`] lists the kinds.
    ///
    /// # Errors
    /// An unknown name, no transducers, or more than the boards have channels.
    pub fn new(name: &str, transducers: usize) -> Result<Self, Error> {
        let format = format(name)?;
        let most = format.channels * format.most_boards;
        if transducers == 0 || transducers > most {
            let cure = format!("{} has 1 to {most} channels", format.name);
            return Err(Error::invalid("transducers", transducers, cure));
        }
        let boards = transducers.div_ceil(format.channels);
        let board = Self {
            format,
            boards,
            pulses: format.steps.pulses(),
            wiring: None,
            driven: Vec::new(),
            channels: Vec::new(),
            corrections: vec![0.0; transducers],
            live: vec![true; transducers],
        };
        board.with_channels((0..transducers).map(|i| format.channel(i)).collect())
    }

    /// As many boards of a kind as the driven channels of an array need, several transducers on each.
    ///
    /// # Errors
    /// An unknown name, more of them than the boards have channels.
    pub fn wired(name: &str, channels: &Channels) -> Result<Self, Error> {
        let (format, count) = (format(name)?, channels.count());
        let most = format.channels * format.most_boards;
        if count > most {
            let cure = format!("{} has {most}: wire more transducers together", format.name);
            return Err(Error::invalid("array.channels", format!("{count} of them"), cure));
        }
        Ok(Self { wiring: Some(channels.clone()), ..Self::new(name, count)? })
    }

    /// The names of the kinds of boards.
    pub fn names() -> impl Iterator<Item = &'static str> {
        FORMATS.iter().map(|format| format.name)
    }

    /// The same with transducers at other channels (N,), those of a second board after those of the first; of an array with
    /// channels (C,), one for each of these.
    ///
    /// # Errors
    /// Another number of them, a channel that no board has, or one given twice.
    pub fn with_channels(mut self, channels: Vec<usize>) -> Result<Self, Error> {
        self.one_a_drive("channels", channels.len())?;
        let count = self.boards * self.format.channels;
        self.driven = vec![None; count];
        for (i, &channel) in channels.iter().enumerate() {
            let fault = |cure| Err(Error::invalid(format!("channels[{i}]"), channel, cure));
            match self.driven.get_mut(channel) {
                None => return fault(format!("give channels of 0 to {}", count - 1)),
                Some(Some(other)) => return fault(format!("channels[{other}] is the same: give each once")),
                Some(free) => *free = Some(i),
            }
        }
        self.channels = channels;
        Ok(self)
    }

    /// The same with phases (N,) in rad that each transducer, or (C,) each of the array's channels, adds by itself, by its
    /// polarity or wiring: the phase sent is the one wanted less the correction, before it is rounded.
    ///
    /// # Errors
    /// Another number of them, or one that is not finite.
    pub fn with_corrections(mut self, corrections: &[f64]) -> Result<Self, Error> {
        self.one_a_drive("corrections", corrections.len())?;
        for (i, (own, &correction)) in self.corrections.iter_mut().zip(corrections).enumerate() {
            let turns = error::real(&format!("corrections[{i}]"), correction, f64::MIN, false)? / TAU;
            *own = turns - math::floor(turns);
        }
        Ok(self)
    }

    /// The same with transducers (N,) that are always off where `live` is false, and channels of none but these.
    ///
    /// # Errors
    /// Another number of them.
    pub fn with_live(mut self, live: Vec<bool>) -> Result<Self, Error> {
        one_each("live", live.len(), "of them", self.len(), "transducers")?;
        self.live = match &self.wiring {
            None => live,
            Some(wiring) => (0..wiring.count()).map(|channel| wiring.members(channel).any(|i| live[i])).collect(),
        };
        Ok(self)
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.format.name
    }

    /// Its description in one line.
    #[must_use]
    pub fn summary(&self) -> &'static str {
        self.format.summary
    }

    /// Where its bytes are read.
    #[must_use]
    pub fn source(&self) -> &'static str {
        self.format.source
    }

    /// Number of transducers N.
    #[must_use]
    #[allow(clippy::len_without_is_empty, reason = "a board is never empty")]
    pub fn len(&self) -> usize {
        self.wiring.as_ref().map_or(self.live.len(), |wiring| wiring.of().len())
    }

    /// Refuses another number of values than drives.
    fn one_a_drive(&self, item: &str, found: usize) -> Result<(), Error> {
        let owners = if self.wiring.is_some() { "channels of the array" } else { "transducers" };
        one_each(item, found, "of them", self.live.len(), owners)
    }

    /// Number of boards.
    #[must_use]
    pub fn boards(&self) -> usize {
        self.boards
    }

    /// Number of lines: one for all boards, or one each. A frame is as many parts of one length, one after the other.
    #[must_use]
    pub fn lines(&self) -> usize {
        if let Link::Fifo { .. } = self.format.link { self.boards } else { 1 }
    }

    /// The most boards that play together.
    #[must_use]
    pub fn most_boards(&self) -> usize {
        self.format.most_boards
    }

    /// Number of channels of its boards.
    #[must_use]
    pub fn channel_count(&self) -> usize {
        self.driven.len()
    }

    /// The channel of each transducer (N,), or (C,) of each of the array's channels.
    #[must_use]
    pub fn channels(&self) -> &[usize] {
        &self.channels
    }

    /// Bytes of a frame, for all lines.
    #[must_use]
    pub fn frame_size(&self) -> usize {
        (self.format.size)(self.boards)
    }

    /// The link over which its bytes go.
    #[must_use]
    pub fn link(&self) -> Link {
        self.format.link
    }

    /// Hz that it emits.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.format.frequency
    }

    /// The response of each transducer (N,) to a drive of 1, or `None` where all are 1: delays of the firmware that
    /// are no whole steps. It is the response of its presets' arrays; whole steps are in its bytes.
    #[must_use]
    pub fn response(&self) -> Option<Vec<Complex64>> {
        let own = self.format.response(self.channels.iter().copied())?;
        Some(self.wiring.as_ref().map_or_else(|| own.clone(), |wiring| wiring.spread(&own)))
    }

    /// Bits a second of its serial line, `None` where it is on no such line.
    #[must_use]
    pub fn baud(&self) -> Option<u32> {
        match self.format.link {
            Link::Serial { baud, .. } => Some(baud),
            _ => None,
        }
    }

    /// Frames a second that its line can carry; a byte takes ten bits of a serial line.
    #[must_use]
    pub fn rate(&self) -> f64 {
        match self.format.link {
            Link::Serial { baud, .. } => f64::from(baud) / (10 * self.frame_size()) as f64,
            Link::Fifo { rate, .. } | Link::Udp { rate } => rate,
        }
    }

    /// The most frames a second that it takes and still emits as at rest, at most [`Board::rate`].
    #[must_use]
    pub fn steady_rate(&self) -> f64 {
        self.rate().min(self.format.steady / self.boards as f64)
    }

    /// The phases and amplitudes that it plays exactly. Drives off this grid may meet further pulse widths.
    ///
    /// # Errors
    /// None of the boards listed.
    pub fn quantization(&self) -> Result<Quantization, Error> {
        self.format.steps.quantization()
    }

    /// The codes (channels,) of a drive (N,), off where no transducer is.
    ///
    /// # Errors
    /// Another number of drives, one that is not finite or above 1, or two of one channel that differ.
    pub fn codes(&self, drive: &[Complex32], codes: &mut [Code]) -> Result<(), Error> {
        let drive = &*self.drives(drive)?;
        one_each("codes", codes.len(), "of them", self.driven.len(), "channels")?;
        for (channel, code) in codes.iter_mut().enumerate() {
            *code = self.code(drive, channel);
        }
        Ok(())
    }

    /// Writes the frame (of [`Board::frame_size`] bytes) of a drive (N,).
    ///
    /// # Errors
    /// Another number of drives, one that is not finite or above 1, two of one channel that differ, or a frame of another size.
    pub fn encode(&self, drive: &[Complex32], frame: &mut [u8]) -> Result<(), Error> {
        let drive = &*self.drives(drive)?;
        if frame.len() != self.frame_size() {
            let cure = format!("give room for {}", self.frame_size());
            return Err(Error::invalid("frame", format!("{} bytes", frame.len()), cure));
        }
        (self.format.encode)(self.boards, &|channel| self.code(drive, channel), frame);
        Ok(())
    }

    /// The drive (N,) that a frame plays.
    ///
    /// # Errors
    /// A frame that the board would not take for one, by the first byte that is wrong; another number of drives.
    pub fn decode(&self, frame: &[u8], drive: &mut [Complex32]) -> Result<(), Error> {
        one_each("drive", drive.len(), "of them", self.len(), "transducers")?;
        let mut own = vec![Complex32::ZERO; self.live.len()];
        (self.format.decode)(self.boards, frame, &mut |channel, code| {
            if let Some(k) = self.driven[channel] {
                let late = self.late(k);
                own[k] = match &self.pulses {
                    Some(pulses) => pulse(pulses, code, late),
                    None => self.format.steps.drive(code, late),
                };
            }
        })?;
        drive.copy_from_slice(&self.wiring.as_ref().map_or(own.clone(), |wiring| wiring.spread(&own)));
        Ok(())
    }

    /// The frame of a board that plays nothing.
    #[must_use]
    pub fn off_frame(&self) -> Vec<u8> {
        let mut frame = vec![0; self.frame_size()];
        (self.format.encode)(self.boards, &|_| Code::default(), &mut frame);
        frame
    }

    /// Bytes that silence the boards from any state, in both banks of those that have two.
    #[must_use]
    pub fn silence(&self) -> Vec<u8> {
        (self.format.silence)(self.boards, &self.off_frame())
    }

    fn code(&self, drive: &[Complex32], channel: usize) -> Code {
        match self.driven[channel] {
            Some(i) if self.live[i] => match &self.pulses {
                Some(pulses) => of_pulse(pulses, drive[i], self.late(i)),
                None => self.format.steps.code(drive[i], self.late(i)),
            },
            _ => Code::default(),
        }
    }

    /// Turns that the bytes make up for.
    fn late(&self, k: usize) -> f64 {
        let (steps, _) = (self.format.late)(self.channels[k]);
        self.corrections[k] + f64::from(steps) / f64::from(self.format.steps.phases)
    }

    /// One drive of each channel driven, of drives (N,), checked.
    fn drives<'a>(&self, drive: &'a [Complex32]) -> Result<Cow<'a, [Complex32]>, Error> {
        one_each("drive", drive.len(), "of them", self.len(), "transducers")?;
        // First in f32, where the result is certain.
        let fits = |q: &Complex32| q.norm_sqr() <= 1.0 || (q.is_finite() && math::modulus(*q) <= 1.0 + SLACK);
        if let Some(i) = drive.iter().position(|q| !fits(q)) {
            let value = format!("{} + {}j", drive[i].re, drive[i].im);
            return Err(Error::invalid(format!("drive[{i}]"), value, "give finite drives of at most 1"));
        }
        self.wiring.as_ref().map_or(Ok(Cow::Borrowed(drive)), |wiring| wiring.drives(drive).map(Cow::Owned))
    }
}

/// Facts about a kind of board.
pub(crate) fn format(name: &str) -> Result<&'static Format, Error> {
    error::find("board", name, &FORMATS, |format| format.name)
}
