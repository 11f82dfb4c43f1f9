//! What is asked for: the caller's side of a problem.

use alloc::format;
use alloc::vec::Vec;

use crate::error::Error;
use crate::kernels::lanes::padded;
use crate::math;
use crate::problem::metrics::Metrics;
use crate::propagation::Propagation;
use crate::scene::Request;

/// Targets outside these many reference pressures are a slip of the unit, and near the ends of f32.
const MOST_TARGET: f64 = 1e15;
const LEAST_TARGET: f64 = 1e-30;

/// The caller's side of a problem, over all points, in Pa.
#[derive(Clone, Debug)]
pub(crate) struct Asked {
    /// The propagation of all points.
    pub(crate) propagation: Propagation,
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
}

impl Asked {
    /// Nothing yet asked of these propagation.
    pub(crate) fn of(propagation: Propagation) -> Self {
        Self {
            propagation,
            targets: Vec::new(),
            weights: Vec::new(),
            shares: Vec::new(),
            active: Vec::new(),
            given: false,
            balance: 1.0,
            overasked: None,
        }
    }

    /// Takes a request up, checked, and finds the points of weight above 0: their propagation, unless they are all. Nothing
    /// but those is allocated the second time.
    pub(crate) fn take(&mut self, request: &Request) -> Result<Option<Propagation>, Error> {
        let all = 0..self.propagation.points();
        request.check(all.end)?;
        self.given = request.pressures.is_some();
        self.targets.clear();
        self.targets.extend(all.clone().map(|j| request.pressure(j)));
        self.weights.clear();
        self.weights.extend(all.clone().map(|j| request.weight(j)));
        self.active.clear();
        self.active.extend(all.clone().filter(|&j| self.weights[j] > 0.0));
        let heaviest = self.weights.iter().copied().fold(0.0, f64::max);
        self.shares.clear();
        self.shares.resize(padded(self.active.len()), 0.0);
        for (share, &j) in self.shares.iter_mut().zip(&self.active) {
            *share = (self.weights[j] / heaviest) as f32;
        }
        Ok((self.active.len() < all.end).then(|| self.propagation.select(&self.active)))
    }

    /// Holds the request to the reach, p1_j of the points of weight above 0 in units of the reference: a balanced level,
    /// and targets at it where none were given.
    pub(crate) fn level(&mut self, reach: &[f64]) -> Result<(), Error> {
        let reference = self.propagation.reference();
        self.overasked = None;
        let within = LEAST_TARGET..=MOST_TARGET;
        for (&j, &reach) in self.active.iter().zip(reach) {
            let target = self.targets[j];
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
        let pairs = self.active.iter().zip(reach);
        let loads =
            pairs.map(|(&j, &reach)| self.targets[j] / (reach * reference)).filter(|load| *load > 0.0);
        let load = loads.clone().fold(0.0, f64::max);
        self.balance = 1.0 / (load * math::sqrt(loads.map(|own| (own / load) * (own / load)).sum()));
        if !self.given {
            self.targets.iter_mut().for_each(|target| *target *= self.balance);
            self.balance = 1.0;
        }
        Ok(())
    }

    /// Targets of the points of weight above 0, times `factor`, in units of the reference.
    pub(crate) fn scaled_targets(&self, factor: f64, out: &mut [f32]) {
        for (out, &j) in out.iter_mut().zip(&self.active) {
            *out = (self.targets[j] * factor / self.propagation.reference()) as f32;
        }
        out[self.active.len()..].fill(0.0);
    }

    /// Metrics of pressures |p| (M,) in Pa.
    pub(crate) fn metrics(&self, pressures: impl Iterator<Item = f64> + Clone) -> Metrics {
        let asked = self.targets.iter().zip(&self.weights);
        Metrics::of(pressures.zip(asked).map(|(pressure, (&target, &weight))| (pressure, target, weight)))
    }
}
