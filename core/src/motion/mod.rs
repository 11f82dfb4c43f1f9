//! Motion: drives of successive frames, in which the phase of a transducer changes by at most a bound.

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
