//! Number of the binary interface: it increases when a program compiled with an older header would fail.

/// The binary interface that this header describes; midair_abi() of a compatible library returns the same number.
pub const MIDAIR_ABI: u32 = 1;
