//! Judgement: computes the metrics of fields and drives for the targets of a problem.

use crate::prelude::*;
use crate::problem::Problem;
use crate::problem::array_request::ArrayRequest;
use crate::problem::metrics::Metrics;
use crate::problem::solution::Solution;
use crate::problem::status::Status;
use crate::propagation::field_of;
use crate::scene::words;
use crate::workspace::Workspace;

/// Quiet points are reported if their leak exceeds the allowed leak by this factor. A solver checks only some points
/// of a crowd of quiet points. Between the checked points, the leak is up to three times as large.
const LOUD: f64 = 4.0;

/// Targets count as missed from this relative error on.
pub(crate) const MISS: f64 = 0.01;

/// The precision in which metrics are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Single precision, the rows of the solvers: |p| is accurate to 1e-4 of the pressure of all transducers at a point.
    #[default]
    Single,
    /// Double precision: a hundred times as slow.
    Double,
}

words!(Precision: "single" = Self::Single, "double" = Self::Double);

impl Problem {
    /// Returns the relative error of a solution if it exceeds 1 %. Returns `None` if the method does not meet targets
    /// (`meets`), if targets were not given or are not the aim, or if the solve was stopped. Quiet points may leak the part
    /// `quiet` of the largest target.
    pub(crate) fn missed(&self, meets: bool, quiet: Option<f64>, solution: &Solution) -> Option<f64> {
        let requested = meets && self.holds_pressures() && solution.status != Status::Stopped;
        let miss = if requested { self.miss(solution, quiet.unwrap_or(0.0)) } else { 0.0 };
        (miss > MISS).then_some(miss)
    }

    /// Returns the leak at quiet points, see [`Problem::weighted_leak`], if it is much larger than the allowed part `quiet`.
    pub(crate) fn leaks(&self, quiet: f64, solution: &Solution) -> Option<f64> {
        let leak = self.weighted_leak(&solution.pressures);
        (solution.status != Status::Stopped && leak >= LOUD * quiet && leak > 0.0).then_some(leak)
    }

    /// Returns the relative error of a solution, sqrt(sum w (target - |p|)^2 / sum w target^2) over the points of weight above
    /// 0. At a quiet point only the leak above `quiet` times the largest target counts.
    pub(crate) fn miss(&self, solution: &Solution, quiet: f64) -> f64 {
        let ArrayRequest { active, pascals, weights, .. } = &*self.targets;
        // Pressures are divided by the largest target, so that no square of a finite number overflows.
        let largest = active.iter().fold(0.0, |most: f64, &j| most.max(pascals[j]));
        let heaviest = active.iter().fold(0.0, |most: f64, &j| most.max(weights[j]));
        let (mut miss, mut all) = (0.0, 0.0);
        for &j in active {
            let (weight, target) = (self.targets.counted(j) / heaviest, pascals[j] / largest);
            let gap = (math::modulus(solution.pressures[j]) / largest - target).abs();
            let gap = if target > 0.0 { gap } else { (gap - quiet).max(0.0) };
            miss += weight * gap * gap;
            all += weight * target * target;
        }
        if all > 0.0 { math::sqrt(miss / all) } else { 0.0 }
    }

    /// Returns the largest leak of a quiet point, times its weight over the largest weight of a target, relative to the loudest
    /// point with a target. `pressures` are those at all points of the caller.
    pub(crate) fn weighted_leak(&self, pressures: &[Complex32]) -> f64 {
        let ArrayRequest { active, pascals, weights, .. } = &*self.targets;
        let modulus = |j: &&usize| math::modulus(pressures[**j]);
        let quiet = active.iter().filter(|&&j| pascals[j] == 0.0);
        let targeted = active.iter().filter(|&&j| pascals[j] > 0.0);
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let leak = most(&mut quiet.map(|j| modulus(&j) * self.targets.counted(*j)));
        let heaviest = most(&mut targeted.clone().map(|j| weights[*j]));
        let loudest = most(&mut targeted.map(|j| modulus(&j)));
        if leak == 0.0 { 0.0 } else { leak / heaviest / loudest }
    }

    /// Returns the residual of a field against this problem's targets. `moduli` are |p| in units of the reference.
    pub fn residual(&self, moduli: &[f32]) -> f64 {
        self.residual_of(moduli.iter().map(|&modulus| f64::from(modulus)))
    }

    /// Does the same as [`Problem::residual`] for moduli in double precision.
    pub(crate) fn residual_of(&self, moduli: impl Iterator<Item = f64> + Clone) -> f64 {
        let requested = self.scaled.iter().zip(self.weights());
        Metrics::of(moduli.zip(requested).map(|(p, (&t, &w))| (p, f64::from(t), f64::from(w)))).residual
    }

    /// Returns the metrics of a drive (N,) over the caller's points.
    ///
    /// # Errors
    /// A drive of another length, a value that is not finite, |q| above 1 + 1e-6, two different drives on one channel; a stop.
    pub fn judge(&self, drive: &[Complex32], precision: Precision, control: &mut Control) -> Result<Metrics, Error> {
        let drive = self.setup().columns(drive, self.propagation().transducers())?;
        match precision {
            Precision::Single => {
                let work = Workspace::new();
                let field = field_of(self.propagation(), &drive, &work, control)?;
                Ok(self.metrics_of(field.re.iter().zip(&field.im)))
            }
            Precision::Double => self.judge_exactly(&drive, control),
        }
    }

    /// Returns the metrics of a field at the points of weight above 0, in units of the reference.
    pub(crate) fn metrics_of<'a>(&self, field: impl Iterator<Item = (&'a f32, &'a f32)> + Clone) -> Metrics {
        let ArrayRequest { active, pascals, propagation, .. } = &*self.targets;
        let unit = propagation.reference();
        let point = |((&re, &im), &j): ((&f32, &f32), &usize)| {
            (math::modulus(Complex32::new(re, im)) * unit, pascals[j], self.targets.counted(j))
        };
        Metrics::of(field.zip(active).map(point))
    }

    /// Returns the metrics of a drive, one value for each column of the propagation matrix G, in double precision.
    fn judge_exactly(&self, drive: &[Complex32], control: &mut Control) -> Result<Metrics, Error> {
        let all = &self.targets.propagation;
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
