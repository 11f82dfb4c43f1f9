//! What a solver sees: gains, targets and weights of the points that take part, in units of the reference.

use alloc::format;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

use num_complex::{Complex32, Complex64};

use crate::error::Error;
use crate::gains::Gains;
use crate::math;
use crate::metrics::Metrics;
use crate::options::{OptionValue, Value, spell, word};
use crate::scene::{Request, Scene};

/// Targets outside these many reference pressures are a slip of the unit, and near the ends of f32.
const MOST_TARGET: f64 = 1e15;
const LEAST_TARGET: f64 = 1e-30;

/// Where an iterative method begins.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::exhaustive_enums, reason = "the two sides of p = G q")]
pub enum Start {
    /// A drive (N,), |q| <= 1.
    Drive(Vec<Complex32>),
    /// Phases (M,) in rad of the pressures at the points.
    Phases(Vec<f64>),
}

/// How loud `uniform` and `best` make the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::exhaustive_enums, reason = "the two levels of docs/conventions.md")]
pub enum Aim {
    /// As loud as asked, and no louder.
    Target,
    /// As loud as the array can make them, the ratios kept.
    Max,
}

const AIMS: [(&str, Aim); 2] = [("target", Aim::Target), ("max", Aim::Max)];

impl OptionValue for Aim {
    fn read(item: &str, value: &Value) -> Result<Self, Error> {
        word(item, value, &AIMS)
    }

    fn show(&self) -> Value {
        spell(*self, &AIMS)
    }
}

/// A checked problem: it can be solved.
///
/// Cloning is cheap but for the targets: all else is shared.
#[derive(Clone, Debug)]
pub struct Problem {
    gains: Gains,
    weights: Arc<[f32]>,
    asked: Arc<Asked>,
    start: Option<Arc<Start>>,
    aim: Option<Aim>,
    targets: Vec<f32>,
}

/// The caller's side of a problem, over all points, in Pa.
#[derive(Debug)]
pub(crate) struct Asked {
    /// The gains of all points.
    pub(crate) gains: Gains,
    /// Targets (M,).
    pub(crate) targets: Vec<f64>,
    /// Weights (M,).
    pub(crate) weights: Vec<f64>,
    /// The points of weight above 0.
    pub(crate) active: Vec<usize>,
    /// Whether the caller gave pressures.
    given: bool,
    /// Factor that brings the targets to the balanced level.
    balance: f64,
    /// The first point asked for more than its own reach, and that reach in Pa.
    overasked: Option<(usize, f64)>,
}

