//! Transducer: source pressure P0 and directivity D(theta).

use crate::scene::directivity::Directivity;

/// Properties that all transducers of an array share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transducer {
    /// P0 in Pa m: on-axis pressure (peak) times distance at full drive.
    pub source_pressure: f64,
    /// D(theta).
    pub directivity: Directivity,
}

impl Default for Transducer {
    /// 4.386 Pa m, the AUTD3's transducer (its software: 275.574 * 0.2 / 4 pi), as a point source.
    fn default() -> Self {
        Self { source_pressure: 4.386, directivity: Directivity::POINT }
    }
}
