//! Range: brings rows of the propagation matrix G that are too weak or too strong into that of f32, and lowers targets far beyond reach.
//!
//! These rows and their targets are multiplied by a power of two, which changes no digit, so the drive that meets the targets
//! stays the same. In the sum of squared errors their terms then have a size similar to those of other points, and are not lost
//! in f32.

use core::ops::RangeInclusive;

use crate::prelude::*;
use crate::problem::Problem;
use crate::workspace::Workspace;

/// The allowed range of p1_j, the sum of |G_ji|, in units of the reference: 2^-30 to 2^30. Squares of sums and of their
/// inverses then stay within f32.
const MIDDLE: RangeInclusive<f64> = 1.0 / (1 << 30) as f64..=(1 << 30) as f64;

/// The largest allowed ratio of a target to its reach: a higher target would give the same drive.
const MOST_EXCESS: f64 = (1 << 20) as f64;

impl Problem {
    /// Returns the problem that a solver gets: with `factor` times the caller's targets, and within the range of f32. Returns
    /// `None` if this problem can be used unchanged. [`Problem::recycle`] returns the memory.
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

    /// Whether the rows of the propagation matrix G, and `factor` times the targets, are within the range of f32.
    pub(crate) fn is_within(&self, factor: f64) -> bool {
        let mut points = self.reach.iter().zip(&self.scaled);
        points.all(|(&reach, &target)| {
            let target = f64::from(target) * factor;
            reach == 0.0 || (MIDDLE.contains(&reach) && target <= MOST_EXCESS * reach)
        })
    }

    /// Whether rows of the propagation matrix G have been rescaled.
    pub(crate) fn is_stretched(&self) -> bool {
        self.plain.is_some()
    }

    /// The factor between this problem's targets and the caller's.
    pub(crate) fn factor(&self) -> f64 {
        self.factor
    }

    /// Returns a copy of this problem with `factor` times the caller's targets.
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

    /// Multiplies rows that are out of range, and their targets, by powers of two. Lowers targets that are far beyond reach.
    fn stretch(&mut self, reach: &[f64]) {
        let reference = self.propagation().reference();
        let mut powers = Vec::with_capacity(reach.len());
        for (k, (&j, &reach)) in self.targets.active.iter().zip(reach).enumerate() {
            let target = (self.targets.target(j) * self.factor / reference).min(MOST_EXCESS * reach);
            // A quiet point may keep a row that is too weak.
            let outside = reach > *MIDDLE.end() || (reach < *MIDDLE.start() && target > 0.0);
            let power = if outside { inverse_power(reach) } else { 1.0 };
            self.scaled[k] = (target * power) as f32;
            powers.push(power);
        }
        let stretched = self.propagation().stretched(&powers);
        self.plain = self.selected.replace(stretched).or_else(|| Some(self.targets.propagation.clone()));
    }
}

/// The power of two whose product with a positive normal number is at least 1 and below 2.
fn inverse_power(x: f64) -> f64 {
    let exponent = x.to_bits() >> 52;
    f64::from_bits((2046 - exponent).clamp(1, 2046) << 52)
}
