//! Request: target pressures of the control points, with or without phases, and weights; starts; aims; and their checks.

use crate::prelude::*;
use crate::scene::words;

/// Requested pressures (M,) in Pa, their phases (M,) in rad and weights (M,) of M points; each list may be left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Peak pressures |p| in Pa; 0 stands for a quiet point. Left out, all points have the balanced level.
    pub pressures: Option<Vec<f64>>,
    /// Phases of the pressures in rad: the targets are `p_j e^{j phase_j}`. Left out, the phases are free.
    pub phases: Option<Vec<f64>>,
    /// Weights w_j of the points in the sum of squared errors, sum_j w_j (t_j - |p_j|)^2; left out, all are 1. A point of
    /// weight 0 is ignored.
    pub weights: Option<Vec<f64>>,
}

impl Request {
    /// Returns the request for complex pressures (M,) in Pa: their moduli and phases.
    ///
    /// ```
    /// use midair::{Complex64, Request};
    ///
    /// let request = Request::of_complex(&[Complex64::new(0.0, 500.0), Complex64::new(-300.0, 0.0)]);
    /// assert_eq!(request.pressures, Some(vec![500.0, 300.0]));
    /// assert_eq!(request.phases, Some(vec![std::f64::consts::FRAC_PI_2, std::f64::consts::PI]));
    /// ```
    pub fn of_complex(pressures: &[Complex64]) -> Self {
        // Sets the phase of a zero to 0: atan2 gives pi for -0.
        let phase = |p: &Complex64| if *p == Complex64::ZERO { 0.0 } else { math::atan2(p.im, p.re) };
        Self {
            pressures: Some(pressures.iter().map(|p| math::hypot(p.re, p.im)).collect()),
            phases: Some(pressures.iter().map(phase).collect()),
            weights: None,
        }
    }

    /// The complex pressures (M,) in Pa; `None` where pressures or phases are left out.
    pub fn complex_pressures(&self) -> Option<Vec<Complex64>> {
        let (pressures, phases) = (self.pressures.as_ref()?, self.phases.as_ref()?);
        Some(pressures.iter().zip(phases).map(|(&p, &phase)| p * math::phasor(phase)).collect())
    }

    /// Checks all lists for `points` points.
    ///
    /// # Errors
    /// No points; a list of another length; a value that is not finite, a negative pressure or weight; phases without
    /// pressures; nothing requested (every pressure 0 or every weight 0).
    pub fn check(&self, points: usize) -> Result<()> {
        refuse_if!(points == 0, Error::missing("points", "empty", "give at least one point"));
        for (name, values) in [("pressures", &self.pressures), ("weights", &self.weights)] {
            let Some(values) = values else { continue };
            one_each(name, values.len(), "values", points, "points")?;
            // The name is made only for an error: this check runs for every frame of a tracked hand.
            let refused = |value: &f64| !(value.is_finite() && *value >= 0.0);
            if let Some(j) = values.iter().position(refused) {
                real(&format!("points[{j}].{}", name.trim_end_matches('s')), values[j], 0.0, false)?;
            }
        }
        if let Some(phases) = &self.phases {
            one_each("phases", phases.len(), "values", points, "points")?;
            if self.pressures.is_none() {
                let cure = "give every point a pressure, or leave the phases out";
                return Err(Error::invalid("points[0].phase", "given without a pressure", cure));
            }
            if let Some(j) = phases.iter().position(|phase| !phase.is_finite()) {
                return Err(Error::invalid(format!("points[{j}].phase"), phases[j], "give finite numbers, in rad"));
            }
        }
        if self.weights.as_ref().is_some_and(|weights| weights.iter().all(|&w| w == 0.0)) {
            return Err(Error::new(ErrorCode::Silent, "weights", "all 0", "give at least one point a weight above 0"));
        }
        let requested = |j: usize| self.pressure(j) > 0.0 && self.weight(j) > 0.0;
        if !(0..points).any(requested) {
            let cure = "give at least one point (of weight above 0) a pressure above 0 Pa";
            return Err(Error::new(ErrorCode::Silent, "pressures", "all 0", cure));
        }
        Ok(())
    }

    /// The pressure of point j in Pa, 1 where pressures are left out.
    pub(crate) fn pressure(&self, j: usize) -> f64 {
        self.pressures.as_ref().map_or(1.0, |pressures| pressures[j])
    }

    /// The weight of point j.
    pub(crate) fn weight(&self, j: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |weights| weights[j])
    }
}

/// Which level the methods `uniform` and `best` give the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// Reach the target pressures, and never exceed them.
    Target,
    /// The highest level that the array can make, with the targets' ratios unchanged.
    Max,
}

words!(Aim: "target" = Self::Target, "max" = Self::Max);

/// Where an iterative method begins.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// A drive (N,), |q| <= 1.
    Drive(Vec<Complex32>),
    /// Phases (M,) in rad of the pressures at the points.
    Phases(Vec<f64>),
}

/// Checks that a drive has one finite value of modulus at most 1 for each transducer.
pub(crate) fn check_drive(drive: &[Complex32], transducers: usize) -> Result<()> {
    one_each("drive", drive.len(), "values", transducers, "transducers")?;
    for (i, q) in drive.iter().enumerate() {
        let modulus = math::modulus(*q);
        refuse_if!(!modulus.is_finite(), Error::not_finite(format!("drive[{i}]"), q));
        if modulus > 1.0 + 1e-6 {
            let cure = "a drive's modulus is at most 1; divide all by the largest, or each above 1 by its own";
            return Err(Error::out_of_range(format!("drive[{i}]"), q, cure));
        }
    }
    Ok(())
}
