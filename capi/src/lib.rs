//! The C binding of midair: arrays, sessions and boards as opaque handles; numbers in memory of the caller.
//!
//! Each function reads its arguments, calls the core once and returns the result; formulas are only in the core. cbindgen
//! generates `include/midair.h` from this crate; docs/c.md is the page for users.
#![allow(clippy::missing_safety_doc, reason = "the header says once for all functions what a caller owes")]
#![allow(unsafe_code, reason = "a C caller hands over addresses; each block says why it may follow them")]

pub mod abi;
pub mod answer;
pub mod array;
pub mod batch;
pub mod board;
pub mod memory;
pub mod motion;
mod option;
pub mod outcome;
pub mod session;
pub mod version;
