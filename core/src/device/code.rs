//! Code: phase and amplitude of one transducer as whole numbers of its board.

use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use num_complex::Complex32;

use crate::device::quantization::Quantization;
use crate::error::Error;
use crate::kernels::pulses::Pulses;
use crate::math;
use crate::math::sqrtf;

/// Ten times the largest error of steps computed in f32.
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
    /// Step l of the phases, or the tick that a pulse begins with; 0 where the channel is off.
    pub phase: u16,
    /// Step of the amplitudes, or the ticks of a pulse; 0 is off.
    pub level: u16,
}

/// The amplitudes of a board's levels.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Levels {
    /// Off and on.
    OnOff,
    /// k/n of level k = 0 to n.
    Even(u16),
    /// Pulses of w = 0 to L/2 of the L ticks of a period, which have these lengths in any unit: their first harmonics.
    Pulses(&'static [u8]),
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
            Levels::Pulses(_) => self.phases / 2,
        }
    }

    /// Lengths of the ticks of a board that makes pulses.
    fn ticks(self) -> Option<Vec<f64>> {
        let Levels::Pulses(ticks) = self.levels else { return None };
        Some(ticks.iter().map(|&tick| f64::from(tick)).collect())
    }

    /// The pulses of a board that makes them.
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

    /// The nearest level.
    fn level(self, drive: Complex32) -> u16 {
        let quick = sqrtf(drive.re * drive.re + drive.im * drive.im).min(1.0) * f32::from(self.most());
        nearest(quick, || math::modulus(drive).min(1.0) * f64::from(self.most())) as u16
    }

    /// The code of the nearest phase and the nearest level to a finite drive.
    ///
    /// Steps are made whole before they are brought into 0 to L - 1: of a phase just below 0 the remainder in floating point
    /// would be L, which is no phase, and on some boards off.
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

    /// The drive that a code plays.
    pub(crate) fn drive(self, code: Code, correction: f64) -> Complex32 {
        let turns = f64::from(code.phase) / f64::from(self.phases) + correction;
        let drive = math::phasor(TAU * turns) * self.amplitude(code.level);
        Complex32::new(drive.re as f32, drive.im as f32)
    }

    /// Its phases and amplitudes, or its pulses.
    pub(crate) fn quantization(self) -> Result<Quantization, Error> {
        if let Some(ticks) = self.ticks() {
            return Quantization::of_pulses(&ticks);
        }
        let amplitudes = (0..=self.most()).map(|level| self.amplitude(level)).collect();
        Quantization::new(Some(self.phases.into()), Some(amplitudes))
    }
}

/// The code of the pulse nearest to a finite drive: its start and its width.
pub(crate) fn of_pulse(pulses: &Pulses, drive: Complex32, correction: f64) -> Code {
    let [start, width] = pulses.nearest(turned(drive, -correction));
    Code { phase: start as u16, level: width as u16 }
}

/// The drive of a pulse.
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
#[path = "tests/code.rs"]
mod tests;
