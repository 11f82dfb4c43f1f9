//! descent: least squares over all phases and amplitudes, for pictures and other large sets of points.
//!
//! It is L-BFGS ([`crate::solvers::common::least_squares`]) with the steps of [`crate::solvers::even_field::nearest`].

use crate::solvers::common::least_squares::Task;
use crate::solvers::even_field::nearest::nearest;
use crate::solvers::prelude::*;

options! {
    /// L-BFGS on the phases, then on amplitudes too. Time O(N M) a step, memory O(N M).
    pub struct Descent {
        /// Largest number of steps of the best start.
        pub steps: u32 = 500,
        /// Ends when ten steps lower the error (the root of the residual) by less than this part of it.
        pub tolerance: f64 = 5e-4,
        /// Number of starts, each followed for a fifth of the steps: a focus behind the points whose cone covers them, then
        /// one in front of them, then random phases. Points among the transducers start with all in phase instead.
        pub starts: u32 = 3,
        /// Seed of the random phases, 0 to 2^64 - 1.
        pub seed: u64 = 0,
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

    fn check(&self) -> Result<()> {
        refuse_if!(self.starts == 0, Error::out_of_range("starts", self.starts, "give at least 1"));
        check_iteration(self.steps, self.tolerance)
    }
}

impl Solve for Descent {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let Self { steps, tolerance, starts, seed } = *self;
        let (steps, starts) = (steps as usize, starts as usize);
        nearest(problem, Task { steps, tolerance, starts, seed, factor: 1.0, before: 0 }, work, control)
    }

    facts!(finds_level = true, meets_targets = true);
}
