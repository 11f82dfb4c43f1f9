//! Options of a solver as data: read from any door, checked in one place, listed with their defaults.

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;

use crate::device::quantization::Quantization;
use crate::error::Error;
use crate::problem::Aim;
use crate::solvers;
use crate::solvers::Configured;

/// The value of an option, as a door hands it over.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::exhaustive_enums, reason = "the kinds a scene file can hold")]
pub enum Value {
    /// true or false.
    Bool(bool),
    /// An integer; wide enough for a seed of 64 bits and for its negative.
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

/// The solver of a scene file: its name, its options, whether to balance, and the level.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The name in the registry.
    pub name: String,
    /// The options set; the others keep their defaults.
    pub options: Options,
    /// Whether to balance; left out it is the method's own habit.
    pub balance: Option<bool>,
    /// The level that a method that uses one aims at; left out it is the problem's own.
    pub level: Option<Aim>,
}

impl Choice {
    /// A choice from a table of options, in which `balance` and `level` are the entry point's, all else the solver's.
    ///
    /// # Errors
    /// A `balance` that is neither true nor false, a `level` that is none. Name and options are checked by
    /// [`Choice::configured`].
    pub fn new(name: String, mut options: Options) -> Result<Self, Error> {
        let balance = match options.remove("balance") {
            None => None,
            Some(Value::Bool(balance)) => Some(balance),
            Some(other) => return Err(Error::invalid("solver.balance", other, "give true or false")),
        };
        let level = options.remove("level").map(|level| Aim::read("solver.level", &level)).transpose()?;
        Ok(Self { name, options, balance, level })
    }

    /// The solver, on a device of some levels: its options' defaults may be the device's.
    ///
    /// # Errors
    /// An unknown name or option, a value out of range, a level for a solver that uses none.
    pub fn configured(&self, levels: Option<&Quantization>) -> Result<Configured, Error> {
        let made = solvers::find(&self.name)?.configure_for(&self.options, levels)?;
        if self.level.is_some() && !made.info.uses_aim {
            return Err(solvers::unused("level", made.info.name, |info| info.uses_aim));
        }
        Ok(made)
    }

    /// The table it came from.
    #[must_use]
    pub fn table(&self) -> Options {
        let balance = self.balance.map(|balance| ("balance".into(), Value::Bool(balance)));
        let level = self.level.map(|level| ("level".into(), level.show()));
        self.options.clone().into_iter().chain(balance).chain(level).collect()
    }
}

/// A type that an option can have.
pub trait OptionValue: Sized {
    /// Reads it from what a door handed over; `item` names the option in the error.
    ///
    /// # Errors
    /// A value of another kind or out of range.
    fn read(item: &str, value: &Value) -> Result<Self, Error>;
    /// The same as a value.
    fn show(&self) -> Value;
}

impl OptionValue for u64 {
    fn read(item: &str, value: &Value) -> Result<Self, Error> {
        match value {
            Value::Integer(number) => Self::try_from(*number).ok(),
            _ => None,
        }
        .ok_or_else(|| Error::invalid(item, value, "give a whole number from 0 to 2^64 - 1"))
    }

    fn show(&self) -> Value {
        Value::Integer(i128::from(*self))
    }
}

impl OptionValue for u32 {
    fn read(item: &str, value: &Value) -> Result<Self, Error> {
        match value {
            Value::Integer(number) => Self::try_from(*number).ok(),
            _ => None,
        }
        .ok_or_else(|| Error::invalid(item, value, "give a whole number, 0 or above"))
    }

    fn show(&self) -> Value {
        Value::Integer(i128::from(*self))
    }
}

impl OptionValue for f64 {
    fn read(item: &str, value: &Value) -> Result<Self, Error> {
        match value {
            Value::Integer(number) => Ok(*number as Self),
            Value::Real(number) if number.is_finite() => Ok(*number),
            _ => Err(Error::invalid(item, value, "give a finite number")),
        }
    }

    fn show(&self) -> Value {
        Value::Real(*self)
    }
}

/// Reads a value that is one of a few words.
///
/// # Errors
/// Any other value; the error lists the words.
pub fn word<T: Copy>(item: &str, value: &Value, words: &[(&'static str, T)]) -> Result<T, Error> {
    let found = match value {
        Value::Text(text) => words.iter().find(|(word, _)| word == text),
        _ => None,
    };
    found.map(|(_, meaning)| *meaning).ok_or_else(|| {
        let known: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        Error::invalid(item, value, format!("give {}", known.join(" or ")))
    })
}

/// The word for a value that is one of a few words.
pub fn spell<T: Copy + PartialEq>(value: T, words: &[(&'static str, T)]) -> Value {
    let found = words.iter().find(|(_, meaning)| *meaning == value);
    Value::Text(found.map_or_else(String::new, |(word, _)| (*word).to_string()))
}

/// One documented option.
#[derive(Clone, Debug, PartialEq)]
pub struct OptionInfo {
    /// Its name.
    pub name: &'static str,
    /// Its default.
    pub default: Value,
    /// What it does, in one line.
    pub doc: &'static str,
}

/// A plain value of documented options, as [`crate::options!`] makes one.
pub trait Configure: Default {
    /// Every option with its default.
    fn list() -> Vec<OptionInfo>;
    /// The present value of every option.
    fn options(&self) -> Options;
    /// Sets one option.
    ///
    /// # Errors
    /// An unknown name (the error lists the known ones) or a value that does not fit.
    fn set(&mut self, name: &str, value: &Value) -> Result<(), Error>;
}

/// Declares a solver's options once: the struct, its `Default` and its [`Configure`].
///
/// ```
/// midair::options! {
///     /// A solver that waits.
///     pub struct Patient {
///         /// How often.
///         pub times: u32 = 3,
///     }
/// }
/// assert_eq!(Patient::default().times, 3);
/// ```
#[macro_export]
macro_rules! options {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $( $(#[doc = $doc:literal])+ pub $field:ident: $type:ty = $default:expr, )*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        #[allow(clippy::exhaustive_structs, reason = "a solver is a plain value of its options")]
        pub struct $name {
            $( $(#[doc = $doc])+ pub $field: $type, )*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $( $field: $default, )* }
            }
        }

        impl $crate::Configure for $name {
            fn list() -> $crate::__private::Vec<$crate::OptionInfo> {
                #[allow(unused_variables, reason = "a solver may have no options")]
                let default = Self::default();
                $crate::__private::vec![ $( $crate::OptionInfo {
                    name: stringify!($field),
                    default: $crate::OptionValue::show(&default.$field),
                    doc: concat!($($doc),+).trim_ascii(),
                }, )* ]
            }

            fn options(&self) -> $crate::Options {
                [ $( (stringify!($field).into(), $crate::OptionValue::show(&self.$field)), )* ].into()
            }

            fn set(&mut self, name: &str, value: &$crate::Value) -> Result<(), $crate::Error> {
                match name {
                    $( stringify!($field) => {
                        self.$field = $crate::OptionValue::read(name, value)?;
                        Ok(())
                    } )*
                    _ => Err($crate::Error::unknown("option", name, [$( stringify!($field) ),*])),
                }
            }
        }
    };
}
