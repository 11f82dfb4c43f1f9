//! Format: description of a kind of board: its bytes, its link and its array, as data and functions.

use alloc::format;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::Complex64;

use crate::device::code::{Code, Steps};
use crate::device::link::Link;
use crate::error::Error;
use crate::math;

/// A kind of board.
pub(crate) struct Format {
    pub(crate) name: &'static str,
    /// Its description in one line.
    pub(crate) summary: &'static str,
    /// Where its bytes are read.
    pub(crate) source: &'static str,
    /// Channels of one board.
    pub(crate) channels: usize,
    /// Boards that can play together.
    pub(crate) most_boards: usize,
    pub(crate) steps: Steps,
    pub(crate) link: Link,
    /// Hz that it emits.
    pub(crate) frequency: f64,
    /// Frames a second up to which it emits as at rest; infinite where it always does.
    pub(crate) steady: f64,
    pub(crate) layout: Layout,
    /// The channel of transducer i of one board, in the order of its preset.
    pub(crate) order: fn(usize) -> usize,
    /// The delay of a channel, with those of a second board after those of the first: whole steps, which the bytes
    /// correct, and the remaining turns, which are the response of the array.
    pub(crate) late: fn(usize) -> (u16, f64),
    /// Bytes of a frame of this many boards.
    pub(crate) size: fn(usize) -> usize,
    /// Writes the codes of the channels of this many boards into a frame of that size.
    pub(crate) encode: Encode,
    /// Reads them back.
    pub(crate) decode: Decode,
    /// Silences this many boards from any state, half a frame included, by their off frame.
    pub(crate) silence: fn(boards: usize, off: &[u8]) -> Vec<u8>,
}

impl Format {
    /// The channel of transducer i in the order of its preset, one board after the other.
    pub(crate) fn channel(&self, transducer: usize) -> usize {
        transducer - transducer % self.channels + (self.order)(transducer % self.channels)
    }

    /// The response of transducers at some channels for a drive of 1, if it is not 1 for all: the rest of their
    /// delays.
    pub(crate) fn response(&self, channels: impl Iterator<Item = usize>) -> Option<Vec<Complex64>> {
        let response: Vec<_> = channels.map(|channel| math::phasor(TAU * (self.late)(channel).1)).collect();
        response.iter().any(|&c| c != Complex64::ONE).then_some(response)
    }
}

/// Where the transducers of a kind of board are until the caller gives an array.
pub(crate) enum Layout {
    /// The places of the preset of that name.
    Preset(&'static str),
    /// A grid of columns, rows and a pitch in m, because each owner of such a board wires it differently.
    Grid(usize, usize, f64),
}

/// One off frame completes what was cut, the next is whole, and both banks of a board that has two are off.
pub(crate) fn twice(_: usize, off: &[u8]) -> Vec<u8> {
    off.repeat(2)
}

/// As `twice`, for boards that go on with half a frame where it was cut: the frame that completes it is none.
pub(crate) fn thrice(_: usize, off: &[u8]) -> Vec<u8> {
    off.repeat(3)
}

pub(crate) type Encode = fn(boards: usize, code: &dyn Fn(usize) -> Code, frame: &mut [u8]);
pub(crate) type Decode = fn(boards: usize, frame: &[u8], put: &mut dyn FnMut(usize, Code)) -> Result<(), Error>;

/// Bytes that are written one after the other.
pub(crate) struct Writer<'a> {
    free: core::slice::IterMut<'a, u8>,
}

impl<'a> Writer<'a> {
    pub(crate) fn new(frame: &'a mut [u8]) -> Self {
        Self { free: frame.iter_mut() }
    }

    pub(crate) fn put(&mut self, byte: u8) {
        // A frame has the size that its format tells.
        if let Some(next) = self.free.next() {
            *next = byte;
        }
    }
}

/// Bytes that are read one after the other.
pub(crate) struct Reader<'a> {
    frame: &'a [u8],
    pub(crate) at: usize,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(frame: &'a [u8]) -> Self {
        Self { frame, at: 0 }
    }

    pub(crate) fn get(&mut self) -> Result<u8, Error> {
        let Some(&byte) = self.frame.get(self.at) else {
            return Err(Error::invalid(
                "frame",
                format!("{} bytes", self.frame.len()),
                "it breaks off: give whole frames",
            ));
        };
        self.at += 1;
        Ok(byte)
    }

    /// The next byte, which must satisfy `fits`; otherwise the error says that `what` was expected.
    pub(crate) fn byte(&mut self, fits: impl FnOnce(u8) -> bool, what: &str) -> Result<u8, Error> {
        let byte = self.get()?;
        if fits(byte) { Ok(byte) } else { Err(self.fault(byte, what)) }
    }

    /// Refuses the byte just read.
    pub(crate) fn fault(&self, byte: u8, what: &str) -> Error {
        Error::invalid(format!("frame[{}]", self.at - 1), byte, format!("give {what}"))
    }

    /// Refuses bytes that are left.
    pub(crate) fn end(&self) -> Result<(), Error> {
        if self.at == self.frame.len() {
            return Ok(());
        }
        let cure = format!("it ends after {} bytes: give one frame", self.at);
        Err(Error::invalid("frame", format!("{} bytes", self.frame.len()), cure))
    }
}
