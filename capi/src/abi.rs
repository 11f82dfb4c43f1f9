//! Number of the binary interface: raised when a program built with an older header could not be run any more.

/// The binary interface that this header describes; midair_abi() of a library that fits gives the same number.
pub const MIDAIR_ABI: u32 = 1;
