//! Touch: the motion of a skin under frames that repeat, and its felt strength.

pub(crate) mod bessel;
pub(crate) mod fourier;
pub(crate) mod membrane;
pub(crate) mod shifted;
pub(crate) mod skin;
pub(crate) mod thresholds;

pub use membrane::Membrane;
pub use shifted::Shifted;
pub use skin::{Pushes, Skin, Touch, hand, live_lines};
pub use thresholds::{Channel, HIGHEST, REACH, decibels, felt_width, strength};
