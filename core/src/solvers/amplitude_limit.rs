//! Amplitude limit: reduces drives above |q| = 1 by clamp, normalize or full.

use crate::kernels::{InstructionSet, limit};
use crate::scene::words;

/// The rule that limits a drive that may exceed |q| = 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AmplitudeLimit {
    /// Every |q| above 1 becomes 1; other drives stay.
    Clamp,
    /// All drives are divided by the largest |q|.
    Normalize,
    /// Every |q| becomes 1; 0 stays 0.
    Full,
}

words!(AmplitudeLimit: "clamp" = Self::Clamp, "normalize" = Self::Normalize, "full" = Self::Full);

impl AmplitudeLimit {
    /// Applies the limit to drives over the transducers: real and imaginary parts.
    pub(crate) fn apply(self, set: InstructionSet, drive: [&mut [f32]; 2]) {
        match self {
            Self::Clamp => limit::clamp(set, drive),
            Self::Normalize => limit::normalize(set, drive),
            Self::Full => limit::fill(set, drive),
        }
    }
}
