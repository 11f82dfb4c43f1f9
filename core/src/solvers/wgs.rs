//! Weighted Gerchberg-Saxton: each point's wanted modulus grows while the point lags behind, until all are even.
//!
//! The weighting of Di Leonardo, Ianni and Ruocco (Optics Express 15(4), 2007), its exponent damped: with the
//! full ratio two points take turns at winning. The iterate whose worst point is best is kept.

use crate::control::Control;
use crate::error::Error;
use crate::linalg::Planar;
use crate::math::sqrtf;
use crate::problem::Problem;
use crate::problem::solution::{Solution, Status};
use crate::solvers::common::alternating_projection::Projector;
use crate::solvers::method::{Info, Method, Solve, check_iteration};
use crate::workspace::Workspace;

crate::options! {
    /// Weighted Gerchberg-Saxton, damped. Time O(N M) a step, memory O(N M).
    pub struct Wgs {
        /// Steps at most.
        pub steps: u32 = 100,
        /// Ends when 1 - uniformity is at most this; 0 takes all steps.
        pub tolerance: f64 = 0.0,
    }
}

impl Method for Wgs {
    const INFO: Info = Info {
        name: "wgs",
        summary: "weighted Gerchberg-Saxton, damped, |q| = 1, best iterate kept",
        source: "Di Leonardo et al., Optics Express 15(4), 2007",
        balance: true,
        tolerance: 5e-3,
        uses_start: true,
        uses_aim: false,
    };

    fn check(&self) -> Result<(), Error> {
        check_iteration(self.steps, self.tolerance)
    }
}

/// min, mean and max of |p|/target over the points with a target.
fn spread(moduli: &[f32], targets: &[f32]) -> (f32, f32, f32) {
    let (mut low, mut sum, mut high, mut count) = (f32::INFINITY, 0.0, 0.0_f32, 0.0);
    for (&modulus, &target) in moduli.iter().zip(targets).filter(|(_, target)| **target > 0.0) {
        let x = modulus / target;
        (low, sum, high, count) = (low.min(x), sum + x, high.max(x), count + 1.0);
    }
    (low, sum / count, high)
}

impl Solve for Wgs {
    fn solve(
        &self,
        problem: &Problem,
        work: &mut Workspace,
        control: &mut Control,
    ) -> Result<Solution, Error> {
        let mut projector = Projector::new(problem, work);
        let lanes = problem.propagation().lanes();
        let mut wanted = Planar::zeros(1, lanes, work);
        let mut raised = work.floats.take(lanes);
        raised.copy_from_slice(problem.targets());
        let mut best = work.complexes.take(problem.propagation().transducers());
        let mut best_moduli = work.floats.take(lanes);
        // The start is the first candidate: an answer is never worse than what it began with.
        let mut worst = spread(projector.modulus(), problem.targets()).0;
        best.copy_from_slice(projector.drive());
        best_moduli.copy_from_slice(projector.modulus());
        let steps = self.steps as usize;
        let (mut status, mut step) =
            (if self.tolerance > 0.0 { Status::OutOfSteps } else { Status::Done }, 0);
        while step < steps {
            projector.wanted(&raised, &mut wanted);
            projector.back(&wanted);
            projector.forward(problem.targets());
            step += 1;
            let (low, mean, high) = spread(projector.modulus(), problem.targets());
            if low > worst {
                worst = low;
                best.copy_from_slice(projector.drive());
                best_moduli.copy_from_slice(projector.modulus());
            }
            if control.step(step, steps, || problem.residual(&best_moduli)).is_break() {
                status = Status::Stopped;
                break;
            }
            if self.tolerance > 0.0 && f64::from(1.0 - low / high) <= self.tolerance {
                status = Status::Done;
                break;
            }
            for ((raised, &modulus), &target) in
                raised.iter_mut().zip(projector.modulus()).zip(problem.targets())
            {
                if target > 0.0 && mean > 0.0 {
                    // The damped exponent 1/2; a silent point may at most double.
                    let lag = (mean * target / modulus).min(4.0);
                    *raised *= sqrtf(lag);
                }
            }
            // Only ratios matter: the largest is brought back to 1.
            let largest = raised.iter().copied().fold(0.0, f32::max);
            for x in &mut raised {
                *x /= largest;
            }
        }
        work.floats.give_all([raised, best_moduli]);
        wanted.give(work);
        let last = projector.end(work);
        work.complexes.give(last);
        Ok(Solution::new(problem, best, status, step, work))
    }
}
