//! uniform: even points at the highest common level, or as loud as requested.

use crate::solvers::even_field;
use crate::solvers::even_field::run::{Plan, QUIET, SWEEPS};
use crate::solvers::prelude::*;

options! {
    /// Even fields, |q| = 1 before all drives are reduced to the targets. Time O(N M^2 + M^3), memory O(N M + M^2).
    pub struct Uniform {
        /// Weighted Gerchberg-Saxton sweeps before the Gauss-Newton steps.
        pub steps: u32 = SWEEPS,
        /// Ends when no point is off the common level by more than this part of it.
        pub tolerance: f64 = 1e-5,
        /// Allowed leak of a quiet point, relative to the loudest point. It is divided by the point's weight, relative to the
        /// largest weight of a target.
        pub quiet: f64 = QUIET,
    }
}

impl Method for Uniform {
    const INFO: Info = Info::new(
        "uniform",
        "even points at the highest common level, |q| alike",
        "point phases in line, weighted Gerchberg-Saxton, Gauss-Newton on |P| = s p",
    )
    .balanced()
    .with_start()
    .with_aim();

    fn check(&self) -> Result<()> {
        check_iteration(self.steps, self.tolerance)?;
        real("quiet", self.quiet, 0.0, false).map(|_| ())
    }
}

impl Solve for Uniform {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        even_field::meet(problem, &[Plan::alone(self.steps, self.tolerance, self.quiet)], work, control)
    }

    facts!(meets_targets = true, finds_level = true);

    fn quiet(&self) -> Option<f64> {
        Some(self.quiet)
    }
}
