//! Metrics: accuracy (eq. 12), sigma (eq. 13), uniformity, level, residual (eq. 7), leak.

use crate::prelude::*;

/// Passes the name and the description of each metric to a macro, so that all bindings have the same texts.
#[doc(hidden)]
#[macro_export]
macro_rules! metrics {
    ($define:ident) => {
        $define! {
            /// sum |p_j| / sum target_j, unclipped: eq. (12).
            accuracy
            /// Standard deviation (1/M) of x / max x: eq. (13) for equal targets. 0 for one point or silence.
            sigma
            /// min x / max x; 1 for one point, 0 in silence.
            uniformity
            /// Mean x.
            level
            /// sum w (target - |p|)^2 / sum w target^2: eq. (7) relative to silence.
            residual
            /// max |p_j| over the quiet points (target 0) over the largest target; 0 where there are none.
            leak
        }
    };
}

macro_rules! define {
    ($($(#[$text:meta])* $name:ident)*) => {
        /// Metrics over the points with a pressure and a weight above 0, x_j = |p_j| / target_j.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Metrics {
            $($(#[$text])* pub $name: f64,)*
        }

        impl Metrics {
            /// The names of the metrics.
            pub const NAMES: [&'static str; 6] = [$(stringify!($name)),*];

            /// The values, in the order of the names.
            pub fn values(self) -> [f64; 6] {
                [$(self.$name),*]
            }

            /// Returns metrics with these values, in the order of the names.
            pub fn from_values([$($name),*]: [f64; 6]) -> Self {
                Self { $($name),* }
            }
        }
    };
}
metrics!(define);

/// The metrics are computed in double precision without allocating memory; instead, the points are read more than
/// once.
///
/// Each item of `points` is (|p|, target, weight) in any one unit.
///
/// ```
/// let metrics = midair::Metrics::of([(0.9, 1.0, 1.0), (0.6, 1.0, 1.0)].into_iter());
/// assert!((metrics.accuracy - 0.75).abs() < 1e-12);
/// assert!((metrics.uniformity - 2.0 / 3.0).abs() < 1e-12);
/// ```
impl Metrics {
    /// Returns the metrics of some points.
    pub fn of(points: impl Iterator<Item = (f64, f64, f64)> + Clone) -> Self {
        let targeted = points.clone().filter(|&(_, target, weight)| target > 0.0 && weight > 0.0);
        let largest = targeted.clone().fold(0.0, |most: f64, (_, target, _)| most.max(target));
        let heaviest = targeted.clone().fold(0.0, |most: f64, (_, _, weight)| most.max(weight));
        let (mut count, mut reached, mut requested, mut level) = (0.0, 0.0, 0.0, 0.0);
        let (mut miss, mut all) = (0.0, 0.0);
        let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
        for (pressure, target, weight) in targeted.clone() {
            let x = pressure / target;
            // Pressures are divided by the largest target, so that no square of a finite number overflows.
            let (gap, target) = ((target - pressure) / largest, target / largest);
            count += 1.0;
            reached += pressure / largest;
            requested += target;
            level += x;
            miss += weight / heaviest * gap * gap;
            all += weight / heaviest * target * target;
            low = low.min(x);
            high = high.max(x);
        }
        if count == 0.0 {
            return Self::default();
        }
        let mean = level / count;
        let spread = |sum: f64, (pressure, target, _): (f64, f64, f64)| {
            let gap = (pressure / target - mean) / high;
            sum + gap * gap
        };
        let silent = high == 0.0;
        let quiet = points.filter(|&(_, target, weight)| target == 0.0 && weight > 0.0);
        Self {
            accuracy: reached / requested,
            sigma: if silent { 0.0 } else { math::sqrt(targeted.fold(0.0, spread) / count) },
            uniformity: if silent { 0.0 } else { low / high },
            level: mean,
            residual: miss / all,
            leak: quiet.fold(0.0, |most: f64, (pressure, _, _)| most.max(pressure)) / largest,
        }
    }
}
