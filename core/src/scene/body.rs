//! Body: declares the obstacles that a few numbers describe, once for scene files and bindings.

use crate::prelude::*;

/// A type that is made from a fixed count of numbers: a scalar or an array.
pub(crate) trait Numbers {
    const COUNT: usize;
    fn of(numbers: &[f64]) -> Self;
    fn list(&self) -> Vec<f64>;
}

impl Numbers for f64 {
    const COUNT: usize = 1;

    fn of(numbers: &[f64]) -> Self {
        numbers[0]
    }

    fn list(&self) -> Vec<f64> {
        [*self].into()
    }
}

impl<const N: usize> Numbers for [f64; N] {
    const COUNT: usize = N;

    fn of(numbers: &[f64]) -> Self {
        core::array::from_fn(|k| numbers[k])
    }

    fn list(&self) -> Vec<f64> {
        self.to_vec()
    }
}

/// Declares the enum of obstacles: first the kinds that a few numbers describe, with unit and example of each
/// parameter, then the kinds that wrap one value.
///
/// The enum gets `BODIES`, a `Body` for each kind that numbers describe; `PARTS`, the parameters of these kinds as
/// keys; and `noun`. The file that calls this macro has `Body`, `Key` and `Surface`.
macro_rules! obstacles {
    (
        $(#[$meta:meta])*
        pub enum $enum:ident {
            $(
                $(#[$about:meta])*
                $name:ident = $noun:literal {
                    $( $(#[doc = $doc:literal])+ $field:ident: $type:ty, such as $example:literal; )+
                }
            )+
            ---
            $( $(#[$other_about:meta])* $other:ident($of:ty) = $other_noun:literal, )*
        }
    ) => {
        $(#[$meta])*
        pub enum $enum {
            $(
                $(#[$about])*
                $name {
                    $( $(#[doc = $doc])+ $field: $type, )+
                    /// The acoustic boundary condition of the surface.
                    kind: Surface,
                },
            )+
            $( $(#[$other_about])* $other($of), )*
        }

        impl $enum {
            /// The kinds that a few numbers describe.
            pub const BODIES: &[Body] = &[$(
                Body {
                    noun: $noun,
                    parts: &[$( (
                        Key::new(stringify!($field), $example, concat!("Of a ", $noun, ":", $($doc),+)),
                        <$type as $crate::scene::body::Numbers>::COUNT,
                    ), )+],
                    make: |parts, kind| {
                        let mut parts = parts.iter();
                        $( let $field = parts.next().map_or_else(
                            || $crate::scene::body::Numbers::of(&[]),
                            |part| $crate::scene::body::Numbers::of(part),
                        ); )+
                        Self::$name { $( $field, )+ kind }
                    },
                    read: |obstacle| match obstacle {
                        Self::$name { $( $field, )+ kind } => {
                            Some(([$( $crate::scene::body::Numbers::list($field) ),+].into(), *kind))
                        }
                        _ => None,
                    },
                },
            )+];

            /// The parameters of the kinds in [`Self::BODIES`], in the same order.
            pub const PARTS: &[Key] = &[$($(
                Key::new(stringify!($field), $example, concat!("Of a ", $noun, ":", $($doc),+)),
            )+)+];

            pub(crate) fn noun(&self) -> &'static str {
                match self {
                    $( Self::$name { .. } => $noun, )+
                    $( Self::$other(_) => $other_noun, )*
                }
            }
        }
    };
}
pub(crate) use obstacles;
