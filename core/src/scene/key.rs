//! Key: one key of a table in a scene file, declared once for all bindings; and structs whose fields are numeric keys.

/// A key of a table in a scene file, with the texts that editors, bindings and error messages show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// The key's name in scene files, Python and C.
    pub name: &'static str,
    /// An example of a value, as in JSON.
    pub example: &'static str,
    /// The meaning in one line, with unit and default.
    pub about: &'static str,
}

impl Key {
    /// Returns a key with these texts.
    pub(crate) const fn new(name: &'static str, example: &'static str, about: &'static str) -> Self {
        Self { name, example, about: about.trim_ascii() }
    }
}

/// Declares a struct of numbers, each with its unit, default, range and an example. The keys after `or by` have no field: the
/// fields are computed from them.
///
/// The struct gets `Default` and: `KEYS`, all keys in order; `numbers`, its fields by name; `set`, which sets one field by
/// name; `in_range`, which rejects a number out of its range.
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

            /// The key of this name; case, "-" and "_" do not matter.
            pub fn key(name: &str) -> Option<&'static $crate::scene::Key> {
                Self::KEYS.iter().find(|key| $crate::error::same_name(key.name, name))
            }

            /// The fields: name and value of each.
            pub fn numbers(&self) -> impl ExactSizeIterator<Item = (&'static str, f64)> + use<> {
                [$( (stringify!($field), self.$field), )+].into_iter()
            }

            /// Sets the field of this name; returns false if there is none.
            fn set(&mut self, name: &str, value: f64) -> bool {
                match name {
                    $( stringify!($field) => self.$field = value, )+
                    _ => return false,
                }
                true
            }

            /// Checks that each number is in its range.
            pub(crate) fn in_range(&self) -> Result<(), $crate::error::Error> {
                $( $crate::error::real(
                    concat!($table, ".", stringify!($field)), self.$field, $least, $crate::scene::key::strict!($range),
                )?; )+
                Ok(())
            }
        }
    };
}
pub(crate) use numbers;

/// Whether a range excludes its lower end: `above` excludes it, `least` includes it.
macro_rules! strict {
    (above) => {
        true
    };
    (least) => {
        false
    };
}
pub(crate) use strict;
