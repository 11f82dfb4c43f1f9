//! Amplitude limit: |q| above 1 brought back by clamp, normalize or full.

use num_complex::Complex32;

use crate::math::sqrtf;
use crate::scene::words;

/// How a drive that may exceed |q| = 1 is brought back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::exhaustive_enums, reason = "the three ways that the field uses")]
pub enum AmplitudeLimit {
    /// |q| above 1 becomes 1, the rest stays.
    Clamp,
    /// All are divided by the largest |q|.
    Normalize,
    /// Every |q| becomes 1; 0 stays 0.
    Full,
}

words!(AmplitudeLimit: "clamp" = Self::Clamp, "normalize" = Self::Normalize, "full" = Self::Full);

impl AmplitudeLimit {
    /// Applies it.
    pub fn apply(self, drive: &mut [Complex32]) {
        let largest = drive.iter().fold(0.0, |most: f32, q| most.max(q.re.abs()).max(q.im.abs()));
        if largest == 0.0 {
            return;
        }
        // By the largest component first: its square neither over- nor underflows.
        let modulus = |q: Complex32, unit: f32| {
            let q = q / unit;
            sqrtf(q.re * q.re + q.im * q.im)
        };
        let greatest = drive.iter().fold(0.0, |most: f32, q| most.max(modulus(*q, largest)));
        for q in drive {
            let own = q.re.abs().max(q.im.abs());
            if own == 0.0 {
                continue;
            }
            let full = *q / own / modulus(*q, own);
            *q = match self {
                Self::Clamp if own < 0.5 || own * modulus(*q, own) <= 1.0 => *q,
                Self::Clamp | Self::Full => full,
                Self::Normalize => *q / largest / greatest,
            };
        }
    }
}
