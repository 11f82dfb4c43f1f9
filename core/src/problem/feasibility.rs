//! Feasibility: the pressures that an array can reach at the points, and requests that are proven to exceed them.

use crate::prelude::*;
use crate::problem::Problem;
use crate::problem::upper_bound::{FEW_POINTS, rough_bound};
use crate::scene::Aim;

/// A request is reported as a mistake if the bound on its level is below this part of its targets. A request for the balanced
/// level of Suzuki et al. 2021, p1/sqrt(M), is not reported: it exceeds the true limit by 14 % on average, and by a quarter in
/// some scenes of few points.
const EVERYDAY: f64 = 0.75;

/// The pressures that an array can give at the points of a problem.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reach {
    /// The highest pressure at each point alone (M,) in Pa: `sum_i |G_ji|`.
    pub alone: Vec<f64>,
    /// The balanced level (M,) in Pa: about the pressures, in the ratios of the targets, that the array can give at all points
    /// together if they are at least a focal width apart. They are s target_j with `sum_j (s target_j/alone_j)^2 = 1`. At
    /// points that are closer together, higher pressures are possible.
    pub level: Vec<f64>,
}

/// The proof that no drive can fulfil a request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Beyond {
    /// A target exceeds the pressure of all transducers together at its point.
    Alone {
        /// Index of the point.
        point: usize,
        /// The target at this point in Pa.
        target: f64,
        /// The strongest pressure there in Pa.
        alone: f64,
    },
    /// No drive gives all targets at the same time.
    Together {
        /// The proven bound on min |p_j|/target_j over the points, see [`crate::bound()`].
        most: f64,
    },
}

impl fmt::Display for Beyond {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.notice().fmt(f)
    }
}

impl Beyond {
    /// Returns the parts of the warning.
    pub fn notice(&self) -> Notice {
        match self {
            Self::Alone { point, target, alone } => {
                let most = format!("{} Pa", pascals(*alone));
                let (item, value) =
                    (format!("points[{point}].pressure"), format!("{} Pa, beyond reach", pascals(*target)));
                let cure = format!("the array gives at most {most} there");
                Notice::new(ErrorCode::BeyondReach, item, value, cure).other(most)
            }
            Self::Together { most } => {
                let cure = format!("no drive gives more than {most:.2} of all of them at the same time");
                Notice::new(ErrorCode::BeyondTogether, "the pressures", "beyond reach", cure)
                    .verb("are")
                    .other(format_args!("{most:.2}"))
            }
        }
    }
}

/// Writes a pressure with about four digits.
fn pascals(pressure: f64) -> String {
    match pressure {
        1e3..1e9 => format!("{pressure:.0}"),
        1e-2..1e3 => format!("{pressure:.3}"),
        _ => format!("{pressure:.3e}"),
    }
}

impl Problem {
    /// Returns the pressures that the array can give at the points, computed in double precision.
    ///
    /// # Errors
    /// A stop by the caller.
    pub fn reach(&self, control: &mut Control) -> Result<Reach> {
        let propagation = &self.targets.propagation;
        let mut alone = vec![0.0; propagation.points()];
        for (j, alone) in alone.iter_mut().enumerate() {
            for i in 0..propagation.transducers() {
                control.pulse()?;
                *alone += propagation.exact(j, i).norm();
            }
        }
        // The target of a point of weight 0 is arbitrary, so the product may overflow.
        let level = |target: &f64| (self.balance() * target).min(f64::MAX);
        Ok(Reach { alone, level: self.targets_in_pascals().iter().map(level).collect() })
    }

    /// Returns a proof that the request is impossible, if there is one, for [`Aim::Target`]. Either a target exceeds
    /// the pressure of all transducers at its point, or no drive gives more than three quarters of all targets at
    /// once. For up to 64 points, the quick form of [`crate::bound()`] proves the latter. It detects targets of at
    /// least about 1.4 times the balanced level at a few points, and of 2 to 2.5 times at 64 points.
    ///
    /// # Errors
    /// A stop by the caller.
    pub fn beyond(&self, control: &mut Control) -> Result<Option<Beyond>> {
        if let Some(alone) = self.beyond_alone() {
            return Ok(Some(alone));
        }
        if !self.is_doubtful() || self.targeted().len() > FEW_POINTS {
            return Ok(None);
        }
        let most = rough_bound(self, control)?;
        Ok((most < EVERYDAY).then_some(Beyond::Together { most }))
    }

    /// Returns the first target that exceeds the pressure of all transducers at its point, for [`Aim::Target`]. It is already
    /// known when the problem is made.
    pub fn beyond_alone(&self) -> Option<Beyond> {
        let (point, alone) = self.targets.overasked.filter(|_| self.aim() == Aim::Target)?;
        Some(Beyond::Alone { point, target: self.targets_in_pascals()[point], alone })
    }

    /// Whether [`Problem::beyond`] must compute a bound, because the targets are so high that the points together may not reach
    /// them.
    pub fn is_doubtful(&self) -> bool {
        self.aim() == Aim::Target && self.balance() < EVERYDAY
    }
}
