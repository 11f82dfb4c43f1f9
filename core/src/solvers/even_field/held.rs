//! Held: foci beside traps, which keep their pressures while the traps are made stiff.
//!
//! ```text
//! v_j = (|P_j| - p_j)/p_j                                    of a quiet point over the largest pressure
//! E = sum_j y_j v_j + w/2 v_j^2                              y_j += w v_j after each stage
//! ```
//!
//! (Augmented Lagrangian, Nocedal and Wright 2006, chapter 17.3: without the multipliers y the traps would pull each
//! pressure off by their slope over w.)

use alloc::vec;
use alloc::vec::Vec;

use crate::math;
use crate::problem::Problem;
use crate::propagation::stiffness::Stiffness;

/// w: a focus that is off by 2 % costs as much as two hundredths of the softest trap.
const WEIGHT: f64 = 100.0;

/// The pressures that foci keep, in the order of [`Stiffness::foci`].
#[derive(Clone)]
pub(super) struct Held {
    /// p_j in units of the reference, and what |P_j| - p_j is divided by.
    targets: Vec<[f64; 2]>,
    multipliers: Vec<f64>,
}

/// By how much a focus is off, v, and its slope by Re P and Im P.
pub(super) struct Off {
    /// The point in the order of C.
    pub(super) row: usize,
    pub(super) part: f64,
    pub(super) slope: [f64; 2],
}

impl Held {
    /// The foci beside traps, at `level` times their targets.
    pub(super) fn of(traps: &Stiffness, problem: &Problem, level: f64) -> Self {
        let foci = traps.chosen()[1].iter().map(|&j| level * f64::from(problem.targets()[j]));
        let largest = foci.clone().fold(0.0, f64::max);
        let targets: Vec<_> = foci.map(|target| [target, if target > 0.0 { target } else { largest }]).collect();
        Self { multipliers: vec![0.0; targets.len()], targets }
    }

    /// The foci of a field.
    pub(super) fn off(&self, stiffness: &Stiffness, field: [&[f32]; 2]) -> impl Iterator<Item = Off> {
        stiffness.foci(field).zip(&self.targets).map(|((row, [re, im]), [target, unit])| {
            let modulus = math::hypot(re, im).max(f64::MIN_POSITIVE);
            Off { row, part: (modulus - target) / unit, slope: [re, im].map(|part| part / (modulus * unit)) }
        })
    }

    /// E of the v of all foci.
    pub(super) fn cost(&self, off: impl Iterator<Item = f64>) -> f64 {
        off.zip(&self.multipliers).map(|(off, y)| (y + WEIGHT / 2.0 * off) * off).sum()
    }

    /// Each focus and dE/dv.
    pub(super) fn pulled(&self, foci: impl Iterator<Item = Off>) -> impl Iterator<Item = (Off, f64)> {
        foci.zip(&self.multipliers).map(|(focus, y)| {
            let slope = y + WEIGHT * focus.part;
            (focus, slope)
        })
    }

    /// Follows the multipliers; the largest |v|.
    pub(super) fn learn(&mut self, stiffness: &Stiffness, field: [&[f32]; 2]) -> f64 {
        let off: Vec<f64> = self.off(stiffness, field).map(|focus| focus.part).collect();
        self.multipliers.iter_mut().zip(&off).for_each(|(y, off)| *y += WEIGHT * off);
        off.iter().fold(0.0, |most, off| most.max(off.abs()))
    }
}
