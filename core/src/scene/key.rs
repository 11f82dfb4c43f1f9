//! Key: one key of a table of a scene file, declared once for every binding; and tables whose keys are numbers.

/// A key of a scene file's table: its name, and how editors, bindings and errors explain it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "three texts")]
pub struct Key {
    /// Its name in scene files, Python and C.
    pub name: &'static str,
    /// A value as JSON writes it.
    pub example: &'static str,
    /// The meaning in one line, with unit and default.
    pub about: &'static str,
}

impl Key {
    /// A key by its texts.
    pub(crate) const fn new(name: &'static str, example: &'static str, about: &'static str) -> Self {
        Self { name, example, about: about.trim_ascii() }
    }
}

/// Declares a struct of numbers, each with unit, default, range and an example, and the keys that set them otherwise.
///
/// The struct gets `Default`; `KEYS`, all keys in order; `numbers`, its own by name; `set`, one of them by name; and
/// `check`, which refuses a number out of range.
macro_rules! numbers {
    (
        $(#[$meta:meta])*
        pub struct $name:ident of $table:literal {
            $( $(#[doc = $doc:literal])+ $field:ident = $default:literal, $range:ident $least:literal, such as $example:literal; )+
        }
        or by {
            $( $(#[doc = $other_doc:literal])+ $other:ident, such as $other_example:literal; )*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[allow(clippy::exhaustive_structs, reason = "numbers that a caller sets freely; a scene checks them")]
        pub struct $name {
            $( $(#[doc = $doc])+ pub $field: f64, )+
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $( $field: $default, )+ }
            }
        }

        impl $name {
            /// Every key that sets one or more of the numbers.
            pub const KEYS: &[$crate::scene::Key] = &[
                $( $crate::scene::Key::new(stringify!($field), stringify!($example), concat!($($doc),+)), )+
                $( $crate::scene::Key::new(stringify!($other), stringify!($other_example), concat!($($other_doc),+)), )*
            ];

            /// The key of this name, whatever the case, "-" and "_".
            #[must_use]
            pub fn key(name: &str) -> Option<&'static $crate::scene::Key> {
                Self::KEYS.iter().find(|key| $crate::error::same_name(key.name, name))
            }

            /// The numbers by name.
            #[must_use]
            pub fn numbers(&self) -> impl ExactSizeIterator<Item = (&'static str, f64)> + use<> {
                [$( (stringify!($field), self.$field), )+].into_iter()
            }

            /// Sets one of the numbers; returns whether there is one of this name.
            fn set(&mut self, name: &str, value: f64) -> bool {
                match name {
                    $( stringify!($field) => self.$field = value, )+
                    _ => return false,
                }
                true
            }

            /// Refuses a number that is out of its range.
            fn in_range(&self) -> Result<(), $crate::error::Error> {
                $( $crate::error::real(
                    concat!($table, ".", stringify!($field)), self.$field, $least, $crate::scene::key::strict!($range),
                )?; )+
                Ok(())
            }
        }
    };
}
pub(crate) use numbers;

/// Whether a range excludes its end: `above` it, or from `least` on.
macro_rules! strict {
    (above) => {
        true
    };
    (least) => {
        false
    };
}
pub(crate) use strict;
