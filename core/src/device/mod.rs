//! What a board can play.

pub(crate) mod quantization;
