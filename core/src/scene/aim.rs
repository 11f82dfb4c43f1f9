//! Aim: as loud as asked ("target"), or as loud as the array can make it ("max").

use crate::error::Error;
use crate::scene::value::{OptionValue, Value, spell, word};

/// How loud `uniform` and `best` make the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::exhaustive_enums, reason = "the two quantization of docs/conventions.md")]
pub enum Aim {
    /// As loud as asked, and no louder.
    Target,
    /// As loud as the array can make them, the ratios kept.
    Max,
}

const AIMS: [(&str, Aim); 2] = [("target", Aim::Target), ("max", Aim::Max)];

impl OptionValue for Aim {
    fn read(item: &str, value: &Value) -> Result<Self, Error> {
        word(item, value, &AIMS)
    }

    fn show(&self) -> Value {
        spell(*self, &AIMS)
    }
}
