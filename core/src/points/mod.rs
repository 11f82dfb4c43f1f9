//! Points of lines, circles and contours: evenly spaced, or at a distance along them.

pub(crate) mod contour;
pub(crate) mod curve;

pub use contour::{MOST, STEP, along, fitted};
pub use curve::Curve;
