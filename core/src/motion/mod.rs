//! Motion: drives of frames that follow one another, no transducer turning by more than it is allowed.

pub(crate) mod ahead;
pub(crate) mod alternation;
pub(crate) mod even_out;
pub(crate) mod first;
pub(crate) mod flight;
pub(crate) mod frames;
pub(crate) mod track;

pub use ahead::{Ahead, ahead};
pub use flight::{Flight, Force, State};
pub use track::Ends;
