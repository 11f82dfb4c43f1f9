//! Prelude of the kernels: lane groups, the vector traits and the choice of instructions.

pub(crate) use crate::kernels::lanes::{BLOCK, LANES, Lanes, Line, Octet, groups, groups_mut, padded};
pub(crate) use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
pub(crate) use crate::kernels::simd::{Apart, Elementwise, Simd, TINY};
pub(crate) use crate::prelude::*;
