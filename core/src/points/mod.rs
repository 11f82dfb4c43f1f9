//! Points of lines, circles and contours, evenly spaced along them.

pub(crate) mod contour;
pub(crate) mod figure;

pub use contour::{MOST, STEP, along, fitted};
pub use figure::{circle, line, polyline};
