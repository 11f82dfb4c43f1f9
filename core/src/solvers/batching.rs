//! Interleaved batches of the methods that solve them, by their types: a program without batches is linked without that code.

use alloc::vec::Vec;

use crate::problem::{Problem, Solution};
use crate::solvers::fast::Fast;
use crate::solvers::greedy::Greedy;
use crate::solvers::method::Solve;
use crate::workspace::Workspace;

/// Solves several problems of one model at once, each bit for bit as [`Solve::solve`] does without a control, where the
/// solver knows how and that saves work.
pub(crate) fn solve(solver: &dyn Solve, problems: &[Problem], work: &mut Workspace) -> Option<Vec<Solution>> {
    let method = solver.interleaved()?;
    if let Some(fast) = method.downcast_ref::<Fast>() {
        return fast.solve_interleaved(problems, work);
    }
    method.downcast_ref::<Greedy>()?.solve_interleaved(problems, work)
}
