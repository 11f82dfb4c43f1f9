//! Board: the serial line of the microcontroller board. Only this and the memory layout in `boards/` depend on the
//! board.

#[cfg(not(feature = "stm32f407"))]
mod mps2_an386;
#[cfg(feature = "stm32f407")]
mod stm32f407;

#[cfg(not(feature = "stm32f407"))]
pub use mps2_an386::Uart;
#[cfg(feature = "stm32f407")]
pub use stm32f407::Uart;
