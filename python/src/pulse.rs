//! What a running solve or field tells Python, and hears from it.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use midair::Progress;
use pyo3::prelude::*;

/// A running solve's contact with Python: signals are looked at now and then, progress is told every step.
pub(crate) struct Pulse {
    progress: Option<Py<PyAny>>,
    last: Instant,
    raised: Option<PyErr>,
}

impl Pulse {
    /// Often enough that Ctrl-C feels immediate, seldom enough that taking the GIL costs nothing.
    const INTERVAL: Duration = Duration::from_millis(50);

    pub(crate) fn new(progress: Option<Py<PyAny>>) -> Self {
        Self { progress, last: Instant::now(), raised: None }
    }

    /// Called once a step, without the GIL.
    pub(crate) fn beat(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        if self.progress.is_none() && self.last.elapsed() < Self::INTERVAL {
            return ControlFlow::Continue(());
        }
        let told = Python::attach(|py| -> PyResult<bool> {
            if self.last.elapsed() >= Self::INTERVAL {
                py.check_signals()?;
                self.last = Instant::now();
            }
            let Some(callback) = &self.progress else { return Ok(true) };
            let answer = callback.call1(py, (progress.step, progress.steps, progress.residual()))?;
            // Only False stops: a callback that returns nothing goes on.
            Ok(answer.extract::<bool>(py).unwrap_or(true))
        });
        match told {
            Ok(true) => ControlFlow::Continue(()),
            Ok(false) => ControlFlow::Break(()),
            Err(error) => {
                self.raised = Some(error);
                ControlFlow::Break(())
            }
        }
    }

    /// The exception of a callback or signal, if there was one.
    pub(crate) fn raised(self) -> PyResult<()> {
        self.raised.map_or(Ok(()), Err)
    }
}
