//! Control of a running computation: progress, stop, trace of the residual, threads and memory.

use alloc::format;
use alloc::vec::Vec;
use core::fmt;
use core::ops::ControlFlow;
use core::sync::atomic::{AtomicBool, Ordering};

use crate::error::{Error, ErrorCode, Notice, Result};

/// How far a solve has progressed.
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    /// The number of steps done.
    pub step: usize,
    /// The number of all steps.
    pub steps: usize,
    residual: &'a dyn Fn() -> f64,
}

impl Progress<'_> {
    /// The residual so far (see [`crate::Metrics`]). It is computed when this function is called.
    pub fn residual(&self) -> f64 {
        (self.residual)()
    }
}

impl fmt::Debug for Progress<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "step {} of {}", self.step, self.steps)
    }
}

/// An observer of a computation. A closure that takes a [`Progress`] is one, called after every step.
pub trait Observe {
    /// Called after every step. `Break` stops the computation.
    fn step(&mut self, progress: Progress<'_>) -> ControlFlow<()>;

    /// Called many times per second within long steps. `Break` stops the computation.
    fn pulse(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(Progress<'_>) -> ControlFlow<()>> Observe for F {
    fn step(&mut self, progress: Progress<'_>) -> ControlFlow<()> {
        self(progress)
    }
}

/// The default limit on the memory of one computation, in bytes.
const MEMORY: u64 = 8_000_000_000;

/// Only one pulse in this many is passed on, because a row of the propagation matrix G takes only ten times as long as the
/// call.
const PULSES: u32 = 8;

/// Up to this many bytes are allowed without a test of the free memory.
const SMALL: u64 = 1 << 26;

/// The caller's control over a running computation: an observer, which is called after each step and may stop it, and the
/// allowed threads and memory.
///
/// ```
/// use core::ops::ControlFlow;
/// use midair::{Control, Problem, Scene, Solve, Status, Workspace, solvers::Greedy};
/// # let scene = midair::Scene::new(midair::Array::grid(8, 8, 10e-3)?, midair::Medium::default(),
/// #     vec![[0.0, 0.0, 0.1]], midair::Request::default())?;
///
/// let mut observer = |progress: midair::Progress| {
///     if progress.step < 10 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
/// };
/// let mut control = Control::watched(&mut observer);
/// let solution = Greedy::default().solve(&Problem::new(&scene)?, &mut Workspace::new(), &mut control)?;
/// assert_eq!((solution.status, solution.steps), (Status::Stopped, 10));
/// # Ok::<(), midair::Error>(())
/// ```
pub struct Control<'a> {
    observer: Option<&'a mut (dyn Observe + 'a)>,
    /// Whether steps are passed on to the observer, in addition to pulses.
    reported: bool,
    stop: Option<&'a AtomicBool>,
    /// Whether a stop was noticed. The final work after it is not interrupted again.
    received: bool,
    pulses: u32,
    trace: Option<Vec<f64>>,
    threads: usize,
    memory: u64,
}

impl Default for Control<'_> {
    fn default() -> Self {
        Self {
            observer: None,
            reported: true,
            stop: None,
            received: false,
            pulses: 0,
            trace: None,
            threads: 1,
            memory: MEMORY,
        }
    }
}

impl<'a> Control<'a> {
    /// Returns a control without an observer.
    pub fn none() -> Self {
        Self::default()
    }

