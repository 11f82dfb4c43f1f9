//! Points of lines, circles and contours: evenly spaced, or at a distance along them; and points that move.

pub(crate) mod contour;
pub(crate) mod curve;
pub(crate) mod join;
pub(crate) mod modulation;
pub(crate) mod path;

pub use contour::{MOST, STEP, along, fitted};
pub use curve::Curve;
pub use modulation::Modulation;
pub use path::{FARTHEST, Moment, Path, PathFrames, Run};
