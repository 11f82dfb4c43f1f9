//! Quantization: a board's phases and amplitude table, and rounding a drive to them.

use alloc::boxed::Box;
use alloc::format;
use alloc::vec::Vec;

use num_complex::Complex32;

use crate::error::{self, Error};
use crate::kernels::InstructionSet;
use crate::kernels::grid::{Amplitudes, Grid, Phases};
use crate::kernels::pulses::Pulses;
use crate::math;

/// Phase counts that make sense: fewer than 2 are none, more than 2^16 are finer than f32 drives.
const PHASES: core::ops::RangeInclusive<u32> = 2..=1 << 16;

/// The most ticks of a period of pulses.
const MOST_TICKS: usize = 1 << 12;

/// The most amplitudes of a table.
const MOST_AMPLITUDES: usize = 1 << 16;

/// Above this modulus a drive is at full power but for its rounding to f32.
const FULL: f64 = 1.0 - 1e-6;

/// A level above the target by less than this is not too loud: half of the margin that `level` = "target" allows.
const SLACK: f64 = 5e-5;

/// The part of a pressure that an amplitude of the table has to keep to be taken for it.
const KEPT: f64 = 0.9;

/// The part of a pressure that may be lost to the amplitudes of a table.
const LOST: f64 = 2e-3;

/// The error that rounding leaves in a number of steps that should be whole.
const STEP_ROUNDING: f64 = 1e-9;

/// The whole steps of `phases` phases that are within a change in rad.
pub(crate) fn steps_within(change: f64, phases: u32) -> f64 {
    math::floor(change / core::f64::consts::TAU * f64::from(phases) + STEP_ROUNDING)
}

/// Capabilities of the channels of a device: L phases 2 pi l/L and a table of amplitudes, each of which may be left
/// out for a device that is continuous in it.
///
/// ```
/// use midair::{Complex32, Quantization};
///
/// let board = Quantization::new(Some(4), Some(vec![0.0, 0.5, 1.0]))?;
/// assert_eq!(board.nearest(Complex32::from_polar(0.6, 0.7)), Complex32::new(0.5, 0.0));
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Quantization {
    amplitudes: Option<Vec<f64>>,
    grid: Grid,
    /// Lengths of the ticks of a period, and the pulses of whole ones, where a board makes these alone.
    pulses: Option<Box<(Vec<f64>, Pulses)>>,
}

impl Quantization {
    /// A device of `phases` phases (2 to 65536) and the amplitudes of a table, ascending from 0 or above to 1.
    ///
    /// # Errors
    /// A phase count out of range; a table that is empty, too long, not ascending, outside 0 to 1, or that does not
    /// end in 1.
    pub fn new(phases: Option<u32>, amplitudes: Option<Vec<f64>>) -> Result<Self, Error> {
        if let Some(count) = phases
            && !PHASES.contains(&count)
        {
            let cure = format!("give {} to {}, or leave it out", PHASES.start(), PHASES.end());
            return Err(Error::invalid("array.quantization.phases", count, cure));
        }
        if let Some(table) = &amplitudes {
            check_table(table)?;
        }
        let grid = Grid { phases: phases.map(Phases::new), amplitudes: amplitudes.as_deref().map(Amplitudes::new) };
        Ok(Self { amplitudes, grid, pulses: None })
    }

    /// A device of pulses that are whole ticks of a period long, 1 to half of them; ticks have these lengths in any unit.
    /// Searches go by as many even phases and by the amplitudes sin(pi w/L) of pulses about them; an answer is of pulses. Where
    /// ticks are equal, all of these phases and amplitudes are pulses, and other pulses lie half a step between.
    ///
    /// # Errors
    /// An odd number of ticks or one out of range, a tick that is not above 0.
    pub fn of_pulses(ticks: &[f64]) -> Result<Self, Error> {
        let count = ticks.len();
        if !count.is_multiple_of(2) || !(4..=MOST_TICKS).contains(&count) {
            let cure = format!("give an even number of 4 to {MOST_TICKS}");
            return Err(Error::invalid("array.quantization.pulses", format!("{count} ticks"), cure));
        }
        for (k, &tick) in ticks.iter().enumerate() {
            error::real(&format!("array.quantization.pulses[{k}]"), tick, 0.0, true)?;
        }
        let most = count / 2;
        let about = |&width: &usize| width == 0 || (most - width).is_multiple_of(2);
        let amplitude = |width: usize| math::sin(core::f64::consts::PI * width as f64 / count as f64);
        let amplitudes = (0..=most).filter(about).map(amplitude).collect();
        let pulses = Some(Box::new((ticks.to_vec(), Pulses::new(ticks))));
        Ok(Self { pulses, ..Self::new(Some(count as u32), Some(amplitudes))? })
    }

    /// The pulses, if all other given phases and amplitudes are those of the pulses.
    ///
    /// # Errors
    /// Others.
    pub fn agreeing(self, phases: Option<u32>, amplitudes: Option<&[f64]>) -> Result<Self, Error> {
        let same = |own: &[f64], given: &[f64]| {
            own.len() == given.len() && own.iter().zip(given).all(|(own, given)| (own - given).abs() < 1e-9)
        };
        let cure = "leave them out: pulses have them";
        if let Some(count) = phases.filter(|_| phases != self.phases()) {
            return Err(Error::invalid("array.quantization.phases", count, cure));
        }
        match (amplitudes, self.amplitudes()) {
            (Some(given), Some(own)) if !same(own, given) => {
                Err(Error::invalid("array.quantization.amplitudes", format!("{} of them", given.len()), cure))
            }
            _ => Ok(self),
        }
    }

