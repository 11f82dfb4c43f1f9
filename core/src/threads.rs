//! Threads: run the parts of a task, while the calling thread checks whether to stop.
//!
//! They are started for the task and end with it.

use alloc::vec::Vec;
use core::sync::atomic::AtomicBool;

/// Runs the parts on this many threads, and returns the results in order. Meanwhile calls `listen` every 20 ms; when it
/// returns false, sets `stop`, which the parts read.
pub(crate) fn spread<T: Send, R: Send>(
    threads: usize,
    parts: Vec<T>,
    stop: &AtomicBool,
    listen: &mut dyn FnMut() -> bool,
    run: &(dyn Fn(T) -> R + Sync),
) -> Vec<R> {
    use core::sync::atomic::Ordering::Relaxed;
    use std::sync::mpsc::{RecvTimeoutError, channel};
    use std::sync::{Mutex, PoisonError};
    use std::thread::{Builder, scope};
    use std::time::Duration;
    /// The time between two checks for a stop: short enough for an immediate reaction, long enough to cost nothing.
    const INTERVAL: Duration = Duration::from_millis(20);

    let count = threads.min(parts.len());
    let mut results: Vec<Option<R>> = parts.iter().map(|_| None).collect();
    let queue = Mutex::new(parts.into_iter().zip(&mut results));
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work = || {
        while let Some((part, place)) = next() {
            *place = Some(run(part));
        }
    };
    scope(|scope| {
        let (running, ended) = channel::<()>();
        let start = || {
            let running = running.clone();
            Builder::new().spawn_scoped(scope, move || {
                work();
                drop(running);
            })
        };
        if (0..count).filter(|_| start().is_ok()).count() == 0 {
            // The system starts no more threads.
            work();
        }
        drop(running);
        while ended.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
            if !listen() {
                stop.store(true, Relaxed);
            }
        }
    });
    drop(queue);
    results.into_iter().flatten().collect()
}
