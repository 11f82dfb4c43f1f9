//! Prelude: the names that nearly every file needs: those of alloc, as in `std`'s own prelude, numbers, and how a call ends.

pub(crate) use alloc::borrow::Cow;
pub(crate) use alloc::boxed::Box;
pub(crate) use alloc::string::{String, ToString};
pub(crate) use alloc::sync::Arc;
pub(crate) use alloc::vec::Vec;
pub(crate) use alloc::{format, vec};
pub(crate) use core::f64::consts::{PI, TAU};
pub(crate) use core::fmt;
pub(crate) use core::ops::Range;

pub(crate) use num_complex::{Complex32, Complex64};

pub(crate) use crate::control::{Control, bytes};
pub(crate) use crate::error::{Error, ErrorCode, Notice, Result, frame_rate, one_each, real, same_name};
pub(crate) use crate::math::{self, sqrt, sqrtf};
pub(crate) use crate::rng::Rng;
pub(crate) use crate::vec3::Vec3;

/// Declares methods that return a part of a value, one per line: name, type and value.
macro_rules! getters {
    ($type:ident: $( $(#[$about:meta])* $vis:vis $name:ident($this:ident) -> $kind:ty = $value:expr; )+) => {
        impl $type {
            $(
                $(#[$about])*
                $vis fn $name(&$this) -> $kind {
                    $value
                }
            )+
        }
    };
}
pub(crate) use getters;

/// Returns an error from the function if a condition is true.
macro_rules! refuse_if {
    ($condition:expr, $error:expr) => {
        if $condition {
            return Err($error);
        }
    };
}
pub(crate) use refuse_if;
