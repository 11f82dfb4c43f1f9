//! Session: one array and one method for one request or many, with memory that is reused.

pub(crate) mod batch;
pub(crate) mod follow;
pub(crate) mod judging;
pub(crate) mod moving;
pub(crate) mod moving_solver;
pub(crate) mod parts;
pub(crate) mod worker;

pub use batch::Batch;
pub use follow::Frames;
pub use moving::{FOLLOWER, Moving, Pace, Pull, Trajectory, meant, sight};
pub use moving_solver::{MovingSolver, Played};
pub use worker::SolveRequest;

use crate::problem::Setup;
use crate::propagation::{Model, Propagation};
use crate::scene::{Choice, Options, Vicinity, contrary};
use crate::session::batch::{Outcome, Tally};
use crate::session::parts::{Part, parts};
use crate::session::worker::{Requests, Task, Transducers, Worker};
use crate::solvers::prelude::*;
use crate::solvers::remark::{FALLEN, FAST, KINDS, fallen, fast};
use crate::solvers::solve::solve_after;
use crate::solvers::{DEFAULT, Last, Remark, configure, remarks};

/// How many entries of the propagation matrix G a thread computes between two calls of the control. This takes `fast` about 100
/// us, much longer than to wake a thread.
const STRETCH: usize = 1 << 17;

/// A solver with its array, its memory and its last solution, for loops such as the tracking of a hand.
///
/// From the second call with the same sizes on, no memory is allocated if all weights are above 0.
///
/// ```
/// use midair::{Array, SolveRequest, Control, InstructionSet, Medium, Model, Session, solvers};
///
/// let model = Model::new(&Array::preset("paper20", [1, 1])?, Medium::default(), InstructionSet::best())?;
/// let mut session = Session::new(model, solvers::find("fast")?.configure(&[].into())?.solver, true);
/// let mut ask = SolveRequest::default();
/// for step in 0..10 {
///     ask.points = vec![[1e-3 * f64::from(step), 0.0, 0.15]];
///     let solution = session.solve(&ask, &mut Control::none())?;
///     assert!(solution.metrics().accuracy > 0.99);
/// }
/// # Ok::<(), midair::Error>(())
/// ```
pub struct Session {
    task: Task,
    workers: Vec<Worker>,
    solution: Option<Solution>,
    /// The memory of the last frame, for solvers that use it.
    last: Last,
    /// For each kind of remark, whether it has been made.
    reported: [bool; KINDS],
    /// The points of the last frame, for solvers with a bound, and the first remark about points that are too fast for it.
    before: Vec<[f64; 3]>,
    fast: Option<Remark>,
    /// Whether the session has searched for a proof that no drive gives all targets together.
    looked: bool,
    /// The region in which points are plausible; `None` after the first warning about a point outside of it.
    vicinity: Option<Vicinity>,
    /// Whether points have been checked for different pressures at one place.
    compared: bool,
}

impl Session {
    /// Returns a session for an array and a solver; `balance` says whether it balances.
    pub fn new(model: Model, solver: impl Into<Arc<dyn Solve + Send + Sync>>, balance: bool) -> Self {
        let setup = Arc::new(Setup::of_model(&model));
        let vicinity = Some(Vicinity::of(model.array()));
        let solver = solver.into();
        let transducers = Transducers::Model(model.for_rows(solver.computes_rows()));
        Self::of(Task { transducers, setup, solver, balance }, vicinity)
    }

    /// Returns a session for an array and a chosen solver, by default [`DEFAULT`].
    ///
    /// # Errors
    /// The errors of [`configure`].
    pub fn chosen(model: Model, choice: Option<&Choice>) -> Result<Self> {
        let default = || Choice::new(DEFAULT.into(), Options::new());
        let choice = choice.cloned().map_or_else(default, Ok)?;
        let configured = configure(&choice, model.array().quantization())?;
        let balance = choice.balance.unwrap_or(configured.info.balance);
        Ok(Self::new(model, configured.solver, balance))
    }

    /// Returns a session for a user's own propagation matrix G, the setup of its array, and a solver. Its requests have no
    /// points.
    ///
    /// # Errors
    /// Another number of positions than transducers, a medium out of range.
    pub fn with_propagation(
        propagation: Propagation,
        setup: Setup,
        solver: impl Into<Arc<dyn Solve + Send + Sync>>,
        balance: bool,
    ) -> Result<Self> {
        let propagation = propagation.driven(setup.channels.as_ref())?;
        setup.check(&propagation)?;
        let transducers = Transducers::Given(propagation);
        Ok(Self::of(Task { transducers, setup: Arc::new(setup), solver: solver.into(), balance }, None))
    }

