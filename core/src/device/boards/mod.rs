//! The bytes of each kind of board, one family in each file, and the list of all kinds.

mod autd3;
mod homies;
mod openmpd;
mod planes;
mod sonicsurface;
mod ultraino;

use crate::device::format::Format;

/// All kinds of boards.
pub(super) const FORMATS: [Format; 7] = [
    autd3::FORMAT,
    sonicsurface::FORMAT,
    openmpd::FORMAT,
    ultraino::MEGA64,
    ultraino::NANO16,
    ultraino::NANO,
    homies::FORMAT,
];
