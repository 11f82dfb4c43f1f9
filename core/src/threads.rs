//! Threads: parts of one task over several threads, while the calling thread checks for signals.
//!
//! With the feature `parallel` they are those of a pool of rayon's. With `std` alone they are made for the work and end with
//! it, and there is one unless more are wanted.

use alloc::vec::Vec;
use core::sync::atomic::AtomicBool;

#[cfg(feature = "parallel")]
use alloc::sync::Arc;

/// The number of threads that work at once, and their pool: by default as many as rayon's own pool has, or one
/// without rayon.
#[derive(Clone, Debug, Default)]
pub struct Threads {
    #[cfg(feature = "parallel")]
    pool: Option<Arc<rayon::ThreadPool>>,
    most: Option<usize>,
}

impl Threads {
    /// The threads of a pool.
    #[cfg(feature = "parallel")]
    #[must_use]
    pub fn of(pool: Arc<rayon::ThreadPool>) -> Self {
        Self { pool: Some(pool), most: None }
    }

    /// Limits the threads that work at once to `most`, at least 1.
    #[must_use]
    pub fn at_most(mut self, most: usize) -> Self {
        self.most = Some(most.max(1));
        self
    }

    /// The number of threads that work at once.
    pub(crate) fn count(&self) -> usize {
        // One needs no pool, not even to be counted.
        if self.most == Some(1) {
            return 1;
        }
        #[cfg(feature = "parallel")]
        let all = self.pool.as_ref().map_or_else(rayon::current_num_threads, |pool| pool.current_num_threads());
        #[cfg(all(feature = "std", not(feature = "parallel")))]
        let all = if self.most.is_none() { 1 } else { std::thread::available_parallelism().map_or(1, Into::into) };
        #[cfg(not(feature = "std"))]
        let all = 1;
        self.most.map_or(all, |most| most.min(all))
    }

    /// Runs every part on a thread of its own (at most [`Threads::count`] parts); the results in order. Meanwhile `listen`
    /// is called every few milliseconds and decides whether to continue; once it returns no, `stop` is set for the parts to see. `None` if
    /// they are better run here: a single one, or where this thread is itself one of a pool's.
    #[cfg(feature = "std")]
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

        if parts.len() < 2 || self.count() < 2 {
            return Err(parts);
        }
        #[cfg(feature = "parallel")]
        if rayon::current_thread_index().is_some() {
            return Err(parts);
        }
        let mut results: Vec<Option<R>> = parts.iter().map(|_| None).collect();
        let (done, waiting) = channel::<()>();
        let tasks = parts.into_iter().zip(&mut results).map(|(part, place)| {
            let done = done.clone();
            move || {
                *place = Some(run(part));
                drop(done);
            }
        });
        let tasks: Vec<_> = tasks.collect();
        drop(done);
        self.run(tasks, || {
            while waiting.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                if !listen() {
                    stop.store(true, Relaxed);
                }
            }
        });
        Ok(results.into_iter().flatten().collect())
    }

    /// Every task on a thread of the pool's, or of rayon's own, and `meanwhile` on this one.
    #[cfg(feature = "parallel")]
    fn run<'s>(&self, tasks: Vec<impl FnOnce() + Send + 's>, meanwhile: impl FnOnce()) {
        let body = |scope: &rayon::Scope<'s>| {
            for task in tasks {
                scope.spawn(move |_| task());
            }
            meanwhile();
        };
        match &self.pool {
            Some(pool) => pool.in_place_scope(body),
            None => rayon::in_place_scope(body),
        }
    }

    /// Every task on a thread that ends with it, and `meanwhile` on this one.
    #[cfg(all(feature = "std", not(feature = "parallel")))]
    #[allow(clippy::unused_self, reason = "a pool's threads are its own")]
    fn run(&self, tasks: Vec<impl FnOnce() + Send>, meanwhile: impl FnOnce()) {
        std::thread::scope(|scope| {
            for task in tasks {
                scope.spawn(task);
            }
            meanwhile();
        });
    }

    /// Without threads all parts are run here.
    #[cfg(not(feature = "std"))]
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
