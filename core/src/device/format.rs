//! Format: the description of a kind of board: steps, codes, bytes, link and array, as data and functions.

use crate::device::quantization::Quantization;
use crate::kernels::pulses::Pulses;
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
pub(crate) type Decode = fn(boards: usize, frame: &[u8], put: &mut dyn FnMut(usize, Code)) -> Result<()>;

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

    pub(crate) fn get(&mut self) -> Result<u8> {
        let Some(&byte) = self.frame.get(self.at) else {
            let cure = "it breaks off: give whole frames";
            return Err(Error::invalid("frame", format!("{} bytes", self.frame.len()), cure));
        };
        self.at += 1;
        Ok(byte)
    }

    /// The next byte, which must satisfy `fits`; otherwise the error says that `what` was expected.
    pub(crate) fn byte(&mut self, fits: impl FnOnce(u8) -> bool, what: &str) -> Result<u8> {
        let byte = self.get()?;
        if fits(byte) { Ok(byte) } else { Err(self.fault(byte, what)) }
    }

    /// Returns an error about the byte just read.
    pub(crate) fn fault(&self, byte: u8, what: &str) -> Error {
        Error::invalid(format!("frame[{}]", self.at - 1), byte, format!("give {what}"))
    }

    /// Checks that no bytes are left.
    pub(crate) fn end(&self) -> Result<()> {
        if self.at == self.frame.len() {
            return Ok(());
        }
        let cure = format!("it ends after {} bytes: give one frame", self.at);
        Err(Error::shape("frame", format!("{} bytes", self.frame.len()), cure))
    }
}

/// The type of link over which the bytes reach a kind of board.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Link {
    /// One serial line for all boards. A byte takes ten bits.
    Serial {
        /// Bits per second.
        baud: u32,
        /// The byte that exchanges the two banks of a board; `None` if it has no banks.
        swap: Option<u8>,
        /// Whether opening the port may restart the board, as with an Arduino.
        restarts: bool,
    },
    /// One FIFO of an FTDI chip for each board.
    Fifo {
        /// The most frames per second that the link transmits.
        rate: f64,
        /// Whether two boards may use the two FIFOs of one chip.
        one_chip: bool,
    },
    /// AUTD3's protocol over UDP, for all boards.
    Udp {
        /// The most frames per second that the link transmits.
        rate: f64,
    },
}

impl Link {
    /// The name of the link: "serial", "fifo" or "udp".
    pub fn name(self) -> &'static str {
        match self {
            Self::Serial { .. } => "serial",
            Self::Fifo { .. } => "fifo",
            Self::Udp { .. } => "udp",
        }
    }

    /// The byte that exchanges the two banks of a board; `None` if it has no banks.
    pub fn swap(self) -> Option<u8> {
        if let Self::Serial { swap, .. } = self { swap } else { None }
    }

    /// Whether opening the port may restart the board.
    pub fn restarts(self) -> bool {
        matches!(self, Self::Serial { restarts: true, .. })
    }

    /// Whether two boards may use the two FIFOs of one chip.
    pub fn one_chip(self) -> bool {
        matches!(self, Self::Fifo { one_chip: true, .. })
    }

    /// Whether amplitudes can be modulated. Over a serial line this is done by exchanging two banks, one of which is off.
    pub fn modulates(self) -> bool {
        self.swap().is_some() || self.holds_sequence()
    }

    /// Whether the board can store a sequence and play it by itself.
    pub fn holds_sequence(self) -> bool {
        matches!(self, Self::Udp { .. })
    }
}

/// Ten times the largest error of a number of steps computed in f32.
const DOUBT: f32 = 1e-3;

/// Returns the whole number nearest to a number of steps, at most a few hundred. `quick` is this number in f32; `exact`
/// computes it in f64. On a processor without doubles the latter takes twenty times as long, so it is only used close to the
/// middle between two whole numbers.
fn nearest(quick: f32, exact: impl FnOnce() -> f64) -> i32 {
    let near = math::floorf(quick + 0.5);
    let beside = (quick - near).abs();
    if beside < 0.5 - DOUBT { near as i32 } else { math::floor(exact() + 0.5) as i32 }
}

/// The phase step and the amplitude step of one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Code {
    /// The step l of the phase, or the tick at which a pulse begins; 0 if the channel is off.
    pub phase: u16,
    /// The step of the amplitude, or the length of a pulse in ticks; 0 is off.
    pub level: u16,
}

