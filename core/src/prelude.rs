//! Prelude: the names that nearly every file needs, those of alloc (as `std`'s own prelude has them) and how a call ends.

pub(crate) use alloc::boxed::Box;
pub(crate) use alloc::string::{String, ToString};
pub(crate) use alloc::vec::Vec;
pub(crate) use alloc::{format, vec};

pub(crate) use crate::control::Control;
pub(crate) use crate::error::Error;
