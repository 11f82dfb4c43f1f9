//! Control of a running computation: progress, stop request, trace of the residual, threads and memory.

use alloc::vec::Vec;
use core::fmt;
use core::ops::ControlFlow;
use core::sync::atomic::{AtomicBool, Ordering};

use crate::error::Error;
use crate::threads::Threads;

/// The progress of a solve.
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    /// Steps done.
    pub step: usize,
    /// Steps in all.
    pub steps: usize,
    residual: &'a dyn Fn() -> f64,
}

impl Progress<'_> {
    /// The residual so far (see [`crate::Metrics`]); computed only on request.
    #[must_use]
    pub fn residual(&self) -> f64 {
        (self.residual)()
    }
}

impl fmt::Debug for Progress<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "step {} of {}", self.step, self.steps)
    }
}

/// Observer of a computation. A closure of [`Progress`] is called after every step.
pub trait Observe {
    /// Called after every step.
    fn step(&mut self, progress: Progress<'_>) -> ControlFlow<()>;

    /// Called within long steps, many times a second: is it to go on?
    fn pulse(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(Progress<'_>) -> ControlFlow<()>> Observe for F {
    fn step(&mut self, progress: Progress<'_>) -> ControlFlow<()> {
        self(progress)
    }
}

/// Bytes that a computation may take at once by default.
const MEMORY: u64 = 8_000_000_000;

/// One pulse of this many is passed on: a row of G takes but ten times as long as asking does.
const PULSES: u32 = 8;

/// Fewer bytes than this are taken without a check.
const SMALL: u64 = 1 << 26;

/// The caller's control over a running computation: a function that is called once a step and answers go or stop; and
/// the allowed threads and memory.
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
    /// Whether steps are reported in addition to pulses.
    reported: bool,
    stop: Option<&'a AtomicBool>,
    /// Whether a stop was noticed: the final work is not interrupted again.
    received: bool,
    pulses: u32,
    trace: Option<Vec<f64>>,
    threads: Threads,
    memory: u64,
}

impl Default for Control<'_> {
    fn default() -> Self {
        let threads = Threads::default();
        Self {
            observer: None,
            reported: true,
            stop: None,
            received: false,
            pulses: 0,
            trace: None,
            threads,
            memory: MEMORY,
        }
    }
}

impl<'a> Control<'a> {
    /// Without an observer.
    #[must_use]
    pub fn none() -> Self {
        Self::default()
    }

    /// `observer` is called after every step.
    pub fn watched(observer: &'a mut (dyn Observe + 'a)) -> Self {
        Self { observer: Some(observer), ..Self::default() }
    }

    /// Also keeps the residual after every step.
    #[must_use]
    pub fn traced(mut self) -> Self {
        self.trace = Some(Vec::new());
        self
    }

    /// The threads that share work.
    #[must_use]
    pub fn on(mut self, threads: Threads) -> Self {
        self.threads = threads;
        self
    }

    /// Rejects requests for more than this many bytes at once; 8 GB by default.
    #[must_use]
    pub fn with_memory(mut self, bytes: u64) -> Self {
        self.memory = bytes;
        self
    }

    /// The residuals kept, one a step.
    #[must_use]
    pub fn into_trace(self) -> Option<Vec<f64>> {
        self.trace
    }

    /// Replaces the last residual kept: for a method whose steps know only an estimate, once its answer is made.
    pub fn correct(&mut self, residual: impl Fn() -> f64) {
        if let Some(last) = self.trace.as_mut().and_then(|trace| trace.last_mut()) {
            *last = residual();
        }
    }

    /// Called by a solver after step `step` of `steps` (counted from 1); `residual` is computed only if the caller
    /// needs it. `Break` asks the solver to end with what it has.
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

    /// A call within a long step: once a row or so, many times a millisecond.
    ///
    /// # Errors
    /// [`Error::Stopped`] once, if it is not to go on: a solver ends with the best it has, if it has anything.
    #[inline]
    pub fn pulse(&mut self) -> Result<(), Error> {
        self.pulses = self.pulses.wrapping_add(1);
        if !self.pulses.is_multiple_of(PULSES) || self.received {
            return Ok(());
        }
        self.beat()
    }

    /// A pulse that is passed on.
    #[inline(never)]
    fn beat(&mut self) -> Result<(), Error> {
        self.received = self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
            || self.observer.as_mut().is_some_and(|observer| observer.pulse().is_break());
        if self.received { Err(Error::Stopped) } else { Ok(()) }
    }

    /// Requests memory before it is taken: `bytes` for `what`, of N transducers and M points.
    ///
    /// # Errors
    /// [`Error::Memory`] above the limit, or if they cannot be had.
    pub fn room(&self, what: &str, [transducers, points]: [usize; 2], bytes: u64) -> Result<(), Error> {
        let spare = || Vec::<u8>::new().try_reserve_exact(usize::try_from(bytes).unwrap_or(usize::MAX)).is_ok();
        if bytes <= SMALL.min(self.memory) || (bytes <= self.memory && spare()) {
            return Ok(());
        }
        Err(Error::Memory { what: what.into(), transducers, points, bytes, limit: self.memory })
    }

    /// The number of parts that [`Control::each`] does at once.
    pub(crate) fn threads(&self) -> usize {
        self.threads.count()
    }

    /// The control of a part of the work: pulses pass through, steps do not.
    pub(crate) fn part(&mut self) -> Control<'_> {
        Control {
            observer: self.observer.as_mut().map(|observer| &mut **observer as &mut dyn Observe),
            reported: false,
            stop: self.stop,
            memory: self.memory,
            ..Control::default()
        }
    }

    /// Every part in the hands of `run`, over all threads, while this one listens; the first error by index.
    pub(crate) fn each<T: Send>(
        &mut self,
        parts: Vec<T>,
        run: &(dyn Fn(T, &mut Control) -> Result<(), Error> + Sync),
    ) -> Result<(), Error> {
        let (stop, memory, threads) = (AtomicBool::new(false), self.memory, self.threads.clone());
        let alone = |part: T| run(part, &mut Control { stop: Some(&stop), memory, ..Control::default() });
        match threads.spread(parts, &stop, &mut || self.pulse().is_ok(), &alone) {
            Ok(results) => results.into_iter().collect(),
            Err(parts) => parts.into_iter().try_for_each(|part| run(part, &mut self.part())),
        }
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Control {{ watched: {}, traced: {} }}", self.observer.is_some(), self.trace.is_some())
    }
}

/// Bytes of this many numbers of `size` bytes, `sides` multiplied.
pub(crate) fn bytes(size: usize, sides: &[usize]) -> u64 {
    sides.iter().fold(size as u64, |product, &side| product.saturating_mul(side as u64))
}
