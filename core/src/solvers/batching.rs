//! Calls the interleaved batch of a solver that has one. Programs that do not use this module do not link that code.

use crate::solvers::prelude::*;
use crate::solvers::{Fast, Greedy};

/// Solves several problems of one model at once, each with the bits that [`Solve::solve`] gives without a control.
/// Returns `None` if the solver cannot do it or if it saves no work.
pub(crate) fn solve(solver: &dyn Solve, problems: &[Problem], work: &mut Workspace) -> Option<Vec<Solution>> {
    let method = solver.interleaved()?;
    if let Some(fast) = method.downcast_ref::<Fast>() {
        return fast.solve_interleaved(problems, work);
    }
    method.downcast_ref::<Greedy>()?.solve_interleaved(problems, work)
}
