//! Body: an obstacle that a few numbers describe, declared once for scene files and bindings.

use alloc::vec::Vec;

use crate::scene::{Key, Obstacle, Surface};

/// The numbers of each parameter of a body, and its boundary condition.
pub(crate) type Described = (Vec<Vec<f64>>, Surface);

/// A kind of obstacle that a few numbers describe.
#[derive(Debug)]
#[non_exhaustive]
pub struct Body {
    /// The name of the kind in messages.
    pub noun: &'static str,
    /// The parameters, each with its count of numbers.
    pub parts: &'static [(Key, usize)],
    /// Makes the obstacle from the numbers of each parameter and its boundary condition. The caller gives the right counts.
    pub make: fn(&[Vec<f64>], Surface) -> Obstacle,
    /// Returns the numbers of each parameter and the boundary condition; `None` for an obstacle of another kind.
    pub read: fn(&Obstacle) -> Option<Described>,
}

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
/// The enum gets `BODIES`, a [`Body`] for each kind that numbers describe; `PARTS`, the parameters of these kinds as
/// keys; and `noun`.
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
                    kind: $crate::scene::Surface,
                },
            )+
            $( $(#[$other_about])* $other($of), )*
        }

        impl $enum {
            /// The kinds that a few numbers describe.
            pub const BODIES: &[$crate::scene::Body] = &[$(
                $crate::scene::Body {
                    noun: $noun,
                    parts: &[$( (
                        $crate::scene::Key::new(stringify!($field), $example, concat!("Of a ", $noun, ":", $($doc),+)),
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
            pub const PARTS: &[$crate::scene::Key] = &[$($(
                $crate::scene::Key::new(stringify!($field), $example, concat!("Of a ", $noun, ":", $($doc),+)),
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
