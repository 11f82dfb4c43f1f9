//! Motion: drives of successive frames, in which the phase of a transducer changes by at most a bound; the motion of a skin.

pub(crate) mod ahead;
pub(crate) mod alternation;
pub(crate) mod course;
pub(crate) mod envelope;
pub(crate) mod even_out;
pub(crate) mod felt;
pub(crate) mod first;
pub(crate) mod flight;
pub(crate) mod fly;
pub(crate) mod frames;
pub(crate) mod sheet;
pub(crate) mod skin;
pub(crate) mod stiff;
pub(crate) mod track;

pub use ahead::{Ahead, ahead};
pub use course::Course;
pub use envelope::Envelope;
pub use felt::{Channel, HIGHEST, REACH, felt_width, strength};
pub use fly::{BeadStart, Flown};
pub use sheet::Sheet;
pub use skin::{Pushes, Skin, live_lines};
pub use stiff::stiffen;
pub use track::Ends;
