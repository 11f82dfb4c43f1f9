//! Traps: the phases are turned until the softest trap is as stiff as possible, at rest and in motion.

pub(crate) mod between;
mod foci;
mod on_grid;
mod soft_minimum;
pub(crate) mod stiffest;
pub(crate) mod within;
