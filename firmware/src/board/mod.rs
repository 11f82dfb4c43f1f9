//! Board: the one thing of it that is used, a serial line. Beside its memory layout in `boards/` nothing else is its own.

#[cfg(not(feature = "stm32f407"))]
mod mps2_an386;
#[cfg(feature = "stm32f407")]
mod stm32f407;

#[cfg(not(feature = "stm32f407"))]
pub use mps2_an386::Uart;
#[cfg(feature = "stm32f407")]
pub use stm32f407::Uart;
