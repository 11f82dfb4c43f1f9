//! Board: the one thing of it that is used, a serial line. Beside its memory layout in `boards/` nothing else is its own.

mod mps2_an386;

pub use mps2_an386::Uart;