    fn of(task: Task, vicinity: Option<Vicinity>) -> Self {
        let compared = vicinity.is_none();
        Self {
            task,
            workers: Vec::new(),
            solution: None,
            last: Last::default(),
            reported: [false; KINDS],
            before: Vec::new(),
            fast: None,
            looked: false,
            vicinity,
            compared,
        }
    }

    /// Solves one request. The solution is available until the next call.
    ///
    /// # Errors
    /// The errors of [`Model::propagation`], [`Problem::with_propagation`], [`Problem::with_start`] and the method; points for
    /// a user's own propagation matrix G.
    pub fn solve(&mut self, ask: &SolveRequest, control: &mut Control) -> Result<&Solution> {
        if self.workers.is_empty() {
            self.workers.push(Worker::default());
        }
        let Worker { problems, work, .. } = &mut self.workers[0];
        if let Some(solution) = self.solution.take() {
            solution.recycle(work);
        }
        self.task.read(problems, 0, ask)?;
        let problem = &mut problems[0];
        problem.measure(control)?;
        if let Some(bound) = self.task.solver.bound().filter(|&bound| bound < PI) {
            if !self.last.is_empty() && self.before.len() == ask.points.len() {
                self.fast = self.fast.or_else(|| fast(&self.task.setup, bound, &self.before, &ask.points));
            }
            self.before.clone_from(&ask.points);
        }
        let last = Some(&mut self.last);
        let solution = solve_after(problem, &*self.task.solver, self.task.balance, last, work, control)?;
        Ok(self.solution.insert(solution))
    }

    /// The memory of the last frame. After it is cleared, the next frame is solved like the first one.
    pub fn last(&mut self) -> &mut Last {
        &mut self.last
    }

    /// Solves B = `count` requests of M = `points` points each. `ask` is called with the index of a problem and writes its
    /// request, over the request of an earlier problem. The drive of the problem is written into its row of `drives` (B, N).
    /// Each result has the same bits as that of [`Session::solve`], whatever the number of threads.
    ///
    /// The call needs memory for the output, and for a workspace and 16 problems in each thread. More problems need
    /// no more memory if all weights are above 0 and `ask` reuses the lists of the request.
    ///
    /// `control` is called after every few problems, with the mean residual so far. After a stop, the remaining problems have a
    /// drive of 0 and the status [`crate::Status::Stopped`].
    ///
    /// # Errors
    /// `drives` of another length; the error of the first problem that is rejected or has another number of points, with its
    /// index.
    ///
    /// ```
    /// use midair::{Array, SolveRequest, Complex32, Control, InstructionSet, Medium, Model, Session, solvers};
    ///
    /// let model = Model::new(&Array::preset("paper20", [1, 1])?, Medium::default(), InstructionSet::best())?;
    /// let mut session = Session::new(model, solvers::find("fast")?.configure(&[].into())?.solver, true);
    /// let mut drives = vec![Complex32::ZERO; 100 * 400];
    /// let ask = |k: usize, ask: &mut SolveRequest| {
    ///     ask.points.clear();
    ///     ask.points.extend([[0.0, 0.0, 0.15], [1e-3 * k as f64, 0.05, 0.15]]);
    ///     Ok(())
    /// };
    /// let batch = session.solve_batch(100, 2, &ask, &mut drives, &mut Control::none())?;
    /// assert!(batch.metrics.iter().all(|metrics| metrics.accuracy > 0.8));
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn solve_batch(
        &mut self,
        count: usize,
        points: usize,
        ask: &(dyn Fn(usize, &mut SolveRequest) -> Result<()> + Sync),
        drives: &mut [Complex32],
        control: &mut Control,
    ) -> Result<Batch> {
        let taken = bytes(8, &[count, points]).saturating_add(bytes(size_of::<Outcome>(), &[count]));
        let (transducers, threads, share) = self.shared_out(count, points, drives.len(), taken, control)?;
        let (task, requests) = (&self.task, Requests { points, ask });
        let workers = &mut self.workers[..threads];
        let mut pressures = vec![Complex32::ZERO; count * points];
        let mut outcomes = vec![Outcome::default(); count];
        for worker in &mut *workers {
            worker.tally = Tally::default();
        }
        let mut done = 0;
        while done < count {
            let end = count.min(done + share * threads);
            let parts = parts(drives, &mut pressures, &mut outcomes, done..end, share);
            let pairs = parts.into_iter().zip(&mut *workers).collect();
            let run = |(part, worker): (Part<'_>, &mut Worker), control: &mut Control| {
                worker.run(part, task, requests, control)
            };
            done = end;
            match control.each(pairs, &run) {
                Err(error) if error.is_stop() => {
                    drives[done * transducers..].fill(Complex32::ZERO);
                    break;
                }
                outcome => outcome?,
            }
            let residuals = outcomes[..done].iter().map(|outcome| outcome.metrics.residual);
            if control.step(done, count, || residuals.clone().sum::<f64>() / done as f64).is_break() {
                drives[done * transducers..].fill(Complex32::ZERO);
                break;
            }
        }
        let mut tally = Tally::default();
        for worker in &*workers {
            tally.merge(&worker.tally);
        }
        Ok(Batch::of(pressures, &outcomes, &tally))
    }

