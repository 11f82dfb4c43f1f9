//! What the targets share: requests drawn from a fuzzer's bytes, and what every answer must hold.

mod answer;
mod draw;

pub use answer::{Allowed, one_line};
pub use draw::Draw;
