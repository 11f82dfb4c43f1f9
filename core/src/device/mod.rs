//! Capabilities and bytes of boards; no sockets.

pub(crate) mod board;
mod boards;
pub(crate) mod channels;
pub(crate) mod code;
pub(crate) mod format;
pub(crate) mod link;
pub(crate) mod quantization;
