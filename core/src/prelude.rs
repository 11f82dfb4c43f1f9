//! Prelude: the names that nearly every file needs: those of alloc, as in `std`'s own prelude, numbers, and how a call ends.

pub(crate) use alloc::boxed::Box;
pub(crate) use alloc::string::{String, ToString};
pub(crate) use alloc::sync::Arc;
pub(crate) use alloc::vec::Vec;
pub(crate) use alloc::{format, vec};

pub(crate) use num_complex::{Complex32, Complex64};

pub(crate) use crate::control::Control;
pub(crate) use crate::error::Error;
pub(crate) use crate::math;
pub(crate) use crate::rng::Rng;
pub(crate) use crate::vec3::Vec3;
