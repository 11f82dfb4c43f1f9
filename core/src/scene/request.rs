//! Request: targets (as pressures) and weights of the control points, and their refusals.

use alloc::format;
use alloc::vec::Vec;

use crate::error::{Error, one_each, real};

/// Pressures (M,) in Pa and weights (M,) of M points; each may be left out.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "a pair of lists, checked where it is used")]
pub struct Request {
    /// Peak pressures |p| in Pa; left out all are the balanced level. 0 asks for a quiet point.
    pub pressures: Option<Vec<f64>>,
    /// Weights of the points' terms in eq. (7); left out all are 1. A point of weight 0 takes no part.
    pub weights: Option<Vec<f64>>,
}

impl Request {
    /// Checks both lists against `points` points.
    ///
    /// # Errors
    /// No points; another length; a value that is negative or not finite; nothing asked for (every pressure 0
    /// or every weight 0).
    pub fn check(&self, points: usize) -> Result<(), Error> {
        if points == 0 {
            return Err(Error::invalid("points", "empty", "give at least one point"));
        }
        for (name, values) in [("pressures", &self.pressures), ("weights", &self.weights)] {
            let Some(values) = values else { continue };
            one_each(name, values.len(), "values", points, "points")?;
            // Named only when refused: this runs for every frame of a moving hand.
            let refused = |value: &f64| !(value.is_finite() && *value >= 0.0);
            if let Some(j) = values.iter().position(refused) {
                real(&format!("points[{j}].{}", name.trim_end_matches('s')), values[j], 0.0, false)?;
            }
        }
        if self.weights.as_ref().is_some_and(|weights| weights.iter().all(|&w| w == 0.0)) {
            return Err(Error::invalid("weights", "all 0", "give at least one point a weight above 0"));
        }
        let asked = |j: usize| self.pressure(j) > 0.0 && self.weight(j) > 0.0;
        if !(0..points).any(asked) {
            return Err(Error::invalid(
                "pressures",
                "all 0",
                "give at least one point (of weight above 0) a pressure above 0 Pa",
            ));
        }
        Ok(())
    }

    /// Pressure of point j, 1 where pressures are left out.
    pub(crate) fn pressure(&self, j: usize) -> f64 {
        self.pressures.as_ref().map_or(1.0, |pressures| pressures[j])
    }

    /// Weight of point j.
    pub(crate) fn weight(&self, j: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |weights| weights[j])
    }
}
