//! Sequences: drives of successive frames, in which the phase of a transducer changes by at most a bound.

pub(crate) mod ahead;
pub(crate) mod alternation;
pub(crate) mod even_out;
pub(crate) mod first;
pub(crate) mod frames;
pub(crate) mod horizon;
pub(crate) mod stiff;
pub(crate) mod track;

pub use ahead::{Ahead, ahead};
pub use horizon::{Horizon, Table, Tracks};
pub use stiff::stiffen;
pub use track::Ends;
