//! What a board can play; no sockets.

pub(crate) mod quantization;
