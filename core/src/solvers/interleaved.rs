//! The methods that solve an interleaved batch, by name: a program without batches is linked without that code.

use alloc::vec::Vec;

use crate::problem::{Problem, Solution};
use crate::solvers::fast::Fast;
use crate::solvers::greedy::Greedy;
use crate::workspace::Workspace;

/// A method that solves several problems of one model at once.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Interleaved<'a> {
    /// By [`Fast`].
    Fast(&'a Fast),
    /// By [`Greedy`].
    Greedy(&'a Greedy),
}

impl Interleaved<'_> {
    /// Solves the problems, each bit for bit as [`crate::Solve::solve`] does without a control, where that saves work.
    pub(crate) fn solve(self, problems: &[Problem], work: &mut Workspace) -> Option<Vec<Solution>> {
        match self {
            Self::Fast(fast) => fast.solve_interleaved(problems, work),
            Self::Greedy(greedy) => greedy.solve_interleaved(problems, work),
        }
    }
}
