//! Ctrl-C, progress callbacks and limits (threads, memory) of a computation in the core.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use midair::{Control, Observe, Progress};
use pyo3::prelude::*;

use crate::error::refused;
use crate::limits;

/// Runs a long computation of the core without the GIL, on all threads. Signals stop it within a tenth of a second; `progress`
/// is called every step.
pub(crate) fn attend<R: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(Control<'_>) -> Result<R, midair::Error> + Send,
) -> PyResult<R> {
    let (memory, threads) = (limits::memory()?, limits::threads()?);
    let mut watch = Watch::new(progress);
    let result = py.detach(|| work(Control::watched(&mut watch).with_memory(memory).with_threads(threads)));
    watch.raised()?;
    result.map_err(refused)
}

/// Checks a running computation for signals every 50 ms, and calls the progress callback every step. Within steps longer
/// than 0.2 s the callback is called repeatedly.
pub(crate) struct Watch {
    progress: Option<Py<PyAny>>,
    /// The last arguments of the callback, and the time of the call.
    reported: (usize, usize, f64),
    called: Instant,
    /// Time of the last check for signals.
    last: Instant,
    /// Time of the last reading of the clock; number of calls between two readings; how many of them are left.
    clock: Instant,
    stride: u32,
    left: u32,
    raised: Option<PyErr>,
}

impl Watch {
    /// Time between two checks for signals: short enough that Ctrl-C acts at once, long enough that taking the GIL costs
    /// little.
    const INTERVAL: Duration = Duration::from_millis(50);

    /// Longest time between two calls of the progress callback, also within a long step.
    const PATIENCE: Duration = Duration::from_millis(200);

    pub(crate) fn new(progress: Option<Py<PyAny>>) -> Self {
        let now = Instant::now();
        let reported = (0, 1, 1.0);
        Self { progress, reported, called: now, last: now, clock: now, stride: 1, left: 0, raised: None }
    }

    /// Checks for signals if the last check was an interval ago, and calls the callback if `call` is true.
    fn ask(&mut self, call: bool) -> ControlFlow<()> {
        let go_on = Python::attach(|py| -> PyResult<bool> {
            if self.last.elapsed() >= Self::INTERVAL {
                py.check_signals()?;
                self.last = Instant::now();
            }
            let Some(callback) = self.progress.as_ref().filter(|_| call) else { return Ok(true) };
            let answer = callback.call1(py, self.reported)?;
            self.called = Instant::now();
            // Only False stops: a callback without a return value continues.
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

    /// Largest numbers of steps and of pulses between two readings of the clock. The next ones may be a thousand times slower:
    /// after a pulse, the next step reads the clock.
    const STEPS: u32 = 256;
    const PULSES: u32 = 1;

    /// Returns whether it is time to check for signals.
    ///
    /// A step of greedy takes 0.1 us, reading the clock a third of that. So the clock is read only once in as many calls as
    /// fill a tenth of the interval, and at least once in `most` calls.
    fn due(&mut self, most: u32) -> bool {
        // Fast steps may have set more than the slow pulses after them may count down.
        if self.left > 0 {
            self.left = self.left.min(most) - 1;
            return false;
        }
        let now = Instant::now();
        let pace = (now - self.clock) / self.stride;
        self.clock = now;
        let fill = (Self::INTERVAL / 10).as_nanos() / pace.as_nanos().max(1);
        self.stride = u32::try_from(fill).unwrap_or(u32::MAX).clamp(1, most);
        self.left = self.stride - 1;
        now - self.last >= Self::INTERVAL
    }

    /// Returns the exception that a callback or a signal has raised, if any.
    pub(crate) fn raised(self) -> PyResult<()> {
        self.raised.map_or(Ok(()), Err)
    }
}

impl Observe for Watch {
    /// Called once per step, without the GIL.
    fn step(&mut self, progress: Progress<'_>) -> ControlFlow<()> {
        if self.progress.is_none() {
            return if self.due(Self::STEPS) { self.ask(false) } else { ControlFlow::Continue(()) };
        }
        self.reported = (progress.step, progress.steps, progress.residual());
        self.ask(true)
    }

    /// Called within long steps, without the GIL.
    fn pulse(&mut self) -> ControlFlow<()> {
        if !self.due(Self::PULSES) {
            return ControlFlow::Continue(());
        }
        self.ask(self.called.elapsed() >= Self::PATIENCE)
    }
}
