//! midair on a microcontroller: it computes the bytes for a board from points, and allocates nothing after the first
//! frame.
//!
//! [`player`] and [`mute`] are parts that a product needs. The other modules support one microcontroller board, or measure
//! time and memory.
#![no_std]

extern crate alloc;

#[cfg(target_os = "none")]
pub mod board;
#[cfg(target_os = "none")]
pub mod clock;
#[cfg(target_os = "none")]
pub mod heap;
#[cfg(target_os = "none")]
pub mod measured;
pub mod mute;
pub mod player;
#[cfg(target_os = "none")]
pub mod stack;