    /// The lengths of a period's ticks, where a board makes pulses of whole ones alone.
    #[must_use]
    pub fn ticks(&self) -> Option<&[f64]> {
        self.pulses.as_ref().map(|pulses| &pulses.0[..])
    }

    pub(crate) fn pulses(&self) -> Option<&Pulses> {
        self.pulses.as_ref().map(|pulses| &pulses.1)
    }

    /// The pulses where not every phase goes with every amplitude.
    pub(crate) fn uneven(&self) -> Option<&Pulses> {
        self.pulses().filter(|_| self.ticks().is_some_and(|ticks| ticks.iter().any(|&tick| tick != ticks[0])))
    }

    /// Number of phases L, `None` if the phase is continuous.
    #[must_use]
    pub fn phases(&self) -> Option<u32> {
        self.grid.phases.as_ref().map(|phases| phases.count() as u32)
    }

    /// The amplitudes, ascending, the last 1; `None` if the amplitude is continuous.
    #[must_use]
    pub fn amplitudes(&self) -> Option<&[f64]> {
        self.amplitudes.as_deref()
    }

    /// The amplitudes above 0, empty if the amplitude is continuous.
    pub(crate) fn on(&self) -> &[f64] {
        let table = self.amplitudes().unwrap_or_default();
        &table[usize::from(table.first() == Some(&0.0))..]
    }

    /// Whether every drive can be played.
    #[must_use]
    pub fn is_continuous(&self) -> bool {
        self.grid.phases.is_none() && self.amplitudes.is_none()
    }

    /// The drive of the nearest phase and the nearest amplitude, of two as near the later phase and the larger amplitude; of uneven
    /// ticks the nearest pulse.
    /// 0 (dead, masked, not driven) stays 0. Phases are distinguished to 3e-8 turns.
    #[must_use]
    pub fn nearest(&self, drive: Complex32) -> Complex32 {
        if let Some(pulses) = self.uneven() {
            return pulses.rounded(drive);
        }
        let mut drive = [drive];
        self.grid.round(InstructionSet::SCALAR, 1.0, [1.0; 2], &mut drive);
        drive[0]
    }

    /// Rounding, for many drives at once: the same bits by every instruction set.
    pub(crate) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The factor for supply or modulation if the largest requested drive is below the least amplitude above 0,
    /// at which there would only be silence: the drives divided by this factor (at most 1) reach that amplitude.
    pub(crate) fn scale(&self, largest: f64) -> f64 {
        match self.on().first() {
            Some(&least) if largest > 0.0 && largest < FULL * least => largest / least,
            _ => 1.0,
        }
    }

    /// The two amplitudes above 0 next to `factor`, where the lower one alone would be more than a five hundredth too low and
    /// the upper one is at most twice the lower.
    pub(crate) fn between(&self, factor: f64) -> Option<[f64; 2]> {
        let table = self.amplitudes()?;
        let next = table.partition_point(|&amplitude| amplitude <= factor);
        let [below, above] = [*table.get(next.checked_sub(1)?)?, *table.get(next)?];
        (above <= 2.0 * below && factor - below > LOST * factor).then_some([below, above])
    }

    /// Full drive brought down to `factor` (at most 1) and no louder: the amplitude to drive at and the scale that is
    /// left to supply or modulation. The highest amplitude that is not too loud; where more than a tenth would be lost
    /// with it, the next one and a scale.
    pub(crate) fn lowered(&self, factor: f64) -> (f64, f64) {
        let Some(table) = self.amplitudes() else { return (factor, 1.0) };
        // The last amplitude is 1.
        let above = table.partition_point(|&amplitude| amplitude <= factor * (1.0 + SLACK));
        let below = above.checked_sub(1).map_or(0.0, |k| table[k]);
        if below >= KEPT * factor { (below, 1.0) } else { (table[above], factor / table[above]) }
    }
}

fn check_table(table: &[f64]) -> Result<(), Error> {
    let item = "array.quantization.amplitudes";
    if table.is_empty() || table.len() > MOST_AMPLITUDES {
        let cure = format!("give 1 to {MOST_AMPLITUDES}, or leave them out");
        return Err(Error::invalid(item, format!("{} values", table.len()), cure));
    }
    for (k, &amplitude) in table.iter().enumerate() {
        let fault = |cure: &str| Error::invalid(format!("{item}[{k}]"), format!("{amplitude:?}"), cure);
        if !(0.0..=1.0).contains(&amplitude) {
            return Err(fault("give amplitudes from 0 to 1"));
        }
        if k > 0 && amplitude <= table[k - 1] {
            return Err(fault("give each amplitude once, ascending"));
        }
        if k + 1 == table.len() && amplitude != 1.0 {
            return Err(fault("the last amplitude is full drive: end the table in 1"));
        }
    }
    Ok(())
}

#[cfg(test)]
#[path = "tests/quantization.rs"]
mod tests;
