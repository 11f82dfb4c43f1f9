//! Threads: runs the parts of a task on several threads, while the calling thread checks whether to stop.
//!
//! With the feature `parallel` the threads are those of a rayon pool. With `std` alone, they are created for the task and end
//! with it; then only one thread is used unless more are requested.

use alloc::vec::Vec;
use core::sync::atomic::AtomicBool;

#[cfg(feature = "parallel")]
use alloc::sync::Arc;

/// The number of threads that work at the same time, and their pool. The default is all threads of rayon's global pool, or one
/// thread without rayon.
#[derive(Clone, Debug, Default)]
pub struct Threads {
    #[cfg(feature = "parallel")]
    pool: Option<Arc<rayon::ThreadPool>>,
    most: Option<usize>,
}

impl Threads {
    /// Uses the threads of this pool.
    #[cfg(feature = "parallel")]
    pub fn of(pool: Arc<rayon::ThreadPool>) -> Self {
        Self { pool: Some(pool), most: None }
    }

    /// Limits the number of threads to `most`, at least 1.
    #[must_use]
    pub fn at_most(mut self, most: usize) -> Self {
        self.most = Some(most.max(1));
        self
    }

    /// The number of threads that work at the same time.
    pub(crate) fn count(&self) -> usize {
        // With one thread, the pool must not even be created.
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

    /// Runs each part on its own thread, at most [`Threads::count`] parts, and returns the results in order. Meanwhile calls
    /// `listen` every 20 ms; when it returns false, sets `stop`, which the parts read. Returns the parts unchanged if the
    /// caller should run them itself: if there is only one part or one thread, or if this thread belongs to a pool.
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
        /// The time between two checks for a stop: short enough for an immediate reaction, long enough to cost nothing.
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

    /// Runs each task on a thread of the pool, or of rayon's global pool, and `meanwhile` on this thread.
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

    /// Runs each task on a new thread, and `meanwhile` on this thread.
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

    /// Without threads, the caller runs all parts.
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
