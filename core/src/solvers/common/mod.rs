//! Parts that several solvers share.

pub(crate) mod alternating_projection;
pub(crate) mod coordinate_descent;
pub(crate) mod cover;
pub(crate) mod gauss_newton;
pub(crate) mod interleaved_batch;
pub(crate) mod least_squares;
pub(crate) mod phase_descent;
pub(crate) mod quasi_newton;
pub(crate) mod refinement;
pub(crate) mod tiled;
