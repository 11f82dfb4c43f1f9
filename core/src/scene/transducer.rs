//! Transducer: source pressure P0 and directivity D(theta).

use crate::scene::directivity::Directivity;

/// Properties that all transducers of an array share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transducer {
    /// P0 in Pa m: the peak pressure on the axis times the distance, at full drive.
    pub source_pressure: f64,
    /// The directivity D(theta).
    pub directivity: Directivity,
}

impl Default for Transducer {
    /// Returns a point source of 4.386 Pa m, the P0 of the AUTD3's transducer (in its software: 275.574 * 0.2 / 4 pi).
    fn default() -> Self {
        Self { source_pressure: 4.386, directivity: Directivity::POINT }
    }
}