impl Problem {
    /// The problem of a scene.
    ///
    /// # Errors
    /// A point on a transducer, or one with a pressure above 0 that no transducer reaches.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        Self::with_gains(Gains::of(scene), scene.request())
    }

    /// The problem of a user's own gains.
    ///
    /// # Errors
    /// As [`Problem::new`] and [`Request::check`].
    pub fn with_gains(all: Gains, request: &Request) -> Result<Self, Error> {
        request.check(all.points())?;
        let active: Vec<usize> = (0..all.points()).filter(|&j| request.weight(j) > 0.0).collect();
        let gains = if active.len() == all.points() { all.clone() } else { all.select(&active) };
        let reach = gains.reach().map_err(|error| match error {
            // The selection renumbered the points.
            Error::TooNear { point, transducer, distance, least } => {
                Error::TooNear { point: active[point], transducer, distance, least }
            }
            other => other,
        })?;
        let reference = all.reference();
        // Loads relative to the heaviest, so that no square over- or underflows.
        let mut loads: Vec<f64> = Vec::with_capacity(active.len());
        let mut overasked = None;
        for (&j, &reach) in active.iter().zip(&reach) {
            let target = request.pressure(j);
            if target > 0.0 && reach == 0.0 {
                return Err(Error::Unreached { point: j });
            }
            let within = LEAST_TARGET..=MOST_TARGET;
            if request.pressures.is_some() && target > 0.0 && !within.contains(&(target / reference)) {
                let cure = "no array comes near it: give the pressure in Pa, or 0 for a quiet point";
                return Err(Error::invalid(format!("points[{j}].pressure"), format!("{target:e}"), cure));
            }
            if target > 0.0 {
                loads.push(target / (reach * reference));
            }
            // f32 sums: within 1e-4 of the reach nobody can tell.
            if request.pressures.is_some() && target > (1.0 + 1e-4) * reach * reference {
                overasked = overasked.or(Some((j, reach * reference)));
            }
        }
        let load = loads.iter().copied().fold(0.0, f64::max);
        let balance = 1.0 / (load * math::sqrt(loads.iter().map(|own| (own / load) * (own / load)).sum()));
        let given = request.pressures.is_some();
        let scale = if given { 1.0 } else { balance };
        let heaviest = active.iter().map(|&j| request.weight(j)).fold(0.0, f64::max);
        let lanes = gains.lanes();
        let mut weights = vec![0.0; lanes];
        for (weight, &j) in weights.iter_mut().zip(&active) {
            *weight = (request.weight(j) / heaviest) as f32;
        }
        let asked = Asked {
            targets: (0..all.points()).map(|j| request.pressure(j) * scale).collect(),
            weights: (0..all.points()).map(|j| request.weight(j)).collect(),
            balance: if given { balance } else { 1.0 },
            overasked,
            gains: all,
            active,
            given,
        };
        let mut problem = Self {
            gains,
            weights: weights.into(),
            asked: Arc::new(asked),
            start: None,
            aim: None,
            targets: Vec::new(),
        };
        problem.targets = vec![0.0; lanes];
        problem.asked.scaled_targets(1.0, &mut problem.targets);
        Ok(problem)
    }

    /// The same problem at `factor` times the caller's targets, in a buffer of [`Gains::lanes`] numbers.
    pub(crate) fn rescaled(&self, factor: f64, mut targets: Vec<f32>) -> Self {
        self.asked.scaled_targets(factor, &mut targets);
        Self {
            gains: self.gains.clone(),
            weights: Arc::clone(&self.weights),
            asked: self.asked(),
            start: self.start.clone(),
            aim: self.aim,
            targets,
        }
    }

    /// The same problem with a start for the methods that use one.
    ///
    /// # Errors
    /// A drive or phases of another length, a value that is not finite, |q| above 1 + 1e-6.
    pub fn with_start(mut self, start: Start) -> Result<Self, Error> {
        match &start {
            Start::Drive(drive) => check_drive(drive, self.gains.transducers())?,
            Start::Phases(phases) => {
                let count = self.asked.targets.len();
                if phases.len() != count {
                    let value = format!("{} phases", phases.len());
                    return Err(Error::invalid(
                        "start",
                        value,
                        format!("give one for each of the {count} points"),
                    ));
                }
                if let Some(j) = phases.iter().position(|phase| !phase.is_finite()) {
                    return Err(Error::invalid(format!("start[{j}]"), phases[j], "give finite numbers"));
                }
            }
        }
        self.start = Some(Arc::new(start));
        Ok(self)
    }

    /// The same problem with another aim for the methods that use one.
    #[must_use]
    pub fn with_aim(mut self, aim: Aim) -> Self {
        self.aim = Some(aim);
        self
    }

    /// How loud the points are to be: unless chosen, as loud as asked where pressures were given, else as loud as
    /// the array can make them.
    #[must_use]
    pub fn aim(&self) -> Aim {
        self.aim.unwrap_or(if self.asked.given { Aim::Target } else { Aim::Max })
    }

    /// The drive to start from, if one was given.
    #[must_use]
    pub fn start_drive(&self) -> Option<&[Complex32]> {
        match self.start.as_deref() {
            Some(Start::Drive(drive)) => Some(drive),
            _ => None,
        }
    }

    /// The point phases in rad to start from, if they were given: over the points of weight above 0.
    #[must_use]
    pub fn start_phases(&self) -> Option<impl Iterator<Item = f64> + '_> {
        match self.start.as_deref() {
            Some(Start::Phases(phases)) => Some(self.asked.active.iter().map(|&j| phases[j])),
            _ => None,
        }
    }

    pub(crate) fn into_targets(self) -> Vec<f32> {
        self.targets
    }

    pub(crate) fn asked(&self) -> Arc<Asked> {
        Arc::clone(&self.asked)
    }

    /// Rows of G over the points of weight above 0.
    #[must_use]
    pub fn gains(&self) -> &Gains {
        &self.gains
    }

    /// Targets |p_j| in units of the reference, padded with zeros.
    #[must_use]
    pub fn targets(&self) -> &[f32] {
        &self.targets
    }

    /// Weights, the largest 1, padded with zeros.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// Targets (M,) of all points in Pa, as the caller gave them or at the balanced level.
    #[must_use]
    pub fn pressures(&self) -> &[f64] {
        &self.asked.targets
    }

    /// Weights (M,) of all points, as the caller gave them.
    #[must_use]
    pub fn point_weights(&self) -> &[f64] {
        &self.asked.weights
    }

    /// The factor s that brings the targets to the balanced level: `sum_j (s target_j / p1_j)^2 = 1` with
    /// `p1_j = sum_i |G_ji|`. 1 where pressures were left out.
    #[must_use]
    pub fn balance(&self) -> f64 {
        self.asked.balance
    }

    /// Gains of all points.
    pub(crate) fn all_gains(&self) -> &Gains {
        &self.asked.gains
    }

    /// The points with a pressure and a weight above 0.
    pub(crate) fn heard(&self) -> Vec<usize> {
        self.asked.active.iter().copied().filter(|&j| self.asked.targets[j] > 0.0).collect()
    }

    /// The first point asked for more than its own reach, and that reach in Pa.
    pub(crate) fn overasked(&self) -> Option<(usize, f64)> {
        self.asked.overasked
    }

    /// Whether every given target is below half the balanced level: solved without balancing, greedy drives
    /// every transducer all the same and smears such foci (the paper's section V).
    #[must_use]
    pub fn is_weak(&self) -> bool {
        self.asked.given && self.asked.balance > 2.0
    }

    /// The residual of a field given by its moduli in units of the reference, against this problem's targets.
    #[must_use]
    pub fn residual(&self, moduli: &[f32]) -> f64 {
        let points = moduli.iter().zip(&self.targets).zip(self.weights.iter());
        Metrics::of(points.map(|((&p, &t), &w)| (f64::from(p), f64::from(t), f64::from(w)))).residual
    }

    /// The same of the pressures' real and imaginary parts.
    pub(crate) fn residual_of(&self, pressures: impl Iterator<Item = (f32, f32)> + Clone) -> f64 {
        let moduli = pressures.map(|(re, im)| math::hypot(f64::from(re), f64::from(im)));
        let asked = self.targets.iter().zip(self.weights.iter());
        Metrics::of(moduli.zip(asked).map(|(p, (&t, &w))| (p, f64::from(t), f64::from(w)))).residual
    }

    /// The metrics of a drive (N,) over the caller's points, wholly in double precision.
    ///
    /// # Errors
    /// A drive of another length, a value that is not finite, |q| above 1 + 1e-6.
    pub fn judge(&self, drive: &[Complex32]) -> Result<Metrics, Error> {
        let all = &self.asked.gains;
        check_drive(drive, all.transducers())?;
        let pressures: Vec<f64> = (0..all.points())
            .map(|j| {
                let sum: Complex64 = (0..drive.len())
                    .map(|i| {
                        let q = Complex64::new(f64::from(drive[i].re), f64::from(drive[i].im));
                        all.exact(j, i) * q
                    })
                    .sum();
                sum.norm()
            })
            .collect();
        Ok(self.asked.metrics(pressures.iter().copied()))
    }
}

