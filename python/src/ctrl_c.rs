//! Ctrl-C and progress callbacks during a computation of the core, and its limits: threads and memory.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use midair::{Control, Observe, Progress};
use pyo3::prelude::*;

use crate::error::refused;
use crate::limits;

/// Runs a long computation of the core without the GIL. It hears of signals within a tenth of a second and stops for
/// them; `progress` is called every step.
pub(crate) fn attend<R: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(Control<'_>) -> Result<R, midair::Error> + Send,
) -> PyResult<R> {
    let memory = limits::memory()?;
    let mut watch = Watch::new(progress);
    let result = py.detach(|| work(Control::watched(&mut watch).with_memory(memory)));
    watch.raised()?;
    result.map_err(refused)
}

/// Watches a running computation for Python: signals are looked at every 50 ms, the progress callback is called every
/// step, and again within steps that take longer than a fifth of a second.
pub(crate) struct Watch {
    progress: Option<Py<PyAny>>,
    /// The last arguments of the callback, and their time.
    reported: (usize, usize, f64),
    called: Instant,
    /// When signals were last looked at.
    last: Instant,
    /// When the clock was, how many calls it is left alone for, and how many of them are to come.
    clock: Instant,
    stride: u32,
    left: u32,
    raised: Option<PyErr>,
}

impl Watch {
    /// Often enough that Ctrl-C feels immediate, seldom enough that taking the GIL costs nothing.
    const INTERVAL: Duration = Duration::from_millis(50);

    /// The longest time that a callback is left without a call.
    const PATIENCE: Duration = Duration::from_millis(200);

    pub(crate) fn new(progress: Option<Py<PyAny>>) -> Self {
        let now = Instant::now();
        let reported = (0, 1, 1.0);
        Self { progress, reported, called: now, last: now, clock: now, stride: 1, left: 0, raised: None }
    }

    /// Looks at signals if that is due, and calls the callback if it is to be.
    fn ask(&mut self, call: bool) -> ControlFlow<()> {
        let go_on = Python::attach(|py| -> PyResult<bool> {
            if self.last.elapsed() >= Self::INTERVAL {
                py.check_signals()?;
                self.last = Instant::now();
            }
            let Some(callback) = self.progress.as_ref().filter(|_| call) else { return Ok(true) };
            let answer = callback.call1(py, self.reported)?;
            self.called = Instant::now();
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

    /// The most steps that the clock is left alone for, and the most pulses: those to come may be a thousand times slower.
    const STEPS: u32 = 256;
    const PULSES: u32 = 4;

    /// Whether signals are to be looked at. A step of greedy takes a tenth of a microsecond and asking for the time a
    /// third of that, so the clock is left alone for as many calls as fill a tenth of the interval, `most` at most.
    fn due(&mut self, most: u32) -> bool {
        if self.left > 0 {
            self.left -= 1;
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

    /// The exception of a callback or signal, if there was one.
    pub(crate) fn raised(self) -> PyResult<()> {
        self.raised.map_or(Ok(()), Err)
    }
}

impl Observe for Watch {
    /// Called once a step, without the GIL.
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
