//! Aim: meet the targets ("target"), or as loud as the array can ("max").

use crate::scene::words;

/// The level that `uniform` and `best` give the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::exhaustive_enums, reason = "the two of docs/requests.md")]
pub enum Aim {
    /// Meet the targets, and never exceed them.
    Target,
    /// The highest level of the array, with the ratios kept.
    Max,
}

words!(Aim: "target" = Self::Target, "max" = Self::Max);
