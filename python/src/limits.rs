//! Limits of a computation: threads of this process, and memory.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::{mem, process};

use midair::Threads;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::invalid;
use crate::read;

/// Default memory limit in bytes.
const MEMORY: u64 = 8_000_000_000;

/// Returns the thread pool of this process, one thread per processor. A forked child has no threads of its parent, so it
/// gets a new pool.
pub(crate) fn threads(_py: Python<'_>) -> PyResult<Threads> {
    static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    // Only a thread with the GIL takes this lock, so it is never locked when Python forks.
    let mut lock = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = process::id();
    if let Some((owner, pool)) = &*lock
        && *owner == process
    {
        return Ok(Threads::of(Arc::clone(pool)));
    }
    let built = ThreadPoolBuilder::new().build();
    let pool = Arc::new(built.map_err(|error| PyRuntimeError::new_err(format!("no threads to work with: {error}")))?);
    // The parent's pool is not dropped: dropping would wait for threads that do not exist in this process.
    mem::forget(lock.replace((process, Arc::clone(&pool))));
    Ok(Threads::of(pool))
}

/// Returns at most as many threads as the caller requests; all threads by default.
pub(crate) fn at_most(py: Python<'_>, limit: Option<&Bound<'_, PyAny>>) -> PyResult<Threads> {
    match limit.map(|value| read::count("threads", value)).transpose()? {
        None => threads(py),
        Some(0) => Err(invalid("threads", "0", "give a whole number, 1 or above")),
        // A single thread needs no pool.
        Some(1) => Ok(Threads::default().at_most(1)),
        Some(most) => Ok(threads(py)?.at_most(most)),
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
    match std::env::var("MIDAIR_MEMORY").ok().filter(|text| !text.is_empty()) {
        None => Ok(installed().map_or(MEMORY, |bytes| MEMORY.min(bytes / 4 * 3))),
        Some(text) => read(&text).ok_or(text),
    }
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
