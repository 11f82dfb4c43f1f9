//! Worker: the memory in which one thread reads and solves requests, 16 at a time.

use crate::problem::Setup;
use crate::propagation::{Model, Propagation};
use crate::scene::{Aim, Request, Scene, Start};
use crate::session::batch::{Outcome, Tally};
use crate::session::parts::Part;
use crate::solvers::common::interleaved_batch;
use crate::solvers::prelude::*;
use crate::solvers::remark::remarks;
use crate::solvers::solve::{solve, solve_interleaved};

/// One request to a session.
#[derive(Clone, Debug, Default)]
pub struct SolveRequest {
    /// Points (M, 3) in m; empty for a user's own propagation matrix G.
    pub points: Vec<[f64; 3]>,
    /// The targets and weights.
    pub request: Request,
    /// The start of an iterative method.
    pub start: Option<Start>,
    /// The aim, for a method that has one; `None` stands for the aim of the problem.
    pub aim: Option<Aim>,
}

impl SolveRequest {
    /// Returns the request of a scene: its points, targets and weights, and the aim of its solver.
    pub fn of_scene(scene: &Scene) -> Self {
        Self {
            points: scene.points().to_vec(),
            request: scene.request().clone(),
            start: None,
            aim: scene.solver.as_ref().and_then(|choice| choice.aim),
        }
    }

    /// Writes other points (M, 3) in m, pressures, phases and weights (M,) over those of this request, and reuses its memory.
    pub fn write(&mut self, points: &[[f64; 3]], [pressures, phases, weights]: [Option<&[f64]>; 3]) {
        self.points.clear();
        self.points.extend_from_slice(points);
        let request = &mut self.request;
        let lists = [&mut request.pressures, &mut request.phases, &mut request.weights];
        for (list, with) in lists.into_iter().zip([pressures, phases, weights]) {
            match with {
                None => *list = None,
                Some(with) => {
                    let list = list.get_or_insert_default();
                    list.clear();
                    list.extend_from_slice(with);
                }
            }
        }
    }
}

/// Where the matrix G of a session comes from.
pub(super) enum Transducers {
    /// The propagation matrix G is computed at the points of each request.
    Model(Model),
    /// The propagation matrix G is the same matrix for all requests, given by the user.
    Given(Propagation),
}

impl Transducers {
    pub(super) fn count(&self, setup: &Setup) -> usize {
        match self {
            Self::Model(model) => model.array().len(),
            Self::Given(propagation) => setup.transducers(propagation.transducers()),
        }
    }

    pub(super) fn points(&self) -> Option<usize> {
        match self {
            Self::Model(_) => None,
            Self::Given(propagation) => Some(propagation.points()),
        }
    }
}

/// What all requests of a session have in common.
pub(super) struct Task {
    pub(super) transducers: Transducers,
    pub(super) setup: Arc<Setup>,
    pub(super) solver: Arc<dyn Solve + Send + Sync>,
    pub(super) balance: bool,
}

impl Task {
    /// Writes a request into problem `k`, which is added if there is none. The sums of |G| and the targets are still missing
    /// then.
    pub(super) fn read(&self, problems: &mut Vec<Problem>, k: usize, ask: &SolveRequest) -> Result<()> {
        let points = match &self.transducers {
            Transducers::Model(_) => Some(&ask.points[..]),
            Transducers::Given(_) if ask.points.is_empty() => None,
            Transducers::Given(_) => return Err(Error::given_points()),
        };
        if k == problems.len() {
            let propagation = match &self.transducers {
                Transducers::Model(model) => model.driven(&ask.points)?,
                Transducers::Given(propagation) => propagation.clone(),
            };
            problems.push(Problem::unasked(propagation, Arc::clone(&self.setup)));
        }
        let problem = &mut problems[k];
        problem.replace(points, &ask.request)?;
        problem.aim = ask.aim;
        ask.start.clone().map_or(Ok(()), |start| problem.begin(start))
    }
}

/// The memory that a thread reuses from problem to problem.
#[derive(Default)]
pub(super) struct Worker {
    pub(super) problems: Vec<Problem>,
    pub(super) work: Workspace,
    /// The remarks about the problems of the present batch that this worker has solved.
    pub(super) tally: Tally,
    ask: SolveRequest,
}

