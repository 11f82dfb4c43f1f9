//! Format: the description of a kind of board: its bytes, its link and its array, as data and functions.

use core::f64::consts::TAU;

use crate::device::code::{Code, Steps};
use crate::device::link::Link;
use crate::prelude::*;

/// A kind of board.
pub(crate) struct Format {
    pub(crate) name: &'static str,
    /// The description in one line, for users.
    pub(crate) summary: &'static str,
    /// The publication or source code that defines the bytes.
    pub(crate) source: &'static str,
    /// The number of channels of one board.
    pub(crate) channels: usize,
    /// The most boards that can play together.
    pub(crate) most_boards: usize,
    pub(crate) steps: Steps,
    pub(crate) link: Link,
    /// The ultrasound frequency in Hz.
    pub(crate) frequency: f64,
    /// The most frames per second during which the emitted sound is not disturbed; infinite if it never is.
    pub(crate) steady: f64,
    pub(crate) layout: Layout,
    /// The channel of transducer i of one board, in the order of its preset.
    pub(crate) order: fn(usize) -> usize,
    /// The delay of a channel; the channels of a second board follow those of the first. It consists of whole steps, which the
    /// bytes correct, and of the remaining turns, which become the response of the array.
    pub(crate) late: fn(usize) -> (u16, f64),
    /// The bytes of a frame for this many boards.
    pub(crate) size: fn(usize) -> usize,
    /// Writes the codes of all channels of this many boards into a frame of that size.
    pub(crate) encode: Encode,
    /// Reads the codes from a frame.
    pub(crate) decode: Decode,
    /// Returns bytes that switch this many boards off from any state, even in the middle of a frame; `off` is their off frame.
    pub(crate) silence: fn(boards: usize, off: &[u8]) -> Vec<u8>,
}

impl Format {
    /// The channel of transducer i, in the order of the preset, for several boards one after the other.
    pub(crate) fn channel(&self, transducer: usize) -> usize {
        transducer - transducer % self.channels + (self.order)(transducer % self.channels)
    }

    /// The response to a drive of 1 of the transducers on these channels; `None` if it is 1 for all. It contains the part of
    /// the delays that the bytes do not correct.
    pub(crate) fn response(&self, channels: impl Iterator<Item = usize>) -> Option<Vec<Complex64>> {
        let response: Vec<_> = channels.map(|channel| math::phasor(TAU * (self.late)(channel).1)).collect();
        response.iter().any(|&c| c != Complex64::ONE).then_some(response)
    }
}

/// The default positions of the transducers of a kind of board.
pub(crate) enum Layout {
    /// The positions of the preset with this name, on each board.
    Preset(&'static str),
    /// The positions of the preset with this name, if the owner of such a board has no others.
    Example(&'static str),
    /// A grid (columns, rows, pitch in m), if each owner of such a board wires it differently.
    Grid(usize, usize, f64),
}

/// Returns two off frames: the first completes a frame that was cut off, the second is complete. If a board has two
/// banks, both banks are then off.
pub(crate) fn twice(_: usize, off: &[u8]) -> Vec<u8> {
    off.repeat(2)
}

/// Returns three off frames, for boards that continue a frame that was cut off. The first off frame completes that frame, which
/// is then not valid.
pub(crate) fn thrice(_: usize, off: &[u8]) -> Vec<u8> {
    off.repeat(3)
}

pub(crate) type Encode = fn(boards: usize, code: &dyn Fn(usize) -> Code, frame: &mut [u8]);
pub(crate) type Decode = fn(boards: usize, frame: &[u8], put: &mut dyn FnMut(usize, Code)) -> Result<(), Error>;

/// Writes bytes one after the other.
pub(crate) struct Writer<'a> {
    free: core::slice::IterMut<'a, u8>,
}

impl<'a> Writer<'a> {
    pub(crate) fn new(frame: &'a mut [u8]) -> Self {
        Self { free: frame.iter_mut() }
    }

    pub(crate) fn put(&mut self, byte: u8) {
        // The buffer is as large as the frame of the format, so there is always space.
        if let Some(next) = self.free.next() {
            *next = byte;
        }
    }
}

/// Reads bytes one after the other.
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
            let cure = "it breaks off: give whole frames";
            return Err(Error::invalid("frame", format!("{} bytes", self.frame.len()), cure));
        };
        self.at += 1;
        Ok(byte)
    }

    /// The next byte, which must satisfy `fits`; otherwise the error says that `what` was expected.
    pub(crate) fn byte(&mut self, fits: impl FnOnce(u8) -> bool, what: &str) -> Result<u8, Error> {
        let byte = self.get()?;
        if fits(byte) { Ok(byte) } else { Err(self.fault(byte, what)) }
    }

    /// Returns an error about the byte just read.
    pub(crate) fn fault(&self, byte: u8, what: &str) -> Error {
        Error::invalid(format!("frame[{}]", self.at - 1), byte, format!("give {what}"))
    }

    /// Checks that no bytes are left.
    pub(crate) fn end(&self) -> Result<(), Error> {
        if self.at == self.frame.len() {
            return Ok(());
        }
        let cure = format!("it ends after {} bytes: give one frame", self.at);
        Err(Error::shape("frame", format!("{} bytes", self.frame.len()), cure))
    }
}
