//! Soft minimum: a smooth function near the least of some values.
//!
//! ```text
//! E = -min x + 1/s ln sum_k e^{-s (x_k - min x)}             x_k in parts of a unit, s the sharpness
//! ```

use crate::math::{exp, log};

/// Returns E of the module's head, the negative soft minimum of some values.
pub(super) fn negated(values: impl Iterator<Item = f64> + Clone, sharpness: f64) -> f64 {
    let (least, sum) = shares(values, sharpness);
    log(sum) / sharpness - least
}

/// Returns the least value, and the sum of all e^{-s (x - min x)}; each term over the sum is the share of a value.
pub(super) fn shares(values: impl Iterator<Item = f64> + Clone, sharpness: f64) -> (f64, f64) {
    let least = values.clone().fold(f64::INFINITY, f64::min);
    (least, values.map(|x| exp(sharpness * (least - x))).sum())
}
