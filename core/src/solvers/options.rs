//! Options of a solver, declared once: struct, defaults, documentation, and reading by name.

use crate::prelude::*;

use crate::scene::{OptionValue, Options, Value};

/// The description of one option.
#[derive(Clone, Debug, PartialEq)]
pub struct OptionInfo {
    /// The name of the option.
    pub name: &'static str,
    /// The default value.
    pub default: Value,
    /// A description in one line.
    pub doc: &'static str,
    /// The words that the option accepts; empty if it accepts none.
    pub words: &'static [&'static str],
    /// Whether the option accepts a list of integers.
    pub list: bool,
}

/// A struct of documented options, as [`crate::options!`] declares it.
pub trait Configure: Default {
    /// Returns every option with its default.
    fn list() -> Vec<OptionInfo>;
    /// Returns the present value of every option.
    fn options(&self) -> Options;
    /// Sets one option. Upper and lower case, "-" and "_" of its name make no difference.
    ///
    /// # Errors
    /// An unknown name (the error lists the known ones), or a value that does not fit.
    fn set(&mut self, name: &str, value: &Value) -> Result<()>;
}

/// Adds an option with its default to a list; used by [`crate::options!`].
pub fn describe<T: OptionValue>(list: &mut Vec<OptionInfo>, name: &'static str, doc: &'static str, default: &T) {
    list.push(OptionInfo { name, default: default.show(), doc: doc.trim_ascii(), words: T::WORDS, list: T::LIST });
}

/// Adds the present value of an option to a list; used by [`crate::options!`].
pub fn note<T: OptionValue>(options: &mut Options, name: &str, value: &T) {
    options.insert(name.into(), value.show());
}

/// Names that [`crate::options!`] needs where it is used.
#[doc(hidden)]
pub mod private {
    pub use crate::error::same_name;
    pub use crate::solvers::options::{describe, note};
    pub use alloc::vec::Vec;
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
                #[allow(unused_mut, unused_variables, reason = "a solver may have no options")]
                let (mut list, default) = ($crate::__private::Vec::new(), Self::default());
                $( $crate::__private::describe(&mut list, stringify!($field), concat!($($doc),+), &default.$field); )*
                list
            }

            fn options(&self) -> $crate::Options {
                #[allow(unused_mut, reason = "a solver may have no options")]
                let mut options = $crate::Options::new();
                $( $crate::__private::note(&mut options, stringify!($field), &self.$field); )*
                options
            }

            fn set(&mut self, name: &str, value: &$crate::Value) -> Result<(), $crate::Error> {
                $( if $crate::__private::same_name(name, stringify!($field)) {
                    self.$field = $crate::OptionValue::read(stringify!($field), value)?;
                    return Ok(());
                } )*
                Err($crate::Error::unknown("option", name, [$( stringify!($field) ),*]))
            }
        }
    };
}