/// The amplitudes that the levels of a board stand for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Levels {
    /// Level 0 is off, level 1 is on.
    OnOff,
    /// Level k = 0 to n has the amplitude k/n.
    Even(u16),
    /// Level w is a pulse of w = 0 to L/2 ticks, of the L ticks of a period. The list contains the lengths of the ticks in any
    /// unit; the amplitude is that of the first harmonic.
    Pulses(&'static [u8]),
}

/// The steps of a board: L phases 2 pi l/L, and its levels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steps {
    pub(crate) phases: u16,
    pub(crate) levels: Levels,
}

impl Steps {
    /// The highest level.
    pub(crate) fn most(self) -> u16 {
        match self.levels {
            Levels::OnOff => 1,
            Levels::Even(most) => most,
            Levels::Pulses(_) => self.phases / 2,
        }
    }

    /// The lengths of the ticks, if the board makes pulses.
    fn ticks(self) -> Option<Vec<f64>> {
        let Levels::Pulses(ticks) = self.levels else { return None };
        Some(ticks.iter().map(|&tick| f64::from(tick)).collect())
    }

    /// The pulses, if the board makes pulses.
    pub(crate) fn pulses(self) -> Option<Pulses> {
        self.ticks().map(|ticks| Pulses::new(&ticks))
    }

    /// The amplitude of a level.
    fn amplitude(self, level: u16) -> f64 {
        match self.levels {
            Levels::OnOff | Levels::Even(_) => f64::from(level) / f64::from(self.most()),
            Levels::Pulses(_) => math::sin(PI * f64::from(level) / f64::from(self.phases)),
        }
    }

    /// The level nearest to the modulus of a drive.
    fn level(self, drive: Complex32) -> u16 {
        let quick = sqrtf(drive.re * drive.re + drive.im * drive.im).min(1.0) * f32::from(self.most());
        nearest(quick, || math::modulus(drive).min(1.0) * f64::from(self.most())) as u16
    }

    /// Returns the code whose phase and level are nearest to a finite drive. `correction` in turns is subtracted from the
    /// phase.
    ///
    /// The number of steps is rounded before it is reduced to 0 to L - 1. Otherwise a phase just below 0 could give L, which is
    /// no phase, and means off on some boards.
    pub(crate) fn code(self, drive: Complex32, correction: f64) -> Code {
        let level = self.level(drive);
        if level == 0 {
            return Code::default();
        }
        let turns = math::atan2f(drive.im, drive.re) / TAU as f32 - correction as f32;
        let steps = nearest(turns * f32::from(self.phases), || {
            let turns = math::atan2(f64::from(drive.im), f64::from(drive.re)) / TAU - correction;
            turns * f64::from(self.phases)
        });
        Code { phase: steps.rem_euclid(i32::from(self.phases)) as u16, level }
    }

    /// Returns the drive that a code plays.
    pub(crate) fn drive(self, code: Code, correction: f64) -> Complex32 {
        let turns = f64::from(code.phase) / f64::from(self.phases) + correction;
        let drive = math::phasor(TAU * turns) * self.amplitude(code.level);
        Complex32::new(drive.re as f32, drive.im as f32)
    }

    /// The phases and amplitudes, or the pulses, of the board.
    pub(crate) fn quantization(self) -> Result<Quantization> {
        if let Some(ticks) = self.ticks() {
            return Quantization::of_pulses(&ticks);
        }
        let amplitudes = (0..=self.most()).map(|level| self.amplitude(level)).collect();
        Quantization::new(Some(self.phases.into()), Some(amplitudes))
    }
}

/// Returns the code of the pulse nearest to a finite drive: its first tick and its width. `correction` is in turns.
pub(crate) fn of_pulse(pulses: &Pulses, drive: Complex32, correction: f64) -> Code {
    let [start, width] = pulses.nearest(turned(drive, -correction));
    Code { phase: start as u16, level: width as u16 }
}

/// Returns the drive that the code of a pulse plays.
pub(crate) fn pulse(pulses: &Pulses, code: Code, correction: f64) -> Complex32 {
    turned(pulses.drive(code.phase.into(), code.level.into()), correction)
}

fn turned(q: Complex32, turns: f64) -> Complex32 {
    if turns == 0.0 {
        return q;
    }
    let phasor = math::phasor(TAU * turns);
    q * Complex32::new(phasor.re as f32, phasor.im as f32)
}

#[cfg(test)]
#[path = "tests/format.rs"]
mod tests;
