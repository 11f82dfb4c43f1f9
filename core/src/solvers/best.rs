//! best: the loudest even field of many starts; like `uniform`, from many more point phases.

use crate::solvers::even_field;
use crate::solvers::even_field::run::{Plan, QUIET, SWEEPS};
use crate::solvers::prelude::*;

options! {
    /// Even fields from many starts. Time O(N M^2 + M^3), memory O(N M + M^2).
    pub struct Best {
        /// Number of start phases that are tried on the M x M matrix, at least 1. A single one is found as in `uniform`,
        /// without the seed.
        pub starts: u32 = 32,
        /// Weighted Gerchberg-Saxton sweeps from each of the four best starts.
        pub steps: u32 = 30,
        /// Ends when no point is off the common level by more than this part of it.
        pub tolerance: f64 = 1e-5,
        /// Allowed leak of a quiet point, relative to the loudest point. It is divided by the point's weight, relative to the
        /// largest weight of a target.
        pub quiet: f64 = QUIET,
        /// Seed of the point phases, 0 to 2^64 - 1.
        pub seed: u64 = 0,
    }
}

/// Number of starts that are continued to drives: only drives show which level an even field can have.
const FINALISTS: usize = 4;

impl Method for Best {
    const INFO: Info =
        Info::new("best", "the loudest even field from many starts", "as uniform").balanced().with_start().with_aim();

    fn check(&self) -> Result<()> {
        refuse_if!(self.starts == 0, Error::out_of_range("starts", self.starts, "give at least 1"));
        check_iteration(self.steps, self.tolerance)?;
        real("quiet", self.quiet, 0.0, false).map(|_| ())
    }
}

impl Solve for Best {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        // The solution of `uniform` is one of the candidates.
        let as_uniform = Plan::alone(SWEEPS, self.tolerance, self.quiet);
        let plan = Plan {
            starts: self.starts as usize,
            finalists: FINALISTS,
            seed: self.seed,
            sweeps: self.steps as usize,
            tolerance: self.tolerance as f32,
            quiet: self.quiet as f32,
            wide: true,
        };
        even_field::meet(problem, &[as_uniform, plan], work, control)
    }

    facts!(meets_targets = true, finds_level = true);

    fn quiet(&self) -> Option<f64> {
        Some(self.quiet)
    }
}