    /// Returns a control whose `observer` is called after every step.
    pub fn watched(observer: &'a mut (dyn Observe + 'a)) -> Self {
        Self { observer: Some(observer), ..Self::default() }
    }

    /// Makes the control store the residual after every step, too.
    #[must_use]
    pub fn traced(mut self) -> Self {
        self.trace = Some(Vec::new());
        self
    }

    /// Sets the number of threads that share the work, 1 by default. They are started when there is work for them, and end
    /// with it. Results have the same bits for any number.
    #[must_use]
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads.max(1);
        self
    }

    /// Sets the limit on memory in bytes, 8 GB by default. A computation that needs more is an error.
    #[must_use]
    pub fn with_memory(mut self, bytes: u64) -> Self {
        self.memory = bytes;
        self
    }

    /// The stored residuals, one for each step; `None` without [`Control::traced`].
    pub fn into_trace(self) -> Option<Vec<f64>> {
        self.trace
    }

    /// Replaces the last stored residual. A method whose steps estimate the residual calls this when its solution is complete.
    pub fn correct(&mut self, residual: impl Fn() -> f64) {
        if let Some(last) = self.trace.as_mut().and_then(|trace| trace.last_mut()) {
            *last = residual();
        }
    }

    /// Solvers call this after step `step` of `steps`, counted from 1. `residual` is computed only if the caller needs it.
    /// After `Break` the solver must end with its best result so far.
    pub fn step(&mut self, step: usize, steps: usize, residual: impl Fn() -> f64) -> ControlFlow<()> {
        if let Some(trace) = &mut self.trace {
            trace.push(residual());
        }
        let answer = match &mut self.observer {
            Some(observer) if self.reported => observer.step(Progress { step, steps, residual: &residual }),
            _ => ControlFlow::Continue(()),
        };
        self.received |= answer.is_break();
        answer
    }

    /// Solvers call this within a long step, about once for each row of the propagation matrix G, many times per millisecond.
    ///
    /// # Errors
    /// [`Error::stopped`] once, if the caller stops. A solver then ends with its best result so far, if it has any.
    #[inline]
    pub fn pulse(&mut self) -> Result<()> {
        self.pulses = self.pulses.wrapping_add(1);
        if self.pulses.is_multiple_of(PULSES) { self.beat() } else { Ok(()) }
    }

    /// Passes a pulse on to the observer at once: before a stage that takes long and has no pulses.
    #[inline(never)]
    pub(crate) fn beat(&mut self) -> Result<()> {
        if self.received {
            return Ok(());
        }
        self.received = self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
            || self.observer.as_mut().is_some_and(|observer| observer.pulse().is_break());
        if self.received { Err(Error::stopped()) } else { Ok(()) }
    }

    /// Checks that `bytes` of memory can be allocated. `what` names the purpose for N transducers and M points.
    ///
    /// # Errors
    /// An error of the code [`ErrorCode::Memory`] if this exceeds the limit or the free memory.
    pub fn room(&self, what: &str, [transducers, points]: [usize; 2], bytes: u64) -> Result<()> {
        let spare = || Vec::<u8>::new().try_reserve_exact(usize::try_from(bytes).unwrap_or(usize::MAX)).is_ok();
        if bytes <= SMALL.min(self.memory) || (bytes <= self.memory && spare()) {
            return Ok(());
        }
        let [bytes, limit] = [bytes, self.memory].map(|bytes| format!("{:.3} GB", bytes as f64 * 1e-9));
        let item = format!("{what} of N = {transducers} transducers and M = {points} points");
        let cure = "give fewer points or transducers, a method without it, or a higher limit";
        let value = format!("{bytes}, the limit is {limit}");
        Err(Error::of(Notice::new(ErrorCode::Memory, item, value, cure).verb("needs").other(bytes)))
    }

    /// The number of parts that [`Control::each`] runs at the same time.
    pub(crate) fn threads(&self) -> usize {
        self.threads
    }

    /// Returns the control for a part of the work, which passes pulses to the observer, but no steps.
    pub(crate) fn part(&mut self) -> Control<'_> {
        Control {
            observer: self.observer.as_mut().map(|observer| &mut **observer as &mut dyn Observe),
            reported: false,
            stop: self.stop,
            threads: self.threads,
            memory: self.memory,
            ..Control::default()
        }
    }

    /// Calls `run` for every part, on all threads. Meanwhile the calling thread waits for a stop, after which no part begins.
    /// Returns the error of the first part that has one.
    pub(crate) fn each<T: Send>(
        &mut self,
        parts: Vec<T>,
        run: &(dyn Fn(T, &mut Control) -> Result<()> + Sync),
    ) -> Result<()> {
        // A part may be too short for a pulse that is passed on, so each begins with one.
        let begin = |part: T, control: &mut Control| control.beat().and_then(|()| run(part, control));
        #[cfg(feature = "std")]
        if self.threads.min(parts.len()) > 1 {
            let (stop, memory, threads) = (AtomicBool::new(false), self.memory, self.threads);
            let alone = |part: T| begin(part, &mut Control { stop: Some(&stop), memory, ..Control::default() });
            let results = crate::threads::spread(threads, parts, &stop, &mut || self.beat().is_ok(), &alone);
            return results.into_iter().collect();
        }
        parts.into_iter().try_for_each(|part| begin(part, &mut self.part()))
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Control {{ watched: {}, traced: {} }}", self.observer.is_some(), self.trace.is_some())
    }
}

/// The bytes of a list of numbers with `size` bytes each; its length is the product of `sides`.
pub(crate) fn bytes(size: usize, sides: &[usize]) -> u64 {
    sides.iter().fold(size as u64, |product, &side| product.saturating_mul(side as u64))
}
