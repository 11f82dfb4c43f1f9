//! Points of lines, circles and contours: evenly spaced along them, or after a way along one.

pub(crate) mod contour;
pub(crate) mod curve;

pub use contour::{MOST, STEP, along, fitted};
pub use curve::Curve;
