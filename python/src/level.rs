//! The level of the kernels: the best, unless the environment names another.

use std::sync::OnceLock;

use midair::Level;
use pyo3::prelude::*;

use crate::invalid;

/// The level that `MIDAIR_LEVEL` names, else the best of this machine. The environment is read once.
pub(crate) fn level() -> PyResult<Level> {
    static ASKED: OnceLock<Option<String>> = OnceLock::new();
    let Some(name) = ASKED.get_or_init(|| std::env::var("MIDAIR_LEVEL").ok()) else {
        return Ok(Level::best());
    };
    Level::named(name).ok_or_else(|| {
        let known: Vec<&str> = Level::all().map(Level::name).collect();
        invalid("MIDAIR_LEVEL", name, &format!("this machine has {}", known.join(", ")))
    })
}
