//! Gerchberg-Saxton, called iterative back-propagation in acoustics: Marzo and Drinkwater, PNAS 116(1), 2019.
//!
//! q = 1; then p = G q keeps its phases and takes the target moduli, q = G^H p keeps its phases and takes the
//! modulus 1, and again. Starting from q = 1 is what the paper's authors do; starting from the back-projection
//! moves sigma by 0.007.

use crate::control::Control;
use crate::error::Error;
use crate::linalg::Planar;
use crate::problem::Problem;
use crate::problem::solution::{Solution, Status};
use crate::solvers::common::alternating_projection::Projector;
use crate::solvers::method::{Info, Method, Solve, check_iteration};
use crate::workspace::Workspace;

crate::options! {
    /// Gerchberg-Saxton. Time O(N M) a step, memory O(N M).
    pub struct Gs {
        /// Steps at most.
        pub steps: u32 = 100,
        /// Ends when no |p| changes by more than this part of its target in a step; 0 takes all steps.
        pub tolerance: f64 = 0.0,
    }
}

impl Method for Gs {
    const INFO: Info = Info {
        name: "gs",
        summary: "Gerchberg-Saxton, |q| = 1",
        source: "Marzo and Drinkwater, PNAS 116(1), 2019",
        balance: false,
        tolerance: 1e-3,
        uses_start: true,
        uses_aim: false,
    };

    fn check(&self) -> Result<(), Error> {
        check_iteration(self.steps, self.tolerance)
    }
}

impl Solve for Gs {
    fn solve(
        &self,
        problem: &Problem,
        work: &mut Workspace,
        control: &mut Control,
    ) -> Result<Solution, Error> {
        let mut projector = Projector::new(problem, work);
        let mut wanted = Planar::zeros(1, problem.propagation().lanes(), work);
        let steps = self.steps as usize;
        let (mut status, mut step) =
            (if self.tolerance > 0.0 { Status::OutOfSteps } else { Status::Done }, 0);
        while step < steps {
            projector.wanted(problem.targets(), &mut wanted);
            projector.back(&wanted);
            let change = projector.forward(problem.targets());
            step += 1;
            if control.step(step, steps, || problem.residual(projector.modulus())).is_break() {
                status = Status::Stopped;
                break;
            }
            if self.tolerance > 0.0 && f64::from(change) <= self.tolerance {
                status = Status::Done;
                break;
            }
        }
        wanted.give(work);
        let drive = projector.end(work);
        Ok(Solution::new(problem, drive, status, step, work))
    }
}
