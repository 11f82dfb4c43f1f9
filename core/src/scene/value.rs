//! Values: options as bindings pass them, and their conversion to Rust types.

use alloc::collections::BTreeMap;

use crate::prelude::*;

/// The value of an option, as a binding passes it.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// true or false.
    Bool(bool),
    /// An integer, wide enough for a seed of 64 bits and for negative numbers.
    Integer(i128),
    /// A real number.
    Real(f64),
    /// A word.
    Text(String),
    /// A list of integers.
    Integers(Vec<i64>),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bool(value) => write!(f, "{value}"),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Real(value) => write!(f, "{value}"),
            Self::Text(value) => write!(f, "\"{value}\""),
            Self::Integers(values) if values.len() <= 8 => write!(f, "{values:?}"),
            Self::Integers(values) => write!(f, "a list of {} integers", values.len()),
        }
    }
}

/// Options by name.
pub type Options = BTreeMap<String, Value>;

/// A Rust type that an option can have.
pub trait OptionValue: Sized {
    /// The words that the option takes; empty if it takes none.
    const WORDS: &'static [&'static str] = &[];
    /// Whether the option takes a list of integers.
    const LIST: bool = false;
    /// Reads the value that a binding passes; `item` names the option in the error.
    ///
    /// # Errors
    /// A value of another kind or out of range.
    fn read(item: &str, value: &Value) -> Result<Self>;
    /// The option's value as a [`Value`].
    fn show(&self) -> Value;
}

/// Returns the value as an integer of type `T`; `None` if it is not an integer or out of range.
fn integer<T: TryFrom<i128>>(value: &Value) -> Option<T> {
    if let Value::Integer(number) = value { T::try_from(*number).ok() } else { None }
}

impl OptionValue for u64 {
    fn read(item: &str, value: &Value) -> Result<Self> {
        integer(value).ok_or_else(|| Error::wrong_type(item, value, "give a whole number from 0 to 2^64 - 1"))
    }

    fn show(&self) -> Value {
        Value::Integer(i128::from(*self))
    }
}

impl OptionValue for u32 {
    fn read(item: &str, value: &Value) -> Result<Self> {
        integer(value).ok_or_else(|| Error::wrong_type(item, value, "give a whole number, 0 or above"))
    }

    fn show(&self) -> Value {
        Value::Integer(i128::from(*self))
    }
}

impl OptionValue for f64 {
    fn read(item: &str, value: &Value) -> Result<Self> {
        match value {
            Value::Integer(number) => Ok(*number as Self),
            Value::Real(number) => crate::error::real(item, *number, f64::MIN, false),
            _ => Err(Error::wrong_type(item, value, "give a finite number")),
        }
    }

    fn show(&self) -> Value {
        Value::Real(*self)
    }
}

/// Reads a value that must be one of some words; case, "-" and "_" do not matter.
///
/// # Errors
/// Any other value; the error lists the words.
pub fn word<T: Copy>(item: &str, value: &Value, words: &[(&'static str, T)]) -> Result<T> {
    let entry = match value {
        Value::Text(text) => words.iter().find(|(word, _)| same_name(word, text)),
        _ => None,
    };
    entry.map(|(_, meaning)| *meaning).ok_or_else(|| {
        let known: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        Error::invalid(item, value, format!("give {}", known.join(" or ")))
    })
}

/// Returns the word for a value.
pub fn spell<T: Copy + PartialEq>(value: T, words: &[(&'static str, T)]) -> Value {
    let entry = words.iter().find(|(_, meaning)| *meaning == value);
    Value::Text(entry.map_or_else(String::new, |(word, _)| (*word).to_string()))
}

/// Makes an enum the type of an option: each of its values is given by a word.
macro_rules! words {
    ($type:ty: $($word:literal = $value:expr),+) => {
        impl $crate::scene::OptionValue for $type {
            const WORDS: &'static [&'static str] = &[$($word),+];

            fn read(item: &str, value: &$crate::scene::Value) -> Result<Self, $crate::error::Error> {
                $crate::scene::word(item, value, &[$(($word, $value)),+])
            }

            fn show(&self) -> $crate::scene::Value {
                $crate::scene::spell(*self, &[$(($word, $value)),+])
            }
        }
    };
}
pub(crate) use words;
