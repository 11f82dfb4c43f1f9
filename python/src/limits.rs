//! Limits of a computation: threads, and memory.

use std::num::NonZero;
use std::sync::OnceLock;
use std::thread;

use pyo3::prelude::*;

use crate::error::invalid;
use crate::read;

/// Default memory limit in bytes.
const MEMORY: u64 = 8_000_000_000;

/// Returns the number of threads of a computation: `MIDAIR_THREADS`, by default one per processor. The variable is read once.
pub(crate) fn threads() -> PyResult<usize> {
    static REQUESTED: OnceLock<Result<usize, String>> = OnceLock::new();
    let read = || match variable("MIDAIR_THREADS") {
        None => Ok(thread::available_parallelism().map_or(1, NonZero::get)),
        Some(text) => text.trim().parse().ok().filter(|count| (1..=1024).contains(count)).ok_or(text),
    };
    REQUESTED
        .get_or_init(read)
        .clone()
        .map_err(|text| invalid("MIDAIR_THREADS", &format!("\"{text}\""), "give a whole number of threads, 1 to 1024"))
}

/// Returns at most as many threads as the caller requests; all threads by default.
pub(crate) fn at_most(limit: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
    match limit.map(|value| read::count("threads", value)).transpose()? {
        None => threads(),
        Some(0) => Err(invalid("threads", "0", "give a whole number, 1 or above")),
        Some(most) => Ok(threads()?.min(most)),
    }
}

/// Returns the memory limit of a computation in bytes: `MIDAIR_MEMORY` (such as 2e9, 500MB or 16GB), by default 8 GB or
/// three quarters of the machine's memory if that is less. The variable is read once.
pub(crate) fn memory() -> PyResult<u64> {
    static REQUESTED: OnceLock<Result<u64, String>> = OnceLock::new();
    REQUESTED.get_or_init(requested).clone().map_err(no_bytes)
}

/// Returns the memory limit for computations in Python; the variable is read at each call.
#[pyfunction]
pub(crate) fn memory_limit() -> PyResult<u64> {
    requested().map_err(no_bytes)
}

/// Returns the limit, or the text of the variable if it is no number of bytes.
fn requested() -> Result<u64, String> {
    match variable("MIDAIR_MEMORY") {
        None => Ok(installed().map_or(MEMORY, |bytes| MEMORY.min(bytes / 4 * 3))),
        Some(text) => read(&text).ok_or(text),
    }
}

/// Returns the text of an environment variable that is set.
fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|text| !text.is_empty())
}

fn no_bytes(text: String) -> PyErr {
    invalid("MIDAIR_MEMORY", &format!("\"{text}\""), "give bytes, such as 2e9, 500MB or 16GB")
}

/// Parses a number of bytes with or without a unit.
fn read(text: &str) -> Option<u64> {
    let text = text.trim().to_ascii_uppercase();
    let units = [("KB", 1e3), ("MB", 1e6), ("GB", 1e9), ("TB", 1e12), ("", 1.0)];
    let (number, unit) = units.iter().find_map(|(name, unit)| Some((text.strip_suffix(name)?, unit)))?;
    let bytes = number.trim().parse::<f64>().ok()? * unit;
    (bytes.is_finite() && bytes >= 0.0).then_some(bytes as u64)
}

/// Returns the machine's memory in bytes; None on systems other than Linux.
fn installed() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}
