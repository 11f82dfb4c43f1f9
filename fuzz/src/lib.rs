//! The targets of guided fuzzing, each a function of bytes. They share code that makes requests from bytes and that checks
//! solutions.

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

/// The name of a target, and its function.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
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