impl Asked {
    fn scaled_targets(&self, factor: f64, out: &mut [f32]) {
        for (out, &j) in out.iter_mut().zip(&self.active) {
            *out = (self.targets[j] * factor / self.gains.reference()) as f32;
        }
        out[self.active.len()..].fill(0.0);
    }

    /// Metrics of pressures |p| (M,) in Pa.
    pub(crate) fn metrics(&self, pressures: impl Iterator<Item = f64> + Clone) -> Metrics {
        let asked = self.targets.iter().zip(&self.weights);
        Metrics::of(pressures.zip(asked).map(|(pressure, (&target, &weight))| (pressure, target, weight)))
    }
}

/// Refuses a drive that no array of `transducers` could be given.
pub(crate) fn check_drive(drive: &[Complex32], transducers: usize) -> Result<(), Error> {
    if drive.len() != transducers {
        let value = format!("{} values", drive.len());
        return Err(Error::invalid(
            "drive",
            value,
            format!("give one for each of the {transducers} transducers"),
        ));
    }
    for (i, q) in drive.iter().enumerate() {
        let modulus = math::hypot(f64::from(q.re), f64::from(q.im));
        if !modulus.is_finite() {
            return Err(Error::invalid(format!("drive[{i}]"), q, "give finite numbers"));
        }
        if modulus > 1.0 + 1e-6 {
            return Err(Error::invalid(format!("drive[{i}]"), q, "a drive's modulus is at most 1"));
        }
    }
    Ok(())
}
