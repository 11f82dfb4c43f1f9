//! Part: optional data of an array beside its positions, such as a mask. Each part is declared once here for all bindings.

use crate::device::quantization::Quantization;
use crate::error::same_name;
use crate::prelude::*;
use crate::scene::array::Array;
use crate::scene::directivity::Directivity;
use crate::scene::key::Key;
use crate::scene::origin::Origin;
use crate::scene::transducer::Transducer;

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

type Checked = Result<Array, Error>;

/// The functions that read a part from an array and that set it, by type.
#[derive(Debug)]
enum Access {
    Real(fn(&Array) -> f64, fn(Array, f64) -> Checked),
    Directivity(fn(&Array) -> Directivity, fn(Array, Directivity) -> Checked),
    Complexes(fn(&Array) -> Option<&[Complex64]>, fn(Array, Option<Vec<Complex64>>) -> Checked),
    Flags(fn(&Array) -> Option<&[bool]>, fn(Array, Option<Vec<bool>>) -> Checked),
    Indices(fn(&Array) -> Option<&[usize]>, fn(Array, Option<Vec<usize>>) -> Checked),
    Quantization(fn(&Array) -> Option<&Quantization>, fn(Array, Option<Quantization>) -> Array),
}

/// A named part of an array. [`Array::PARTS`] lists all of them.
#[derive(Debug)]
pub struct Part {
    /// The part's name in scene files, Python and C.
    pub name: &'static str,
    access: Access,
}

/// Declares the parts: the name of each, its meaning, an example and its access functions.
macro_rules! parts {
    ($( $(#[doc = $doc:literal])+ $name:ident, such as $example:literal: $access:expr; )+) => {
        impl Array {
            /// Every part, in the order of scene files.
            pub const PARTS: &'static [Part] = &[$( Part { name: stringify!($name), access: $access }, )+];

            /// The keys of the parts in scene files.
            pub const PART_KEYS: &'static [Key] =
                &[$( Key::new(stringify!($name), $example, concat!($($doc),+)), )+];
        }
    };
}

parts! {
    /// Pressure on the axis times distance, at full drive, in Pa m; by default that of the preset, or 4.386.
    source_pressure, such as "4.386": Access::Real(
        |array| array.transducer().source_pressure,
        |array, source_pressure| {
            let transducer = Transducer { source_pressure, ..array.transducer() };
            array.with_transducer(transducer)
        },
    );
    /// Directivity of a transducer: its name, or a table of the name and the parameter.
    directivity, such as r#"{"piston": 4.5e-3}"#: Access::Directivity(
        |array| array.transducer().directivity,
        |array, directivity| {
            let transducer = Transducer { directivity, ..array.transducer() };
            array.with_transducer(transducer)
        },
    );
    /// Complex factor [re, im] of each transducer's pressure; 0 means that it is dead.
    response, such as "[[1.0, 0.0], [0.5, -0.2]]": Access::Complexes(Array::response, Array::with_response);
    /// Whether each transducer is on; false means off.
    mask, such as "[true, false]": Access::Flags(Array::mask, Array::with_mask);
    /// Channel of each transducer, if several share one; by default that of the preset, or one for each transducer.
    channels, such as "[0, 0, 1, 1]": Access::Indices(Array::channels, Array::with_channels);
    /// Channel of the boards that plays each transducer; by default the order of the transducers decides.
    pins, such as "[1, 0]": Access::Indices(Array::pins, Array::with_pins);
    /// Phases and amplitudes that the board can play; by default those of the preset. {} allows any drive.
    quantization, such as r#"{"phases": 256}"#: Access::Quantization(Array::quantization, Array::with_quantization);
}

impl Part {
    /// The type of the part's value.
    pub fn kind(&self) -> PartKind {
        match self.access {
            Access::Real(..) => PartKind::Real,
            Access::Directivity(..) => PartKind::Directivity,
            Access::Complexes(..) => PartKind::Complexes,
            Access::Flags(..) => PartKind::Flags,
            Access::Indices(..) => PartKind::Indices,
            Access::Quantization(..) => PartKind::Quantization,
        }
    }

    /// The value of this part in an array, or `None` where the array has none.
    pub fn of(&self, array: &Array) -> Option<PartValue> {
        match self.access {
            Access::Real(get, _) => Some(PartValue::Real(get(array))),
            Access::Directivity(get, _) => Some(PartValue::Directivity(get(array))),
            Access::Complexes(get, _) => get(array).map(|list| PartValue::Complexes(list.to_vec())),
            Access::Flags(get, _) => get(array).map(|list| PartValue::Flags(list.to_vec())),
            Access::Indices(get, _) => get(array).map(|list| PartValue::Indices(list.to_vec())),
            Access::Quantization(get, _) => get(array).cloned().map(PartValue::Quantization),
        }
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
    pub fn put(&self, array: Array, value: PartValue) -> Result<Array, Error> {
        match (&self.access, value) {
            (Access::Real(_, set), PartValue::Real(value)) => set(array, value),
            (Access::Directivity(_, set), PartValue::Directivity(value)) => set(array, value),
            (Access::Complexes(_, set), PartValue::Complexes(value)) => set(array, Some(value)),
            (Access::Flags(_, set), PartValue::Flags(value)) => set(array, Some(value)),
            (Access::Indices(_, set), PartValue::Indices(value)) => set(array, Some(value)),
            (Access::Quantization(_, set), PartValue::Quantization(value)) => Ok(set(array, Some(value))),
            (_, value) => {
                let cure = format!("give a value of the kind {:?}", self.kind());
                Err(Error::invalid(format!("array.{}", self.name), format!("{value:?}"), cure))
            }
        }
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
