//! The bytes of each board, a family a file.

pub(super) mod autd3;
pub(super) mod homies;
pub(super) mod openmpd;
mod planes;
pub(super) mod sonicsurface;
pub(super) mod ultraino;
