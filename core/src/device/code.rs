//! Code: the phase and amplitude of one channel as the whole numbers that its board uses.

use core::f64::consts::{PI, TAU};

use crate::device::quantization::Quantization;
use crate::kernels::pulses::Pulses;
use crate::math::sqrtf;
use crate::prelude::*;

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
    pub(crate) fn quantization(self) -> Result<Quantization, Error> {
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
#[path = "tests/code.rs"]
mod tests;
