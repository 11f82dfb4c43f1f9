//! One array, one method, many requests: everything kept between them.

pub(crate) mod batch;

use crate::control::Control;
use crate::error::Error;
use crate::problem::solution::Solution;
use crate::problem::{Aim, Problem, Start};
use crate::propagation::Model;
use crate::scene::Request;
use crate::solvers::{Configured, solve};
use crate::workspace::Workspace;

/// A solver with its array, its memory and its last solution: what a loop that follows a hand calls.
///
/// From the second call of a size on (all weights above 0) nothing is allocated.
///
/// ```
/// use midair::{Array, Control, InstructionSet, Medium, Request, Session, Model, solvers};
///
/// let model = Model::new(&Array::preset("paper20", [1, 1])?, Medium::default(), InstructionSet::best())?;
/// let mut session = Session::new(model, solvers::find("fast")?.configure(&[].into())?);
/// for step in 0..10 {
///     let points = [[1e-3 * f64::from(step), 0.0, 0.15]];
///     let solution = session.solve(&points, &Request::default(), None, &mut Control::none())?;
///     assert!(solution.metrics().accuracy > 0.99);
/// }
/// # Ok::<(), midair::Error>(())
/// ```
#[allow(missing_debug_implementations, reason = "a solver of a user's own need not have one")]
pub struct Session {
    model: Model,
    configured: Configured,
    /// Whether to balance: the method's own habit unless set.
    pub balance: bool,
    /// The level that a method that uses one aims at.
    pub aim: Option<Aim>,
    work: Workspace,
    problem: Option<Problem>,
    solution: Option<Solution>,
}

impl Session {
    /// A session of an array and a method.
    #[must_use]
    pub fn new(model: Model, configured: Configured) -> Self {
        let balance = configured.info.balance;
        let work = Workspace::new();
        Self { model, configured, balance, aim: None, work, problem: None, solution: None }
    }

    /// Solves for points (M, 3) in m. The solution stays readable until the next call.
    ///
    /// # Errors
    /// As [`Model::propagation`], [`Problem::with_propagation`], [`Problem::with_start`] and the method's own.
    pub fn solve(
        &mut self,
        points: &[[f64; 3]],
        request: &Request,
        start: Option<Start>,
        control: &mut Control,
    ) -> Result<&Solution, Error> {
        if let Some(solution) = self.solution.take() {
            self.work.recycle(solution);
        }
        let problem = match self.problem.take() {
            Some(problem) => problem.renewed(points, request)?,
            None => Problem::with_propagation(self.model.propagation(points)?, request)?,
        };
        let problem = match start {
            Some(start) => problem.with_start(start)?,
            None => problem,
        };
        let problem = match self.aim {
            Some(aim) => problem.with_aim(aim),
            None => problem,
        };
        let solution = solve(&problem, &*self.configured.solver, self.balance, &mut self.work, control)?;
        self.problem = Some(problem);
        Ok(self.solution.insert(solution))
    }

    /// The last solution, if the last call had one.
    #[must_use]
    pub fn solution(&self) -> Option<&Solution> {
        self.solution.as_ref()
    }

    /// The last solution, moved out: the next call allocates another.
    pub fn take(&mut self) -> Option<Solution> {
        self.solution.take()
    }

    /// The method.
    #[must_use]
    pub fn configured(&self) -> &Configured {
        &self.configured
    }
}
