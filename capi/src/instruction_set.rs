//! The instruction set of the kernels: the best of this machine, unless MIDAIR_SIMD names another one.

use std::sync::OnceLock;

use midair::{Error, InstructionSet};

/// Returns the instruction set that `MIDAIR_SIMD` names, else the best of this machine. The environment is read only once.
pub(crate) fn instruction_set() -> Result<InstructionSet, Error> {
    static REQUESTED: OnceLock<Option<String>> = OnceLock::new();
    let Some(name) = REQUESTED.get_or_init(|| std::env::var("MIDAIR_SIMD").ok().filter(|name| !name.is_empty())) else {
        return Ok(InstructionSet::best());
    };
    InstructionSet::named(name).ok_or_else(|| {
        let known: Vec<&str> = InstructionSet::all().map(InstructionSet::name).collect();
        Error::invalid("MIDAIR_SIMD", name, format!("this machine has {}", known.join(", ")))
    })
}
