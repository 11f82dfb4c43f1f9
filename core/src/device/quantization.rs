//! Quantization: the phases and amplitudes that a board can play, and the rounding of drives to them.

use crate::error;
use crate::kernels::InstructionSet;
use crate::kernels::grid::{Amplitudes, Grid, Phases};
use crate::kernels::pulses::Pulses;
use crate::prelude::*;

/// The allowed numbers of phases: fewer than 2 are no choice, more than 2^16 are finer than f32.
const PHASES: core::ops::RangeInclusive<u32> = 2..=1 << 16;

/// The most ticks in a period of pulses.
const MOST_TICKS: usize = 1 << 12;

/// The most amplitudes in a table.
const MOST_AMPLITUDES: usize = 1 << 16;

/// Drives with a modulus above this are at full amplitude; the difference to 1 is rounding to f32.
const FULL: f64 = 1.0 - 1e-6;

/// An amplitude that exceeds the target by less than this part is allowed: half of the margin that the aim "target" allows.
const SLACK: f64 = 5e-5;

/// The highest amplitude that is not too loud is used, without a scale, if it gives at least this part of the pressure.
const KEPT: f64 = 0.9;

/// The part of a pressure that may be lost by rounding to an amplitude of the table.
const LOST: f64 = 2e-3;

/// The relative rounding error of an amplitude that should be one of the table.
const ROUNDING: f64 = 1e-9;

/// The allowed rounding error in a number of steps that should be whole.
const STEP_ROUNDING: f64 = 1e-9;

/// The number of whole steps that fit into a change in rad, for `phases` phases.
pub(crate) fn steps_within(change: f64, phases: u32) -> f64 {
    math::floor(change / TAU * f64::from(phases) + STEP_ROUNDING)
}

/// The phases and amplitudes that the channels of a device can play: L phases 2 pi l/L and a table of amplitudes. Either can be
/// left out if the device has continuous phases or amplitudes.
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
    /// The lengths of the ticks of a period, and the pulses; only for a board that makes pulses of whole ticks.
    pulses: Option<Box<(Vec<f64>, Pulses)>>,
}

impl Quantization {
    /// Returns a quantization of `phases` phases (2 to 65536) and a table of amplitudes, ascending from 0 or more to 1.
    ///
    /// # Errors
    /// A number of phases out of range; a table that is empty, too long, not ascending, outside 0 to 1, or that does not end in
    /// 1.
    pub fn new(phases: Option<u32>, amplitudes: Option<Vec<f64>>) -> Result<Self> {
        if let Some(count) = phases
            && !PHASES.contains(&count)
        {
            let cure = format!("give {} to {}, or leave it out", PHASES.start(), PHASES.end());
            return Err(Error::out_of_range("array.quantization.phases", count, cure));
        }
        if let Some(table) = &amplitudes {
            check_table(table)?;
        }
        let grid = Grid { phases: phases.map(Phases::new), amplitudes: amplitudes.as_deref().map(Amplitudes::new) };
        Ok(Self { amplitudes, grid, pulses: None })
    }

    /// Returns the quantization of a device with pulses of 1 to L/2 whole ticks, for the L ticks of a period. `ticks` are their
    /// lengths in any unit.
    ///
    /// Solvers search among L evenly spaced phases, with the amplitudes sin(pi w/L) of pulses of w ticks that are centred on
    /// them. The final drives are rounded to pulses. If all ticks are equal, these phases and amplitudes are pulses, and there
    /// are other pulses half a step between.
    ///
    /// # Errors
    /// An odd number of ticks or one out of range, a tick that is not above 0.
    pub fn of_pulses(ticks: &[f64]) -> Result<Self> {
        let count = ticks.len();
        if !count.is_multiple_of(2) || !(4..=MOST_TICKS).contains(&count) {
            let cure = format!("give an even number of 4 to {MOST_TICKS}");
            return Err(Error::out_of_range("array.quantization.pulses", format!("{count} ticks"), cure));
        }
        for (k, &tick) in ticks.iter().enumerate() {
            error::real(&format!("array.quantization.pulses[{k}]"), tick, 0.0, true)?;
        }
        let most = count / 2;
        let about = |&width: &usize| width == 0 || (most - width).is_multiple_of(2);
        let amplitude = |width: usize| math::sin(PI * width as f64 / count as f64);
        let amplitudes = (0..=most).filter(about).map(amplitude).collect();
        let pulses = Some(Box::new((ticks.to_vec(), Pulses::new(ticks))));
        Ok(Self { pulses, ..Self::new(Some(count as u32), Some(amplitudes))? })
    }