/// The number of points in each problem of a batch, and the function that writes the request of a problem.
#[derive(Clone, Copy)]
pub(super) struct Requests<'a> {
    pub(super) points: usize,
    pub(super) ask: &'a (dyn Fn(usize, &mut SolveRequest) -> Result<()> + Sync),
}

impl Worker {
    /// Reads and solves the problems of a part; after a stop, the remaining drives are 0.
    pub(super) fn run(
        &mut self,
        mut part: Part<'_>,
        task: &Task,
        requests: Requests<'_>,
        control: &mut Control,
    ) -> Result<()> {
        let first = part.first;
        let mut done = 0;
        while done < part.len() {
            let end = part.len().min(done + LANES);
            let solved = self.solve_range(&mut part, done..end, task, requests, control);
            match solved.and_then(|()| control.pulse().map_err(|error| (end, error))) {
                Ok(()) => done = end,
                Err((index, error)) => {
                    if error.is_stop() {
                        part.silence(index);
                    }
                    return Err(error.of_one("problems", first + index));
                }
            }
        }
        Ok(())
    }

    /// Reads and solves the problems `range` of a part. An error comes with the index of the problem in the part.
    fn solve_range(
        &mut self,
        part: &mut Part<'_>,
        range: Range<usize>,
        task: &Task,
        requests: Requests<'_>,
        control: &mut Control,
    ) -> Result<(), (usize, Error)> {
        let start = range.start;
        let (count, refused) = self.prepare(part.first + start, range.len(), task, requests, control);
        let refused = refused.map_err(|(k, error)| (start + k, error));
        let problems = &self.problems[..count];
        let (solver, balance, work, tally) = (&*task.solver, task.balance, &mut self.work, &mut self.tally);
        let mut keep = |k: usize, solution: &Solution| {
            let problem = &problems[k];
            let remarks = remarks(problem, solver, balance, None, solution, problem.beyond_alone());
            tally.add(part.first + start + k, &remarks);
            part.keep(start + k, solution, Outcome::of(solution, &remarks));
        };
        let solutions = solve_interleaved(problems, solver, balance, work);
        if let Some(solutions) = solutions.map_err(|(k, error)| (start + k, error))? {
            for (k, solution) in solutions.into_iter().enumerate() {
                keep(k, &solution);
                solution.recycle(work);
            }
            return refused;
        }
        for (k, problem) in problems.iter().enumerate() {
            let at = |error| (start + k, error);
            let solution = solve(problem, solver, balance, work, &mut control.part()).map_err(at)?;
            refuse_if!(solution.status == Status::Stopped, at(Error::stopped()));
            keep(k, &solution);
            solution.recycle(work);
        }
        refused
    }

    /// Reads up to 16 problems, from `first` of the batch on. Returns the number of problems before the first one
    /// with an error, and this error with its index. If an earlier problem fails when it is solved, its error counts
    /// as the first.
    pub(super) fn prepare(
        &mut self,
        first: usize,
        count: usize,
        task: &Task,
        requests: Requests<'_>,
        control: &mut Control,
    ) -> (usize, Result<(), (usize, Error)>) {
        let (mut read, mut refused) = (count, Ok(()));
        for k in 0..count {
            if let Err(error) = self.read(k, first + k, task, requests) {
                (read, refused) = (k, Err((k, error)));
                break;
            }
        }
        let summed = interleaved_batch::sum_moduli(&mut self.problems[..read], &self.work);
        for (k, problem) in self.problems[..read].iter_mut().enumerate() {
            let measured = if summed { Ok(()) } else { problem.sum_moduli(control) };
            if let Err(error) = measured.and_then(|()| problem.balance_targets()) {
                return (k, Err((k, error)));
            }
        }
        (read, refused)
    }

    /// Reads the request of problem `index` into the worker's problem `k`.
    fn read(&mut self, k: usize, index: usize, task: &Task, requests: Requests<'_>) -> Result<()> {
        (self.ask.start, self.ask.aim) = (None, None);
        (requests.ask)(index, &mut self.ask)?;
        let points = task.transducers.points().unwrap_or(self.ask.points.len());
        if points != requests.points {
            let cure = format!("give {} as all problems of the batch have", requests.points);
            return Err(Error::shape("points", format!("{points} of them"), cure));
        }
        task.read(&mut self.problems, k, &self.ask)
    }
}