    /// Checks the size of a batch. Returns the number of transducers, the number of threads, and how many problems a thread
    /// takes at a time; there is then a worker for each thread.
    fn shared_out(
        &mut self,
        count: usize,
        points: usize,
        drives: usize,
        memory: u64,
        control: &mut Control,
    ) -> Result<(usize, usize, usize)> {
        if count == 0 || points == 0 {
            return Err(Error::out_of_range("batch", count, "give at least one problem and one point"));
        }
        let (transducers, threads) = (self.transducers(), control.threads());
        if drives != count * transducers {
            let cure = format!("give {count} times {transducers}");
            return Err(Error::shape("drives", format!("{drives} values"), cure));
        }
        control.room("the answers", [transducers, points], memory)?;
        if self.workers.len() < threads {
            self.workers.resize_with(threads, Worker::default);
        }
        Ok((transducers, threads, LANES * (STRETCH / (LANES * transducers * points)).max(1)))
    }

    /// Returns the warnings about the last solution, each kind once in a session. The search for a proof of
    /// [`Problem::beyond`] and that for beads that fall take time and are made only once, the latter not after
    /// [`Session::follow`].
    pub fn remarks(&mut self) -> impl Iterator<Item = Remark> + use<> {
        let (Some(problem), Some(solution)) = (self.problem(), self.solution()) else {
            return [None; KINDS].into_iter().flatten();
        };
        let Task { solver, balance, .. } = &self.task;
        let mut beyond = problem.beyond_alone();
        let first = beyond.is_none() && problem.is_doubtful() && !self.looked;
        if first {
            beyond = problem.beyond(&mut Control::none()).ok().flatten();
        }
        let mut remarks = remarks(problem, &**solver, *balance, Some(&self.last), solution, beyond);
        if !self.reported[FALLEN] {
            remarks[FALLEN] = fallen(solution, &mut Control::none()).ok().flatten();
        }
        remarks[FAST] = self.fast.take();
        self.looked |= first;
        for (reported, remark) in self.reported.iter_mut().zip(&mut remarks) {
            *remark = remark.filter(|_| !*reported);
            *reported |= remark.is_some();
        }
        self.reported[FALLEN] = true;
        remarks.into_iter().flatten()
    }

    /// Returns probable mistakes in the points of a request. A point far beyond the array, behind it or too near is reported
    /// once in a session. Different pressures at one place are reported only for the first request. The check takes some
    /// comparisons for each point.
    pub fn doubts(&mut self, ask: &SolveRequest) -> Vec<Notice> {
        let far = self.far(&ask.points, |j| format!("points[{j}].position"));
        let first = !core::mem::replace(&mut self.compared, true);
        let contrary = first.then(|| contrary(self.task.setup.medium, &ask.points, &ask.request)).flatten();
        far.into_iter().chain(contrary).collect()
    }

    /// Does the same as [`Session::doubts`] for all points (B, M, 3) of a batch, with `each` = M. It reports only
    /// points far beyond the array, behind it or too near.
    pub fn batch_doubts(&mut self, points: &[[f64; 3]], each: usize) -> Option<Notice> {
        self.far(points, |k| format!("problems[{}].points[{}].position", k / each, k % each))
    }

    fn far(&mut self, points: &[[f64; 3]], name: impl Fn(usize) -> String) -> Option<Notice> {
        let far = self.vicinity.as_ref()?.doubt(self.task.setup.medium, points, name)?;
        self.vicinity = None;
        Some(far)
    }

    /// Takes the last solution out of the session; the next call then allocates memory for another.
    pub fn take(&mut self) -> Option<Solution> {
        self.solution.take()
    }
}

getters! {
    Session:

    /// The problem of the last request.
    pub problem(self) -> Option<&Problem> = self.workers.first()?.problems.first();

    /// The last solution, if the last call was successful.
    pub solution(self) -> Option<&Solution> = self.solution.as_ref();

    /// The number of transducers N.
    pub transducers(self) -> usize = self.task.transducers.count(&self.task.setup);

    /// The number of points M of a user's own propagation matrix G; `None` for other sessions.
    pub given_points(self) -> Option<usize> = self.task.transducers.points();
}
