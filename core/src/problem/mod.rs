//! What a solver sees: propagation, targets and weights of the points that take part, in units of the reference.

pub(crate) mod feasibility;
pub(crate) mod metrics;
pub(crate) mod solution;
pub(crate) mod targets;
pub(crate) mod upper_bound;

use alloc::format;
use alloc::sync::Arc;
use alloc::vec::Vec;

use num_complex::{Complex32, Complex64};

use crate::error::Error;
use crate::math;
use crate::problem::metrics::Metrics;
use crate::problem::targets::Asked;
use crate::propagation::Propagation;
use crate::scene::{Request, Scene};
use crate::solvers::options::{OptionValue, Value, spell, word};

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
#[allow(clippy::exhaustive_enums, reason = "the two quantization of docs/conventions.md")]
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
    /// The propagation of the points of weight above 0, unless those are all.
    selected: Option<Propagation>,
    asked: Arc<Asked>,
    start: Option<Arc<Start>>,
    aim: Option<Aim>,
    targets: Vec<f32>,
    /// p1_j of the points of weight above 0 in units of the reference, and memory for summing it.
    reach: Vec<f64>,
    sums: Vec<f32>,
}

impl Problem {
    /// The problem of a scene.
    ///
    /// # Errors
    /// A point on a transducer, or one with a pressure above 0 that no transducer reaches.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        Self::with_propagation(Propagation::of(scene), scene.request())
    }

    /// The problem of a user's own propagation.
    ///
    /// # Errors
    /// As [`Problem::new`] and [`Request::check`].
    pub fn with_propagation(all: Propagation, request: &Request) -> Result<Self, Error> {
        let mut problem = Self::of(all);
        problem.selected = Arc::make_mut(&mut problem.asked).take(request)?;
        problem.measured()
    }

    /// The problem of other points and requests with the same array, in the memory of this one: if no solution of it
    /// is left, the number of points is the same and all have a weight, nothing is allocated.
    ///
    /// # Errors
    /// As [`crate::Model::propagation`] and [`Problem::with_propagation`]; the problem is then lost.
    pub fn renewed(mut self, points: &[[f64; 3]], request: &Request) -> Result<Self, Error> {
        self.place(points, request)?;
        self.measured()
    }

    /// A problem of which nothing is asked yet.
    pub(crate) fn of(propagation: Propagation) -> Self {
        Self {
            selected: None,
            asked: Arc::new(Asked::of(propagation)),
            start: None,
            aim: None,
            targets: Vec::new(),
            reach: Vec::new(),
            sums: Vec::new(),
        }
    }

    /// Takes other points and another request up: [`Problem::measure`] and [`Problem::level`] are still to come.
    pub(crate) fn place(&mut self, points: &[[f64; 3]], request: &Request) -> Result<(), Error> {
        let asked = Arc::make_mut(&mut self.asked);
        asked.propagation.carry(points)?;
        self.selected = asked.take(request)?;
        (self.start, self.aim) = (None, None);
        Ok(())
    }

    fn measured(mut self) -> Result<Self, Error> {
        self.measure()?;
        self.level()?;
        Ok(self)
    }

    /// Sums |G| at the points of weight above 0.
    pub(crate) fn measure(&mut self) -> Result<(), Error> {
        let propagation = self.selected.as_ref().unwrap_or(&self.asked.propagation);
        propagation.reach(&mut self.reach, &mut self.sums).map_err(|error| match error {
            // The selection renumbered the points.
            Error::TooNear { point, transducer, distance, least } => {
                Error::TooNear { point: self.asked.active[point], transducer, distance, least }
            }
            other => other,
        })
    }

    /// Where the sums of |G| are kept, set to 0.
    pub(crate) fn cleared_reach(&mut self) -> &mut Vec<f64> {
        self.reach.clear();
        self.reach.resize(self.propagation().points(), 0.0);
        &mut self.reach
    }

    /// Holds the request to what the array can do.
    pub(crate) fn level(&mut self) -> Result<(), Error> {
        Arc::make_mut(&mut self.asked).level(&self.reach)?;
        self.targets.clear();
        self.targets.resize(self.propagation().lanes(), 0.0);
        self.asked.scaled_targets(1.0, &mut self.targets);
        Ok(())
    }

    /// The same problem at `factor` times the caller's targets, in a buffer of [`Propagation::lanes`] numbers.
    pub(crate) fn rescaled(&self, factor: f64, mut targets: Vec<f32>) -> Self {
        self.asked.scaled_targets(factor, &mut targets);
        Self {
            selected: self.selected.clone(),
            asked: self.asked(),
            start: self.start.clone(),
            aim: self.aim,
            targets,
            reach: Vec::new(),
            sums: Vec::new(),
        }
    }

    /// The same problem with a start for the methods that use one.
    ///
    /// # Errors
    /// A drive or phases of another length, a value that is not finite, |q| above 1 + 1e-6.
    pub fn with_start(mut self, start: Start) -> Result<Self, Error> {
        self.begin(start)?;
        Ok(self)
    }

    /// As [`Problem::with_start`].
    pub(crate) fn begin(&mut self, start: Start) -> Result<(), Error> {
        match &start {
            Start::Drive(drive) => check_drive(drive, self.propagation().transducers())?,
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
        Ok(())
    }

    /// The same problem with another aim for the methods that use one.
    #[must_use]
    pub fn with_aim(mut self, aim: Aim) -> Self {
        self.aim = Some(aim);
        self
    }

    /// As [`Problem::with_aim`], or none.
    pub(crate) fn aim_at(&mut self, aim: Option<Aim>) {
        self.aim = aim;
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
    pub fn propagation(&self) -> &Propagation {
        self.selected.as_ref().unwrap_or(&self.asked.propagation)
    }

    /// Targets |p_j| in units of the reference, padded with zeros.
    #[must_use]
    pub fn targets(&self) -> &[f32] {
        &self.targets
    }

    /// Weights, the largest 1, padded with zeros.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.asked.shares
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

    /// Propagation of all points.
    pub(crate) fn all_propagation(&self) -> &Propagation {
        &self.asked.propagation
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
        let points = moduli.iter().zip(&self.targets).zip(self.asked.shares.iter());
        Metrics::of(points.map(|((&p, &t), &w)| (f64::from(p), f64::from(t), f64::from(w)))).residual
    }

    /// The same of the pressures' real and imaginary parts.
    pub(crate) fn residual_of(&self, pressures: impl Iterator<Item = (f32, f32)> + Clone) -> f64 {
        let moduli = pressures.map(|(re, im)| math::modulus(Complex32::new(re, im)));
        let asked = self.targets.iter().zip(self.asked.shares.iter());
        Metrics::of(moduli.zip(asked).map(|(p, (&t, &w))| (p, f64::from(t), f64::from(w)))).residual
    }

    /// The metrics of a drive (N,) over the caller's points, wholly in double precision.
    ///
    /// # Errors
    /// A drive of another length, a value that is not finite, |q| above 1 + 1e-6.
    pub fn judge(&self, drive: &[Complex32]) -> Result<Metrics, Error> {
        let all = &self.asked.propagation;
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
        let modulus = math::modulus(*q);
        if !modulus.is_finite() {
            return Err(Error::invalid(format!("drive[{i}]"), q, "give finite numbers"));
        }
        if modulus > 1.0 + 1e-6 {
            return Err(Error::invalid(format!("drive[{i}]"), q, "a drive's modulus is at most 1"));
        }
    }
    Ok(())
}
