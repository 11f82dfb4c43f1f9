//! Flight: beads in the traps of a sequence, and the radiation that they fly in.

pub(crate) mod around;
pub(crate) mod course;
pub(crate) mod dynamics;
pub(crate) mod envelope;
pub(crate) mod fly;

pub use course::Course;
pub use envelope::Envelope;
pub use fly::{BeadStart, Flown};
