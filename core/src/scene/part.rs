//! Part: names of the optional data of an array, such as a mask, for all bindings. The array itself checks them.

use alloc::borrow::ToOwned;

use crate::device::quantization::Quantization;
use crate::prelude::*;
use crate::scene::{Array, Directivity, Key, Origin, Transducer};

/// The type of a part's value. Bindings have one function to read and write each type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartKind {
    /// One number.
    Real,
    /// A directivity: the name of a law, with or without its parameter.
    Directivity,
    /// A complex number for each transducer.
    Complexes,
    /// A truth value for each transducer.
    Flags,
    /// A whole number of 0 or above for each transducer.
    Indices,
    /// A quantization: the phases and amplitudes that a board can play. If both are left out, any drive is allowed.
    Quantization,
}

/// The value of a part, one variant for each [`PartKind`].
#[derive(Clone, Debug, PartialEq)]
pub enum PartValue {
    /// One number.
    Real(f64),
    /// A law of directivity with its parameter.
    Directivity(Directivity),
    /// One number for each transducer (N,).
    Complexes(Vec<Complex64>),
    /// One truth value for each transducer (N,).
    Flags(Vec<bool>),
    /// One index for each transducer (N,).
    Indices(Vec<usize>),
    /// The phases and amplitudes that the board can play.
    Quantization(Quantization),
}

/// A named part of an array. [`Array::PARTS`] lists all of them.
#[derive(Debug)]
pub struct Part {
    /// The part's name in scene files, Python and C.
    pub name: &'static str,
    kind: PartKind,
    get: fn(&Array) -> Option<PartValue>,
    set: fn(Array, PartValue) -> Result<Array>,
}

/// Declares the parts: the name of each, its meaning, an example, its type, and the functions that return and set it.
macro_rules! parts {
    ($( $(#[doc = $doc:literal])+ $name:ident, such as $example:literal: $kind:ident($get:expr, $set:expr); )+) => {
        impl Array {
            /// Every part, in the order of scene files.
            pub const PARTS: &'static [Part] = &[$( Part {
                name: stringify!($name),
                kind: PartKind::$kind,
                get: |array| $get(array).map(|value| PartValue::$kind(value.to_owned())),
                set: |array, value| match value {
                    PartValue::$kind(value) => $set(array, value.into()),
                    other => Err(another_kind(stringify!($name), PartKind::$kind, &other)),
                },
            }, )+];

            /// The keys of the parts in scene files.
            pub const PART_KEYS: &'static [Key] =
                &[$( Key::new(stringify!($name), $example, concat!($($doc),+)), )+];
        }
    };
}

parts! {
    /// Pressure on the axis times distance, at full drive, in Pa m; by default that of the preset, or 4.386.
    source_pressure, such as "4.386": Real(
        |array: &Array| Some(array.transducer().source_pressure),
        |array: Array, source_pressure: f64| {
            let transducer = Transducer { source_pressure, ..array.transducer() };
            array.with_transducer(transducer)
        }
    );
    /// Directivity of a transducer: its name, or a table of the name and the parameter.
    directivity, such as r#"{"piston": 4.5e-3}"#: Directivity(
        |array: &Array| Some(array.transducer().directivity),
        |array: Array, directivity: Directivity| {
            let transducer = Transducer { directivity, ..array.transducer() };
            array.with_transducer(transducer)
        }
    );
    /// Part of |p| that each of two boards face to face reflects, 0 to 1; by default 0.
    reflecting, such as "0.5": Real(
        |array: &Array| Some(array.reflecting()).filter(|part| *part > 0.0),
        Array::with_reflecting
    );
    /// Complex factor [re, im] of each transducer's pressure; 0 means that it is dead.
    response, such as "[[1.0, 0.0], [0.5, -0.2]]": Complexes(Array::response, Array::with_response);
    /// Whether each transducer is on; false means off.
    mask, such as "[true, false]": Flags(Array::mask, Array::with_mask);
    /// Channel of each transducer, if several share one; by default that of the preset, or one for each transducer.
    channels, such as "[0, 0, 1, 1]": Indices(Array::channels, Array::with_channels);
    /// Channel of the boards that plays each transducer; by default the order of the transducers decides.
    pins, such as "[1, 0]": Indices(Array::pins, Array::with_pins);
    /// Phases and amplitudes that the board can play; by default those of the preset. {} allows any drive.
    quantization, such as r#"{"phases": 256}"#: Quantization(
        Array::quantization,
        |array: Array, board: Option<Quantization>| Ok(array.with_quantization(board))
    );
}

fn another_kind(name: &str, kind: PartKind, value: &PartValue) -> Error {
    Error::invalid(format!("array.{name}"), format!("{value:?}"), format!("give a value of the kind {kind:?}"))
}

impl Part {
    /// The type of the part's value.
    pub fn kind(&self) -> PartKind {
        self.kind
    }

    /// The value of this part in an array, or `None` where the array has none.
    pub fn of(&self, array: &Array) -> Option<PartValue> {
        (self.get)(array)
    }

    /// Returns the array with this value of the part instead of its own.
    ///
    /// ```
    /// use midair::{Array, PartValue};
    ///
    /// let mask = Array::part("mask").expect("a part");
    /// let array = mask.put(Array::grid(2, 1, 10e-3)?, PartValue::Flags(vec![true, false]))?;
    /// assert_eq!(array.mask(), Some(&[true, false][..]));
    /// # Ok::<(), midair::Error>(())
    /// ```
    ///
    /// # Errors
    /// A value of another type; values that the array's own methods reject, such as a list whose length is not the number of
    /// transducers.
    pub fn put(&self, array: Array, value: PartValue) -> Result<Array> {
        (self.set)(array, value)
    }
}

impl Array {
    /// Returns the part of this name; case, "-" and "_" do not matter.
    pub fn part(name: &str) -> Option<&'static Part> {
        Self::PARTS.iter().find(|part| same_name(part.name, name))
    }

    /// Returns the parts that a scene file must state, beside the origin, to make the same array again. Values that the preset
    /// already has are left out.
    pub fn stated(&self) -> impl Iterator<Item = (&'static str, PartValue)> + '_ {
        let usual = match *self.origin() {
            Origin::Preset { name, tiles } => Self::preset(name, tiles).ok(),
            _ => None,
        };
        Self::PARTS.iter().filter_map(move |part| {
            let always = matches!(part.kind(), PartKind::Real | PartKind::Directivity);
            let usual = usual.as_ref().filter(|_| !always).and_then(|usual| part.of(usual));
            let value = match (part.of(self), usual) {
                (value, usual) if value == usual => None,
                (None, Some(usual)) => none_like(&usual, self.len()),
                (value, _) => value,
            };
            Some((part.name, value?))
        })
    }
}

/// Returns the value that means "none", for an array without a part that its preset has. Leaving the part out would mean the
/// preset's value.
fn none_like(usual: &PartValue, transducers: usize) -> Option<PartValue> {
    Some(match usual {
        PartValue::Complexes(_) => PartValue::Complexes(vec![Complex64::ONE; transducers]),
        PartValue::Flags(_) => PartValue::Flags(vec![true; transducers]),
        PartValue::Indices(_) => PartValue::Indices((0..transducers).collect()),
        _ => PartValue::Quantization(Quantization::new(None, None).ok()?),
    })
}
