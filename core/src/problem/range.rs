//! Range: rescales rows of G too weak or too strong for squares in f32, and targets far beyond reach.
//!
//! A solver gets these rows and their targets times a power of two, which changes no digit: the drive that meets them is
//! the same one. Their terms of eq. (7) then count as those of the other points do, among which f32 would have lost them.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::RangeInclusive;

use crate::problem::Problem;
use crate::workspace::Workspace;

/// p1_j in units of the reference, 2^-30 to 2^30: squares of sums and of their inverses stay within f32.
const MIDDLE: RangeInclusive<f64> = 1.0 / (1 << 30) as f64..=(1 << 30) as f64;

/// Largest ratio of a target to its reach: a larger target would change nothing.
const MOST_EXCESS: f64 = (1 << 20) as f64;

impl Problem {
    /// The problem as a solver gets it: this problem at `factor` times the caller's targets and within f32's range.
    /// `None` where it is that as it stands; [`Problem::recycle`] gives the memory back.
    pub(crate) fn prepared(&self, factor: f64, work: &Workspace) -> Option<Self> {
        let within = self.is_within(factor);
        if within && factor <= 1.0 {
            return None;
        }
        let mut prepared = self.rescaled(factor.max(1.0), work);
        if !within {
            prepared.stretch(&self.reach);
        }
        Some(prepared)
    }

    /// Whether rows of G and `factor` times the targets are within f32's range.
    pub(crate) fn is_within(&self, factor: f64) -> bool {
        let mut points = self.reach.iter().zip(&self.scaled);
        points.all(|(&reach, &target)| {
            let target = f64::from(target) * factor;
            reach == 0.0 || (MIDDLE.contains(&reach) && target <= MOST_EXCESS * reach)
        })
    }

    /// Whether rows of G differ from the caller's.
    pub(crate) fn is_stretched(&self) -> bool {
        self.plain.is_some()
    }

    /// The factor of the caller's targets.
    pub(crate) fn factor(&self) -> f64 {
        self.factor
    }

    /// The same problem at `factor` times the caller's targets.
    pub(crate) fn rescaled(&self, factor: f64, work: &Workspace) -> Self {
        let mut scaled = work.floats.take(self.propagation().lanes()).into_vec();
        self.targets.scaled(factor, &mut scaled);
        Self {
            selected: self.selected.clone(),
            start: self.start.clone(),
            aim: self.aim,
            factor,
            scaled,
            ..Self::of(Arc::clone(&self.targets))
        }
    }

    /// Multiplies rows out of range and their targets by powers of two, and lowers targets far beyond reach.
    fn stretch(&mut self, reach: &[f64]) {
        let reference = self.propagation().reference();
        let mut powers = Vec::with_capacity(reach.len());
        for (k, (&j, &reach)) in self.targets.active.iter().zip(reach).enumerate() {
            let target = (self.targets.pascals[j] * self.factor / reference).min(MOST_EXCESS * reach);
            // A quiet point may stay too weak.
            let outside = reach > *MIDDLE.end() || (reach < *MIDDLE.start() && target > 0.0);
            let power = if outside { inverse_power(reach) } else { 1.0 };
            self.scaled[k] = (target * power) as f32;
            powers.push(power);
        }
        let stretched = self.propagation().stretched(&powers);
        self.plain = self.selected.replace(stretched).or_else(|| Some(self.targets.propagation.clone()));
    }
}

/// The power of two that brings a positive normal number to 1 or above, below 2.
fn inverse_power(x: f64) -> f64 {
    let exponent = x.to_bits() >> 52;
    f64::from_bits((2046 - exponent).clamp(1, 2046) << 52)
}
