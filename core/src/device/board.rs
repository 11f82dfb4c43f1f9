//! Board: drives of an array to the bytes that make its boards play them, and back.

use alloc::format;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::{Complex32, Complex64};

use crate::device::boards::FORMATS;
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
    /// What it makes, where that is pulses.
    pulses: Option<Pulses>,
    /// The transducer at each channel.
    transducers: Vec<Option<usize>>,
    /// The channel of each transducer.
    channels: Vec<usize>,
    /// Turns that each transducer is late by of its own.
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
            transducers: Vec::new(),
            channels: Vec::new(),
            corrections: vec![0.0; transducers],
            live: vec![true; transducers],
        };
        board.with_channels((0..transducers).map(|i| format.channel(i)).collect())
    }

    /// The names of the kinds of boards.
    pub fn names() -> impl Iterator<Item = &'static str> {
        FORMATS.iter().map(|format| format.name)
    }

    /// The same with transducers at other channels (N,), those of a second board after those of the first.
    ///
    /// # Errors
    /// Another number of them, a channel that no board has, or one given twice.
    pub fn with_channels(mut self, channels: Vec<usize>) -> Result<Self, Error> {
        one_each("channels", channels.len(), "of them", self.len(), "transducers")?;
        let count = self.boards * self.format.channels;
        self.transducers = vec![None; count];
        for (i, &channel) in channels.iter().enumerate() {
            let fault = |cure| Err(Error::invalid(format!("channels[{i}]"), channel, cure));
            match self.transducers.get_mut(channel) {
                None => return fault(format!("give channels of 0 to {}", count - 1)),
                Some(Some(other)) => return fault(format!("channels[{other}] is the same: give each once")),
                Some(free) => *free = Some(i),
            }
        }
        self.channels = channels;
        Ok(self)
    }

    /// The same with phases (N,) in rad that each transducer adds by itself, by its polarity or wiring: the phase sent is the
    /// one wanted less the correction, before it is rounded.
    ///
    /// # Errors
    /// Another number of them, or one that is not finite.
    pub fn with_corrections(mut self, corrections: &[f64]) -> Result<Self, Error> {
        one_each("corrections", corrections.len(), "of them", self.len(), "transducers")?;
        for (i, (own, &correction)) in self.corrections.iter_mut().zip(corrections).enumerate() {
            let turns = error::real(&format!("corrections[{i}]"), correction, f64::MIN, false)? / TAU;
            *own = turns - math::floor(turns);
        }
        Ok(self)
    }

    /// The same with transducers (N,) that are always off where `live` is false.
    ///
    /// # Errors
    /// Another number of them.
    pub fn with_live(mut self, live: Vec<bool>) -> Result<Self, Error> {
        one_each("live", live.len(), "of them", self.len(), "transducers")?;
        self.live = live;
        Ok(self)
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.format.name
    }

    /// What it is, in one line.
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
        self.live.len()
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
        self.transducers.len()
    }

    /// The channel of each transducer (N,).
    #[must_use]
    pub fn channels(&self) -> &[usize] {
        &self.channels
    }

    /// Bytes of a frame, for all lines.
    #[must_use]
    pub fn frame_size(&self) -> usize {
        (self.format.size)(self.boards)
    }

    /// How bytes reach it.
    #[must_use]
    pub fn link(&self) -> Link {
        self.format.link
    }

    /// Hz that it emits.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.format.frequency
    }

    /// What each transducer (N,) radiates for a drive of 1, or `None` where that is 1: delays of the firmware that are no whole
    /// steps. It is the response of its presets' arrays; whole steps are in its bytes.
    #[must_use]
    pub fn response(&self) -> Option<Vec<Complex64>> {
        self.format.response(self.channels.iter().copied())
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

    /// Frames a second that it can be given and goes on to emit as at rest, at most [`Board::rate`].
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
    /// Another number of drives, or one that is not finite or above 1.
    pub fn codes(&self, drive: &[Complex32], codes: &mut [Code]) -> Result<(), Error> {
        self.check(drive)?;
        one_each("codes", codes.len(), "of them", self.transducers.len(), "channels")?;
        for (channel, code) in codes.iter_mut().enumerate() {
            *code = self.code(drive, channel);
        }
        Ok(())
    }

    /// Writes the frame (of [`Board::frame_size`] bytes) of a drive (N,).
    ///
    /// # Errors
    /// Another number of drives, one that is not finite or above 1, or a frame of another size.
    pub fn encode(&self, drive: &[Complex32], frame: &mut [u8]) -> Result<(), Error> {
        self.check(drive)?;
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
        drive.fill(Complex32::ZERO);
        (self.format.decode)(self.boards, frame, &mut |channel, code| {
            if let Some(transducer) = self.transducers[channel] {
                let late = self.late(transducer);
                drive[transducer] = match &self.pulses {
                    Some(pulses) => pulse(pulses, code, late),
                    None => self.format.steps.drive(code, late),
                };
            }
        })
    }

    /// The frame of a board that plays nothing.
    #[must_use]
    pub fn off_frame(&self) -> Vec<u8> {
        let mut frame = vec![0; self.frame_size()];
        (self.format.encode)(self.boards, &|_| Code::default(), &mut frame);
        frame
    }

    /// Bytes that silence the boards whatever they were told before, in both banks of those that have two.
    #[must_use]
    pub fn silence(&self) -> Vec<u8> {
        (self.format.silence)(self.boards, &self.off_frame())
    }

    fn code(&self, drive: &[Complex32], channel: usize) -> Code {
        match self.transducers[channel] {
            Some(i) if self.live[i] => match &self.pulses {
                Some(pulses) => of_pulse(pulses, drive[i], self.late(i)),
                None => self.format.steps.code(drive[i], self.late(i)),
            },
            _ => Code::default(),
        }
    }

    /// Turns that the bytes make up for.
    fn late(&self, transducer: usize) -> f64 {
        let (steps, _) = (self.format.late)(self.channels[transducer]);
        self.corrections[transducer] + f64::from(steps) / f64::from(self.format.steps.phases)
    }

    fn check(&self, drive: &[Complex32]) -> Result<(), Error> {
        one_each("drive", drive.len(), "of them", self.len(), "transducers")?;
        // In f32 first, where that is sure.
        let fits = |q: &Complex32| q.norm_sqr() <= 1.0 || (q.is_finite() && math::modulus(*q) <= 1.0 + SLACK);
        match drive.iter().position(|q| !fits(q)) {
            None => Ok(()),
            Some(i) => {
                let value = format!("{} + {}j", drive[i].re, drive[i].im);
                Err(Error::invalid(format!("drive[{i}]"), value, "give finite drives of at most 1"))
            }
        }
    }
}

/// What is known of a kind of board.
pub(crate) fn format(name: &str) -> Result<&'static Format, Error> {
    error::find("board", name, &FORMATS, |format| format.name)
}
