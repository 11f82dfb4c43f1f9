//! Judgement: what fields and drives come to, by what a problem asks for.

use alloc::vec;

use num_complex::{Complex32, Complex64};

use crate::control::Control;
use crate::error::Error;
use crate::math;
use crate::problem::Problem;
use crate::problem::array_request::ArrayRequest;
use crate::problem::metrics::Metrics;
use crate::scene::check_drive;

impl Problem {
    /// The most that a quiet point leaks, times its weight over the targets' largest, relative to the loudest targeted one;
    /// `pressures` are those of the caller's points.
    pub(crate) fn weighted_leak(&self, pressures: &[Complex32]) -> f64 {
        let ArrayRequest { active, pascals, weights, .. } = &*self.targets;
        let modulus = |j: &&usize| math::modulus(pressures[**j]);
        let quiet = active.iter().filter(|&&j| pascals[j] == 0.0);
        let targeted = active.iter().filter(|&&j| pascals[j] > 0.0);
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let leak = most(&mut quiet.map(|j| modulus(&j) * weights[*j]));
        let heaviest = most(&mut targeted.clone().map(|j| weights[*j]));
        let loudest = most(&mut targeted.map(|j| modulus(&j)));
        if leak == 0.0 { 0.0 } else { leak / heaviest / loudest }
    }

    /// The residual of a field given by its moduli in units of the reference, against this problem's targets.
    #[must_use]
    pub fn residual(&self, moduli: &[f32]) -> f64 {
        self.residual_of(moduli.iter().map(|&modulus| f64::from(modulus)))
    }

    /// The same of moduli in double precision.
    pub(crate) fn residual_of(&self, moduli: impl Iterator<Item = f64> + Clone) -> f64 {
        let asked = self.scaled.iter().zip(self.weights());
        Metrics::of(moduli.zip(asked).map(|(p, (&t, &w))| (p, f64::from(t), f64::from(w)))).residual
    }

    /// The metrics of a drive (N,) over the caller's points, wholly in double precision.
    ///
    /// # Errors
    /// A drive of another length, a value that is not finite, |q| above 1 + 1e-6; a stop.
    pub fn judge(&self, drive: &[Complex32], control: &mut Control) -> Result<Metrics, Error> {
        let all = &self.targets.propagation;
        check_drive(drive, all.transducers())?;
        let wide = |q: Complex32| Complex64::new(f64::from(q.re), f64::from(q.im));
        let mut pressures = vec![0.0; all.points()];
        for (j, pressure) in pressures.iter_mut().enumerate() {
            let mut sum = Complex64::ZERO;
            for (i, &q) in drive.iter().enumerate() {
                control.pulse()?;
                sum += all.exact(j, i) * wide(q);
            }
            *pressure = sum.norm();
        }
        Ok(self.targets.metrics(pressures.iter().copied()))
    }
}
