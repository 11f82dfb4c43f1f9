//! Aim of a request: reach the target pressures ("target"), or the highest level that the array can make ("max").

use crate::scene::words;

/// Which level the methods `uniform` and `best` give the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// Reach the target pressures, and never exceed them.
    Target,
    /// The highest level that the array can make, with the targets' ratios unchanged.
    Max,
}

words!(Aim: "target" = Self::Target, "max" = Self::Max);
