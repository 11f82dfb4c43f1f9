//! The instruction set of the kernels: the best one of this machine, unless MIDAIR_SIMD names another.

use std::sync::OnceLock;

use midair::InstructionSet;
use pyo3::prelude::*;

use crate::error::invalid;

/// Returns the instruction set that `MIDAIR_SIMD` names, or the best one of this machine. The variable is read once.
pub(crate) fn instruction_set() -> PyResult<InstructionSet> {
    static REQUESTED: OnceLock<Option<String>> = OnceLock::new();
    let Some(name) = REQUESTED.get_or_init(|| std::env::var("MIDAIR_SIMD").ok().filter(|name| !name.is_empty())) else {
        return Ok(InstructionSet::best());
    };
    InstructionSet::named(name).ok_or_else(|| {
        let known: Vec<&str> = InstructionSet::all().map(InstructionSet::name).collect();
        invalid("MIDAIR_SIMD", name, &format!("this machine has {}", known.join(", ")))
    })
}
