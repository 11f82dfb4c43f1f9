//! Targets of guided fuzzing, each a function of bytes, and what they share: requests drawn from a fuzzer's bytes, and what
//! every answer must hold.

mod answer;
mod draw;
pub mod field;
pub mod frames;
pub mod instruction_sets;
pub mod positions;
pub mod scene;
pub mod session;
pub mod solve;
pub mod sweep;

pub use answer::{Allowed, one_line};
pub use draw::Draw;

/// A target's name, and what checks bytes.
pub type Target = (&'static str, fn(&[u8]));

/// Every target by its name.
pub const TARGETS: [Target; 8] = [
    ("scene", scene::check),
    ("positions", positions::check),
    ("sweep", sweep::check),
    ("solve", solve::check),
    ("field", field::check),
    ("session", session::check),
    ("instruction_sets", instruction_sets::check),
    ("frames", frames::check),
];
