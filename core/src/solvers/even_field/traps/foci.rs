//! Foci that keep their pressures while the traps beside them are made stiff.
//!
//! ```text
//! v_j = (|P_j| - p_j)/p_j                 error of focus j of requested pressure p_j; at a quiet point |P_j| over the largest p
//! E = sum_j y_j v_j + w/2 v_j^2           the cost;   y_j += w v_j after each stage
//! ```
//!
//! This is an augmented Lagrangian (Nocedal and Wright 2006, chapter 17.3). Without the multipliers y the traps would
//! change each pressure until the slope of their stiffness equals w v_j. If a stage does not bring the foci nearer, w
//! grows: a focus beyond reach comes as near its pressure as the array can.

use crate::prelude::*;
use crate::problem::Problem;
use crate::propagation::forces::stiffness::Stiffness;

/// The weight w of the module's head: an error of 2 % in the pressure of a focus costs as much as two hundredths of the
/// stiffness of the softest trap.
const WEIGHT: f64 = 100.0;
/// The factor of w after a stage that does not bring the foci nearer.
const HEAVIER: f64 = 10.0;

/// The pressures that foci keep, in the order of [`Stiffness::foci`].
#[derive(Clone, Default)]
pub(super) struct FixedFoci {
    /// p_j in units of the reference, and the divisor of |P_j| - p_j in v_j.
    targets: Vec<[f64; 2]>,
    multipliers: Vec<f64>,
    /// w, and the largest |v| after the last stage.
    weight: f64,
    last: f64,
}

/// The error v of a focus (see the module's head), and its derivatives by Re P and Im P.
pub(super) struct Off {
    /// The index of the focus among the points of C.
    pub(super) row: usize,
    pub(super) part: f64,
    pub(super) slope: [f64; 2],
}

impl FixedFoci {
    /// Creates the foci beside traps, at `level` times their targets.
    pub(super) fn of(traps: &Stiffness, problem: &Problem, level: f64) -> Self {
        let foci = traps.chosen()[1].iter().map(|&j| level * f64::from(problem.targets()[j]));
        let largest = foci.clone().fold(0.0, f64::max);
        let targets: Vec<_> = foci.map(|target| [target, if target > 0.0 { target } else { largest }]).collect();
        Self { multipliers: vec![0.0; targets.len()], targets, weight: WEIGHT, last: f64::INFINITY }
    }

    /// Returns the error of each focus in a field.
    pub(super) fn off(&self, stiffness: &Stiffness, field: [&[f32]; 2]) -> impl Iterator<Item = Off> {
        stiffness.foci(field).zip(&self.targets).map(|((row, [re, im]), [target, unit])| {
            let modulus = math::hypot(re, im).max(f64::MIN_POSITIVE);
            Off { row, part: (modulus - target) / unit, slope: [re, im].map(|part| part / (modulus * unit)) }
        })
    }

    /// Returns E for the errors v of all foci.
    pub(super) fn cost(&self, off: impl Iterator<Item = f64>) -> f64 {
        off.zip(&self.multipliers).map(|(off, y)| (y + self.weight / 2.0 * off) * off).sum()
    }

    /// Returns each focus with dE/dv.
    pub(super) fn pulled(&self, foci: impl Iterator<Item = Off>) -> impl Iterator<Item = (Off, f64)> {
        foci.zip(&self.multipliers).map(|(focus, y)| {
            let slope = y + self.weight * focus.part;
            (focus, slope)
        })
    }

    /// Updates the multipliers and w; returns the largest |v|.
    pub(super) fn learn(&mut self, stiffness: &Stiffness, field: [&[f32]; 2]) -> f64 {
        let off: Vec<f64> = self.off(stiffness, field).map(|focus| focus.part).collect();
        self.multipliers.iter_mut().zip(&off).for_each(|(y, off)| *y += self.weight * off);
        let most = off.iter().fold(0.0, |most: f64, off| most.max(off.abs()));
        self.weight *= if most < self.last { 1.0 } else { HEAVIER };
        self.last = most;
        most
    }
}
