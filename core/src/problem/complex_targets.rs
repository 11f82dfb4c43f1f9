//! Complex targets: those of a problem that also requests phases.

use num_complex::Complex64;

use crate::math;
use crate::problem::Problem;
use crate::problem::array_request::ArrayRequest;

impl Problem {
    /// The phases of the targets in rad, where they have any: over the points of weight above 0.
    #[must_use]
    pub fn target_phases(&self) -> Option<impl Iterator<Item = f64> + '_> {
        let ArrayRequest { phases, active, .. } = &*self.targets;
        self.targets.phased().then(|| active.iter().map(|&j| phases[j]))
    }

    /// Targets as complex numbers in units of the reference, over the points of weight above 0: of phase 0 where their
    /// phases are free.
    pub(crate) fn complex_targets(&self) -> impl Iterator<Item = Complex64> + '_ {
        let ArrayRequest { phases, active, .. } = &*self.targets;
        let phasor = |j: usize| phases.get(j).map_or(Complex64::ONE, |&phase| math::phasor(phase));
        self.scaled.iter().zip(active).map(move |(&target, &j)| f64::from(target) * phasor(j))
    }

    /// Targets in Pa as complex numbers, over the points of weight above 0 and balanced if that was requested; `None` where
    /// their phases are free.
    #[must_use]
    pub fn complex_targets_in_pascals(&self) -> Option<impl Iterator<Item = Complex64> + '_> {
        let phases = self.target_phases()?;
        Some(self.active_targets_in_pascals().zip(phases).map(|(target, phase)| target * math::phasor(phase)))
    }
}
