//! descent: least squares over all phases, for pictures and other large sets of points.
//!
//! L-BFGS on the phases ([`crate::solvers::common::least_squares`]), from which Gauss-Newton steps go on to fields that meet every
//! target, where these are near.

use crate::control::Control;
use crate::error::Error;
use crate::problem::{Problem, Solution, Status};
use crate::solvers::common::least_squares::{LeastSquares, Task, least_squares};
use crate::solvers::even_field::targets::{met, too_many};
use crate::solvers::method::{Info, Method, Solve, check_iteration};
use crate::workspace::Workspace;

options! {
    /// L-BFGS on the phases, one amplitude for all. Time O(N M) a step, memory O(N M).
    pub struct Descent {
        /// Steps of the best start, at most.
        pub steps: u32 = 500,
        /// Ends when ten steps lower the error (the root of the residual) by less than this part of it.
        pub tolerance: f64 = 5e-4,
        /// Starts, each followed for a fifth of the steps: a focus whose cone covers the points, behind them, then in front
        /// of them (amid the transducers all in phase instead), then random phases at the points.
        pub starts: u32 = 3,
        /// Seed of these phases, 0 to 2^64 - 1.
        pub seed: u64 = 0,
    }
}

/// Steps of points that are to be all alike: their error falls on and on, where that of a picture comes to an end.
const STEPS_ALIKE: u32 = 1500;

impl Descent {
    /// In place of a method that makes points even, where these are too many.
    pub(crate) fn instead(problem: &Problem) -> Option<Self> {
        let alike = problem.targets()[..problem.propagation().points()].windows(2).all(|pair| pair[0] == pair[1]);
        let steps = if alike { STEPS_ALIKE } else { Self::default().steps };
        too_many(problem).then(|| Self { steps, ..Self::default() })
    }
}

impl Method for Descent {
    const INFO: Info = Info::new(
        "descent",
        "least squares over all phases: pictures, and more points than can be even",
        "L-BFGS (Nocedal and Wright 2006, chapter 7) on eq. (7) of Suzuki et al. 2021",
    )
    .balanced()
    .with_start()
    .within(0.02);

    fn check(&self) -> Result<(), Error> {
        if self.starts == 0 {
            return Err(Error::invalid("starts", self.starts, "give at least 1"));
        }
        check_iteration(self.steps, self.tolerance)
    }
}

impl Solve for Descent {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution, Error> {
        let task = Task {
            steps: self.steps as usize,
            tolerance: self.tolerance,
            starts: self.starts as usize,
            seed: self.seed,
            factor: 1.0,
            before: 0,
        };
        let LeastSquares { mut drive, mut status, steps } = least_squares(problem, &task, work, control)?;
        if status != Status::Stopped
            && let Some(even) = met(problem, &drive, steps, work, control)?
        {
            work.complexes.give(core::mem::replace(&mut drive, even));
            status = Status::Done;
        }
        Solution::new(problem, drive, (status, steps.0), steps.1, work, control)
    }
}
