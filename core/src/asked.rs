//! What is asked for: the caller's side of a problem.

use alloc::format;
use alloc::vec::Vec;

use crate::error::Error;
use crate::gains::Gains;
use crate::math;
use crate::metrics::Metrics;
use crate::scene::Request;

/// Targets outside these many reference pressures are a slip of the unit, and near the ends of f32.
const MOST_TARGET: f64 = 1e15;
const LEAST_TARGET: f64 = 1e-30;

/// The caller's side of a problem, over all points, in Pa.
#[derive(Debug)]
pub(crate) struct Asked {
    /// The gains of all points.
    pub(crate) gains: Gains,
    /// Targets (M,).
    pub(crate) targets: Vec<f64>,
    /// Weights (M,).
    pub(crate) weights: Vec<f64>,
    /// Weights of the points of weight above 0, the largest 1, padded with zeros.
    pub(crate) shares: Vec<f32>,
    /// The points of weight above 0.
    pub(crate) active: Vec<usize>,
    /// Whether the caller gave pressures.
    pub(crate) given: bool,
    /// Factor that brings the targets to the balanced level.
    pub(crate) balance: f64,
    /// The first point asked for more than its own reach, and that reach in Pa.
    pub(crate) overasked: Option<(usize, f64)>,
    /// p1_j of the points of weight above 0 in units of the reference, and memory for summing it.
    reach: Vec<f64>,
    sums: Vec<f32>,
}

impl Asked {
    /// Nothing yet asked of these gains.
    pub(crate) fn of(gains: Gains) -> Self {
        Self {
            gains,
            targets: Vec::new(),
            weights: Vec::new(),
            shares: Vec::new(),
            active: Vec::new(),
            given: false,
            balance: 1.0,
            overasked: None,
            reach: Vec::new(),
            sums: Vec::new(),
        }
    }

    /// Finds the points of weight above 0, and their gains unless they are all.
    pub(crate) fn select(&mut self, request: &Request) -> Result<Option<Gains>, Error> {
        request.check(self.gains.points())?;
        self.active.clear();
        self.active.extend((0..self.gains.points()).filter(|&j| request.weight(j) > 0.0));
        Ok((self.active.len() < self.gains.points()).then(|| self.gains.select(&self.active)))
    }

    /// Takes a request up; `selected` are the gains of the points of weight above 0, unless those are all. Nothing is
    /// allocated the second time.
    pub(crate) fn fill(&mut self, selected: Option<&Gains>, request: &Request) -> Result<(), Error> {
        request.check(self.gains.points())?;
        if selected.is_none() {
            self.active.clear();
            self.active.extend(0..self.gains.points());
        }
        let gains = selected.unwrap_or(&self.gains);
        gains.reach(&mut self.reach, &mut self.sums).map_err(|error| match error {
            // The selection renumbered the points.
            Error::TooNear { point, transducer, distance, least } => {
                Error::TooNear { point: self.active[point], transducer, distance, least }
            }
            other => other,
        })?;
        let reference = self.gains.reference();
        self.given = request.pressures.is_some();
        self.overasked = None;
        let within = LEAST_TARGET..=MOST_TARGET;
        for (&j, &reach) in self.active.iter().zip(&self.reach) {
            let target = request.pressure(j);
            if target > 0.0 && reach == 0.0 {
                return Err(Error::Unreached { point: j });
            }
            if self.given && target > 0.0 && !within.contains(&(target / reference)) {
                let cure = "no array comes near it: give the pressure in Pa, or 0 for a quiet point";
                return Err(Error::invalid(format!("points[{j}].pressure"), format!("{target:e}"), cure));
            }
            // f32 sums: within 1e-4 of the reach nobody can tell.
            if self.given && target > (1.0 + 1e-4) * reach * reference {
                self.overasked = self.overasked.or(Some((j, reach * reference)));
            }
        }
        // Loads relative to the heaviest, so that no square over- or underflows.
        let pairs = self.active.iter().zip(&self.reach);
        let loads =
            pairs.map(|(&j, &reach)| request.pressure(j) / (reach * reference)).filter(|load| *load > 0.0);
        let load = loads.clone().fold(0.0, f64::max);
        let balance = 1.0 / (load * math::sqrt(loads.map(|own| (own / load) * (own / load)).sum()));
        let scale = if self.given { 1.0 } else { balance };
        self.balance = if self.given { balance } else { 1.0 };
        let all = 0..self.gains.points();
        self.targets.clear();
        self.targets.extend(all.clone().map(|j| request.pressure(j) * scale));
        self.weights.clear();
        self.weights.extend(all.map(|j| request.weight(j)));
        let heaviest = self.weights.iter().copied().fold(0.0, f64::max);
        self.shares.clear();
        self.shares.resize(gains.lanes(), 0.0);
        for (share, &j) in self.shares.iter_mut().zip(&self.active) {
            *share = (self.weights[j] / heaviest) as f32;
        }
        Ok(())
    }

    /// Targets of the points of weight above 0, times `factor`, in units of the reference.
    pub(crate) fn scaled_targets(&self, factor: f64, out: &mut [f32]) {
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
