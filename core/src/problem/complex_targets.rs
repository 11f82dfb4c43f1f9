//! Complex targets: the targets of a problem that requests pressures with phases.

use crate::prelude::*;
use crate::problem::Problem;
use crate::problem::array_request::ArrayRequest;

impl Problem {
    /// The phases in rad of the targets at the points of weight above 0; `None` if they are free.
    pub fn target_phases(&self) -> Option<impl Iterator<Item = f64> + '_> {
        let ArrayRequest { phases, active, .. } = &*self.targets;
        self.targets.phased().then(|| active.iter().map(|&j| phases[j]))
    }

    /// The complex targets at the points of weight above 0, in units of the reference; with phase 0 if their phases are free.
    pub(crate) fn complex_targets(&self) -> impl Iterator<Item = Complex64> + '_ {
        let ArrayRequest { phases, active, .. } = &*self.targets;
        let phasor = |j: usize| phases.get(j).map_or(Complex64::ONE, |&phase| math::phasor(phase));
        self.scaled.iter().zip(active).map(move |(&target, &j)| f64::from(target) * phasor(j))
    }

    /// The complex targets in Pa at the points of weight above 0, at the balanced level if that was requested; `None` if their
    /// phases are free.
    pub fn complex_targets_in_pascals(&self) -> Option<impl Iterator<Item = Complex64> + '_> {
        let phases = self.target_phases()?;
        Some(self.active_targets_in_pascals().zip(phases).map(|(target, phase)| target * math::phasor(phase)))
    }
}
