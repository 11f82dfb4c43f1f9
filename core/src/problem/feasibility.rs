//! Feasibility: the reach of an array at the points, and requests provably beyond it.

use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

use crate::control::Control;
use crate::error::Error;
use crate::problem::Problem;
use crate::problem::upper_bound::{FEW_POINTS, rough_bound};
use crate::scene::Aim;

/// The paper's own p1/sqrt(M) is out of reach by 14 % in the mean and by a quarter in single scenes of few points. What is
/// proven to be further away is a slip.
const EVERYDAY: f64 = 0.75;

/// Capabilities of an array.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reach {
    /// The strongest pressure at each point alone (M,) in Pa: `sum_i |G_ji|`.
    pub alone: Vec<f64>,
    /// The pressures (M,) in Pa, in the ratios of the targets, that the array can make at all points together if they are
    /// a focal width apart: the balanced level, `sum_j (s target_j/alone_j)^2 = 1`. Closer points can have more.
    pub level: Vec<f64>,
}

/// A request that no drive can fulfil.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::exhaustive_enums, reason = "the two ways to ask for too much")]
pub enum Beyond {
    /// A target above the pressure of all transducers together at that point.
    Alone {
        /// Index of the point.
        point: usize,
        /// Its target in Pa.
        target: f64,
        /// The strongest pressure there in Pa.
        alone: f64,
    },
    /// Targets that no drive gives at the same time.
    Together {
        /// No drive reaches more than this part of every target, proven as [`crate::bound()`] proves it.
        most: f64,
    },
}

impl fmt::Display for Beyond {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Alone { point, target, alone } => write!(
                f,
                "points[{point}].pressure is {} Pa, beyond reach: the array gives at most {} Pa there",
                pascals(*target),
                pascals(*alone)
            ),
            Self::Together { most } => write!(
                f,
                "the pressures are beyond reach: no drive gives more than {most:.2} of all of them at the same time"
            ),
        }
    }
}

/// About four digits of a pressure, whatever its unit.
fn pascals(pressure: f64) -> String {
    match pressure {
        1e3..1e9 => format!("{pressure:.0}"),
        1e-2..1e3 => format!("{pressure:.3}"),
        _ => format!("{pressure:.3e}"),
    }
}

impl Problem {
    /// The pressures that the array can make at the points, in double precision.
    ///
    /// # Errors
    /// A stop.
    pub fn reach(&self, control: &mut Control) -> Result<Reach, Error> {
        let propagation = &self.targets.propagation;
        let mut alone = vec![0.0; propagation.points()];
        for (j, alone) in alone.iter_mut().enumerate() {
            for i in 0..propagation.transducers() {
                control.pulse()?;
                *alone += propagation.exact(j, i).norm();
            }
        }
        // A point of weight 0 may have any target.
        let level = |target: &f64| (self.balance() * target).min(f64::MAX);
        Ok(Reach { alone, level: self.targets_in_pascals().iter().map(level).collect() })
    }

    /// The provably impossible part of a request, for [`Aim::Target`]: a target above its point's own reach, or targets of which no
    /// drive gives more than three quarters at the same time, as the quick form of [`crate::bound()`] proves (up to 64 points; from
    /// about 1.4 times the balanced level on at a few points, from 2 to 2.5 times at 64).
    ///
    /// # Errors
    /// A stop.
    pub fn beyond(&self, control: &mut Control) -> Result<Option<Beyond>, Error> {
        if let Some(alone) = self.beyond_alone() {
            return Ok(Some(alone));
        }
        if !self.is_doubtful() || self.targeted().len() > FEW_POINTS {
            return Ok(None);
        }
        let most = rough_bound(self, control)?;
        Ok((most < EVERYDAY).then_some(Beyond::Together { most }))
    }

    /// The first target above its point's own reach, of [`Aim::Target`]: known as soon as the problem is, at no cost.
    #[must_use]
    pub fn beyond_alone(&self) -> Option<Beyond> {
        let (point, alone) = self.targets.overasked.filter(|_| self.aim() == Aim::Target)?;
        Some(Beyond::Alone { point, target: self.targets_in_pascals()[point], alone })
    }

    /// Largest ratio of a target to its point's own reach, for [`Aim::Target`]; 0 if no target is above it.
    #[must_use]
    pub fn excess(&self) -> f64 {
        if self.aim() == Aim::Target { self.targets.excess } else { 0.0 }
    }

    /// Whether [`Problem::beyond`] has to examine more than the reach of single points.
    #[must_use]
    pub fn is_doubtful(&self) -> bool {
        self.aim() == Aim::Target && self.balance() < EVERYDAY
    }
}