    /// Returns the same pulses, if the given phases and amplitudes agree with them.
    ///
    /// # Errors
    /// Other phases or amplitudes.
    pub fn agreeing(self, phases: Option<u32>, amplitudes: Option<&[f64]>) -> Result<Self> {
        let same = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-9);
        let cure = "leave them out: pulses have them";
        if let Some(count) = phases.filter(|_| phases != self.phases()) {
            return Err(Error::invalid("array.quantization.phases", count, cure));
        }
        match (amplitudes, self.amplitudes()) {
            (Some(levels), Some(table)) if !same(table, levels) => {
                Err(Error::shape("array.quantization.amplitudes", format!("{} of them", levels.len()), cure))
            }
            _ => Ok(self),
        }
    }

    /// The amplitudes above 0; empty if the amplitude is continuous.
    pub(crate) fn on(&self) -> &[f64] {
        let table = self.amplitudes().unwrap_or_default();
        &table[usize::from(table.first() == Some(&0.0))..]
    }

    /// Returns the drive with the nearest phase and the nearest amplitude. If two are equally near, it has the later phase and
    /// the larger amplitude. For ticks of different lengths it is the nearest pulse. 0 (dead, masked, not driven) stays 0.
    /// Phases are distinguished to 3e-8 turns.
    pub fn nearest(&self, drive: Complex32) -> Complex32 {
        if let Some(pulses) = self.uneven() {
            return pulses.rounded(drive);
        }
        let mut drive = [drive];
        self.grid.round(InstructionSet::SCALAR, 1.0, [1.0; 2], &mut drive);
        drive[0]
    }

    /// Returns the factor for supply or modulation, below 1 if the largest drive is below the smallest amplitude above 0. Such
    /// drives would all be rounded to 0; divided by this factor they reach that amplitude.
    pub(crate) fn scale(&self, largest: f64) -> f64 {
        match self.on().first() {
            Some(&least) if largest > 0.0 && largest < FULL * least => largest / least,
            _ => 1.0,
        }
    }

    /// Returns the highest amplitude, or 0, that is not above `factor`; `factor` itself if the amplitude is continuous.
    pub(crate) fn at_most(&self, factor: f64) -> f64 {
        let Some(table) = self.amplitudes() else { return factor };
        let above = table.partition_point(|&amplitude| amplitude <= factor * (1.0 + ROUNDING));
        above.checked_sub(1).map_or(0.0, |k| table[k])
    }

    /// Returns the two amplitudes next to `factor`, below and above it. Returns `None` if the lower one is accurate to 1/500,
    /// or if the upper one is more than twice the lower.
    pub(crate) fn between(&self, factor: f64) -> Option<[f64; 2]> {
        let table = self.amplitudes()?;
        let next = table.partition_point(|&amplitude| amplitude <= factor);
        let [below, above] = [*table.get(next.checked_sub(1)?)?, *table.get(next)?];
        (above <= 2.0 * below && factor - below > LOST * factor).then_some([below, above])
    }

    /// Lowers a full drive to `factor`, at most 1. Returns the amplitude, and the scale that supply or modulation must apply.
    /// The amplitude is the highest one that does not exceed `factor`. If that would lose more than a tenth, it is the next
    /// higher one with a scale below 1.
    pub(crate) fn lowered(&self, factor: f64) -> (f64, f64) {
        let Some(table) = self.amplitudes() else { return (factor, 1.0) };
        // There always is an amplitude above, because the last one is 1.
        let above = table.partition_point(|&amplitude| amplitude <= factor * (1.0 + SLACK));
        let below = above.checked_sub(1).map_or(0.0, |k| table[k]);
        if below >= KEPT * factor { (below, 1.0) } else { (table[above], factor / table[above]) }
    }
}

getters! {
    Quantization:

    /// The lengths of the ticks of a period, for a board that makes pulses of whole ticks; else `None`.
    pub ticks(self) -> Option<&[f64]> = self.pulses.as_ref().map(|pulses| &pulses.0[..]);

    pub(crate) pulses(self) -> Option<&Pulses> = self.pulses.as_ref().map(|pulses| &pulses.1);

    /// The pulses, if their ticks have different lengths. Then not every phase is possible with every amplitude.
    pub(crate) uneven(self) -> Option<&Pulses> =
        self.pulses().filter(|_| self.ticks().is_some_and(|ticks| ticks.iter().any(|&tick| tick != ticks[0])));

    /// The number of phases L; `None` if the phase is continuous.
    pub phases(self) -> Option<u32> = self.grid.phases.as_ref().map(|phases| phases.count() as u32);

    /// The amplitudes in ascending order, the last is 1; `None` if the amplitude is continuous.
    pub amplitudes(self) -> Option<&[f64]> = self.amplitudes.as_deref();

    /// Whether the device can play every drive.
    pub is_continuous(self) -> bool = self.grid.phases.is_none() && self.amplitudes.is_none();

    /// Rounds many drives at once; all instruction sets give the same bits.
    pub(crate) grid(self) -> &Grid = &self.grid;
}

fn check_table(table: &[f64]) -> Result<()> {
    let item = "array.quantization.amplitudes";
    if table.is_empty() || table.len() > MOST_AMPLITUDES {
        let cure = format!("give 1 to {MOST_AMPLITUDES}, or leave them out");
        return Err(Error::shape(item, format!("{} values", table.len()), cure));
    }
    for (k, &amplitude) in table.iter().enumerate() {
        let fault = |cure: &str| Error::invalid(format!("{item}[{k}]"), format!("{amplitude:?}"), cure);
        refuse_if!(!(0.0..=1.0).contains(&amplitude), fault("give amplitudes from 0 to 1"));
        refuse_if!(k > 0 && amplitude <= table[k - 1], fault("give each amplitude once, ascending"));
        if k + 1 == table.len() && amplitude != 1.0 {
            return Err(fault("the last amplitude is full drive: end the table in 1"));
        }
    }
    Ok(())
}

#[cfg(test)]
#[path = "tests/quantization.rs"]
mod tests;
