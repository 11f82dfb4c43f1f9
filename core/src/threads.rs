//! Threads: parts of one work over a pool, while the calling thread listens.

use alloc::vec::Vec;
use core::sync::atomic::AtomicBool;

#[cfg(feature = "parallel")]
use alloc::sync::Arc;

/// How many threads work at once, and whose they are: unless told otherwise, as many as rayon's own pool has.
#[derive(Clone, Debug, Default)]
pub struct Threads {
    #[cfg(feature = "parallel")]
    pool: Option<Arc<rayon::ThreadPool>>,
    most: Option<usize>,
}

impl Threads {
    /// Those of a pool.
    #[cfg(feature = "parallel")]
    #[must_use]
    pub fn of(pool: Arc<rayon::ThreadPool>) -> Self {
        Self { pool: Some(pool), most: None }
    }

    /// The same, `most` of them at once; at least 1.
    #[must_use]
    pub fn at_most(self, most: usize) -> Self {
        Self { most: Some(most.max(1)), ..self }
    }

    /// How many work at once.
    pub(crate) fn count(&self) -> usize {
        // One needs no pool, not even to be counted.
        if self.most == Some(1) {
            return 1;
        }
        #[cfg(feature = "parallel")]
        let all = self.pool.as_ref().map_or_else(rayon::current_num_threads, |pool| pool.current_num_threads());
        #[cfg(not(feature = "parallel"))]
        let all = 1;
        self.most.map_or(all, |most| most.min(all))
    }

    /// Runs every part on a thread of its own (at most [`Threads::count`] parts); the results in order. Meanwhile `listen`
    /// is asked every few milliseconds whether to go on; once it says no, `stop` is set for the parts to see. `None` if
    /// they are better run here: a single one, or where this thread is itself one of a pool's.
    #[cfg(feature = "parallel")]
    pub(crate) fn spread<T: Send, R: Send>(
        &self,
        parts: Vec<T>,
        stop: &AtomicBool,
        listen: &mut dyn FnMut() -> bool,
        run: &(dyn Fn(T) -> R + Sync),
    ) -> Result<Vec<R>, Vec<T>> {
        use core::sync::atomic::Ordering::Relaxed;
        use std::sync::mpsc::{RecvTimeoutError, channel};
        use std::time::Duration;
        /// Often enough that a stop feels immediate, seldom enough to cost nothing.
        const INTERVAL: Duration = Duration::from_millis(20);

        if parts.len() < 2 || self.count() < 2 || rayon::current_thread_index().is_some() {
            return Err(parts);
        }
        let mut results: Vec<Option<R>> = parts.iter().map(|_| None).collect();
        let (done, waiting) = channel::<()>();
        let places = &mut results;
        in_place(self.pool.as_deref(), |scope| {
            for (part, place) in parts.into_iter().zip(places) {
                let done = done.clone();
                scope.spawn(move |_| {
                    *place = Some(run(part));
                    drop(done);
                });
            }
            drop(done);
            while waiting.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                if !listen() {
                    stop.store(true, Relaxed);
                }
            }
        });
        Ok(results.into_iter().flatten().collect())
    }

    /// Without threads all parts are run here.
    #[cfg(not(feature = "parallel"))]
    pub(crate) fn spread<T, R>(
        &self,
        parts: Vec<T>,
        _stop: &AtomicBool,
        _listen: &mut dyn FnMut() -> bool,
        _run: &(dyn Fn(T) -> R + Sync),
    ) -> Result<Vec<R>, Vec<T>> {
        Err(parts)
    }
}

/// A scope of the pool, or of rayon's own, its body run by this thread.
#[cfg(feature = "parallel")]
fn in_place<'s>(pool: Option<&rayon::ThreadPool>, body: impl FnOnce(&rayon::Scope<'s>)) {
    match pool {
        Some(pool) => pool.in_place_scope(body),
        None => rayon::in_place_scope(body),
    }
}
