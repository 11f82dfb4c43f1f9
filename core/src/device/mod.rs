//! Boards: the drives that they can play, and their bytes. Sockets and ports are elsewhere.

pub(crate) mod board;
mod boards;
pub(crate) mod channels;
pub(crate) mod format;
pub(crate) mod quantization;
