//! Number of the binary interface: raised by changes with which a program of an older header would fail.

/// The binary interface that this header describes; midair_abi() of a library that fits gives the same number.
pub const MIDAIR_ABI: u32 = 1;
