//! Ctrl-C and progress callbacks while the core computes.

use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use midair::Progress;
use pyo3::prelude::*;

/// What a solve calls after each step.
pub(crate) type Step<'a> = dyn FnMut(Progress<'_>) -> ControlFlow<()> + Send + 'a;

/// Watches a running solve for Python: signals are checked every 50 ms, the progress callback is called every step.
pub(crate) struct Watch {
    progress: Option<Py<PyAny>>,
    /// When signals were last looked at.
    last: Instant,
    /// When the clock was, how many steps it is left alone for, and how many of them are to come.
    clock: Instant,
    stride: u32,
    left: u32,
    raised: Option<PyErr>,
}

impl Watch {
    /// Often enough that Ctrl-C feels immediate, seldom enough that taking the GIL costs nothing.
    const INTERVAL: Duration = Duration::from_millis(50);

    pub(crate) fn new(progress: Option<Py<PyAny>>) -> Self {
        let now = Instant::now();
        Self { progress, last: now, clock: now, stride: 1, left: 0, raised: None }
    }

    /// Called once a step, without the GIL.
    pub(crate) fn step(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        if self.progress.is_none() {
            if self.left > 0 {
                self.left -= 1;
                return ControlFlow::Continue(());
            }
            if !self.due() {
                return ControlFlow::Continue(());
            }
        }
        let go_on = Python::attach(|py| -> PyResult<bool> {
            if self.last.elapsed() >= Self::INTERVAL {
                py.check_signals()?;
                self.last = Instant::now();
            }
            let Some(callback) = &self.progress else { return Ok(true) };
            let answer = callback.call1(py, (progress.step, progress.steps, progress.residual()))?;
            // Only False stops: a callback that returns nothing goes on.
            Ok(answer.extract::<bool>(py).unwrap_or(true))
        });
        match go_on {
            Ok(true) => ControlFlow::Continue(()),
            Ok(false) => ControlFlow::Break(()),
            Err(error) => {
                self.raised = Some(error);
                ControlFlow::Break(())
            }
        }
    }

    /// Whether signals are to be looked at. A step of greedy takes a tenth of a microsecond and asking for the time a
    /// third of that, so the clock is left alone for as many steps as fill a tenth of the interval.
    fn due(&mut self) -> bool {
        let now = Instant::now();
        let pace = (now - self.clock) / self.stride;
        self.clock = now;
        let fill = (Self::INTERVAL / 10).as_nanos() / pace.as_nanos().max(1);
        // Later steps may be slower: the stride grows slowly.
        self.stride = u32::try_from(fill).unwrap_or(u32::MAX).clamp(1, self.stride.saturating_mul(2));
        self.left = self.stride - 1;
        now - self.last >= Self::INTERVAL
    }

    /// Runs `work`, whose steps call what it is given, on another thread, and looks at signals meanwhile: those a program's
    /// first thread alone hears. Called without the GIL.
    pub(crate) fn beside<R: Send>(&mut self, work: impl FnOnce(&mut Step<'_>) -> R + Send) -> R {
        let (done, waiting) = mpsc::channel::<()>();
        let stop = AtomicBool::new(false);
        let mut heard = None;
        let watch = &mut *self;
        let result = thread::scope(|scope| {
            let stopped = &stop;
            let worker = scope.spawn(move || {
                let _done = done;
                work(&mut |progress| {
                    if stopped.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { watch.step(&progress) }
                })
            });
            while waiting.recv_timeout(Self::INTERVAL) == Err(RecvTimeoutError::Timeout) {
                if let Some(error) = Python::attach(|py| py.check_signals().err()) {
                    heard = Some(error);
                    stop.store(true, Ordering::Relaxed);
                }
            }
            worker.join()
        });
        self.raised = heard.or(self.raised.take());
        result.unwrap_or_else(|panic| resume_unwind(panic))
    }

    /// The exception of a callback or signal, if there was one.
    pub(crate) fn raised(self) -> PyResult<()> {
        self.raised.map_or(Ok(()), Err)
    }
}
