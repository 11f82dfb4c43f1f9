//! midair on a microcontroller: points in, bytes of a board out, nothing allocated between the first frame and the last.
//!
//! [`player`] and [`mute`] are the parts of a product; the rest is the machine under it, or measures it.
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
