//! Code: what one transducer plays, as whole numbers of its board.

use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use num_complex::Complex32;

use crate::device::quantization::Quantization;
use crate::error::Error;
use crate::math;
use crate::math::sqrtf;

/// What steps computed in f32 are off by at most, and ten times more.
const DOUBT: f32 = 1e-3;

/// The whole number nearest to some steps, up to a few hundred, that are `quick` in f32 and known better in f64: a processor
/// without doubles takes twenty times as long for these, and hardly ever needs them.
fn nearest(quick: f32, exact: impl FnOnce() -> f64) -> i32 {
    let near = math::floorf(quick + 0.5);
    let beside = (quick - near).abs();
    if beside < 0.5 - DOUBT { near as i32 } else { math::floor(exact() + 0.5) as i32 }
}

/// Phase step and amplitude step of one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Code {
    /// Step l of the phases; 0 where the channel is off.
    pub phase: u16,
    /// Step of the amplitudes; 0 is off.
    pub level: u16,
}

/// The amplitudes of a board's levels.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Levels {
    /// Off and on.
    OnOff,
    /// k/n of level k = 0 to n.
    Even(u16),
    /// Pulses of w of the L ticks of a period: amplitude sin(pi w/L) of level w = 0 to L/2, the first harmonic of such a
    /// pulse, whose phase is that of its middle.
    Widths,
}

/// The steps of a board: L phases 2 pi l/L and its levels.
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
            Levels::Widths => self.phases / 2,
        }
    }

    /// The amplitude of a level.
    fn amplitude(self, level: u16) -> f64 {
        match self.levels {
            Levels::OnOff | Levels::Even(_) => f64::from(level) / f64::from(self.most()),
            Levels::Widths => math::sin(PI * f64::from(level) / f64::from(self.phases)),
        }
    }

    /// The nearest level: of amplitudes, or of widths, which are even in arcsin.
    fn level(self, drive: Complex32) -> u16 {
        if let Levels::Widths = self.levels {
            let amplitude = math::modulus(drive).min(1.0);
            return math::floor(math::asin(amplitude) / PI * f64::from(self.phases) + 0.5) as u16;
        }
        let quick = sqrtf(drive.re * drive.re + drive.im * drive.im).min(1.0) * f32::from(self.most());
        nearest(quick, || math::modulus(drive).min(1.0) * f64::from(self.most())) as u16
    }

    /// Steps from a phase to where its pulse begins: a pulse narrower than half a period begins later, for its middle to
    /// stay where it is.
    fn shift(self, level: u16) -> f64 {
        match self.levels {
            Levels::OnOff | Levels::Even(_) => 0.0,
            Levels::Widths => 0.25 * f64::from(self.phases) - 0.5 * f64::from(level),
        }
    }

    /// The code nearest to a finite drive. The width is chosen first, and begin and middle are rounded once.
    ///
    /// Steps are made whole before they are brought into 0 to L - 1: of a phase just below 0 the remainder in floating point
    /// would be L, which is no phase, and on some boards off.
    pub(crate) fn code(self, drive: Complex32, correction: f64) -> Code {
        let level = self.level(drive);
        if level == 0 {
            return Code::default();
        }
        let (phases, shift) = (f64::from(self.phases), self.shift(level));
        let turns = math::atan2f(drive.im, drive.re) / TAU as f32 - correction as f32;
        let steps = nearest(turns * f32::from(self.phases) + shift as f32, || {
            let turns = math::atan2(f64::from(drive.im), f64::from(drive.re)) / TAU - correction;
            turns * phases + shift
        });
        Code { phase: steps.rem_euclid(i32::from(self.phases)) as u16, level }
    }

    /// The drive that a code plays.
    pub(crate) fn drive(self, code: Code, correction: f64) -> Complex32 {
        let turns = (f64::from(code.phase) - self.shift(code.level)) / f64::from(self.phases) + correction;
        let drive = math::phasor(TAU * turns) * self.amplitude(code.level);
        Complex32::new(drive.re as f32, drive.im as f32)
    }

    /// The phases and amplitudes that go together: of pulses those widths whose middles lie on the L phases, with them off.
    pub(crate) fn quantization(self) -> Result<Quantization, Error> {
        let whole = |&level: &u16| level == 0 || self.shift(level) == math::floor(self.shift(level));
        let amplitudes: Vec<f64> = (0..=self.most()).filter(whole).map(|level| self.amplitude(level)).collect();
        Quantization::new(Some(self.phases.into()), Some(amplitudes))
    }
}

#[cfg(test)]
#[path = "tests/code.rs"]
mod tests;
