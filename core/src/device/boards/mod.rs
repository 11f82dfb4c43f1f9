//! The bytes of each board, one family a file, and the list of them.

mod autd3;
mod homies;
mod openmpd;
mod planes;
mod sonicsurface;
mod ultraino;

use crate::device::format::Format;

/// Every board.
pub(super) const FORMATS: [Format; 7] = [
    autd3::FORMAT,
    sonicsurface::FORMAT,
    openmpd::FORMAT,
    ultraino::MEGA64,
    ultraino::NANO16,
    ultraino::NANO,
    homies::FORMAT,
];
