//! Control of a running solve: progress observer, stop request, trace of the residual.

use alloc::vec::Vec;
use core::fmt;
use core::ops::ControlFlow;

/// How far a solve is.
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    /// Steps done.
    pub step: usize,
    /// Steps in all.
    pub steps: usize,
    residual: &'a dyn Fn() -> f64,
}

impl Progress<'_> {
    /// The residual so far (see [`crate::Metrics`]); computed only when asked for.
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

type Observer<'a> = &'a mut dyn FnMut(Progress<'_>) -> ControlFlow<()>;

/// The caller's hand on a running solve: called once a step, it answers go or stop.
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
#[derive(Default)]
pub struct Control<'a> {
    observer: Option<Observer<'a>>,
    trace: Option<Vec<f64>>,
}

impl<'a> Control<'a> {
    /// Nobody watches.
    #[must_use]
    pub fn none() -> Self {
        Self::default()
    }

    /// `observer` is called after every step.
    pub fn watched(observer: Observer<'a>) -> Self {
        Self { observer: Some(observer), trace: None }
    }

    /// Also keeps the residual after every step.
    #[must_use]
    pub fn traced(mut self) -> Self {
        self.trace = Some(Vec::new());
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

    /// A solver's call after step `step` of `steps` (counted from 1); `residual` is computed only if somebody
    /// wants it. `Break` asks the solver to end with what it has.
    pub fn step(&mut self, step: usize, steps: usize, residual: impl Fn() -> f64) -> ControlFlow<()> {
        if let Some(trace) = &mut self.trace {
            trace.push(residual());
        }
        match &mut self.observer {
            Some(observer) => observer(Progress { step, steps, residual: &residual }),
            None => ControlFlow::Continue(()),
        }
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Control {{ watched: {}, traced: {} }}", self.observer.is_some(), self.trace.is_some())
    }
}
