//! Touch: the motion of a skin under frames that repeat, its felt strength and push, and the sound that air makes of them.

pub(crate) mod audible;
pub(crate) mod bessel;
pub(crate) mod fourier;
pub(crate) mod membrane;
pub(crate) mod shifted;
pub(crate) mod skin;
pub(crate) mod thresholds;

pub use audible::demodulate;
pub use membrane::Membrane;
pub use shifted::Shifted;
pub use skin::{Pushes, Skin, Touch, hand, live_lines};
pub use thresholds::{Channel, GAIN, HIGHEST, REACH, decibels, felt_width, steady, strength};
