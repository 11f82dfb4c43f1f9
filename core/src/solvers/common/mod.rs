//! What several solvers share.

pub(crate) mod alternating_projection;
pub(crate) mod interleaved;
pub(crate) mod refinement;
