//! The answer: full drives that make the points even, reduced to the targets.

use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::Error;
use crate::problem::{Problem, Solution, Status};
use crate::scene::Aim;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::Workspace;

/// Full drives (N,), on the board's grid if it has phases, and the status of the search.
pub(crate) struct Answer {
    pub(crate) drive: Vec<Complex32>,
    pub(crate) status: Status,
    /// Steps done, and steps planned.
    pub(crate) steps: (usize, usize),
    /// Whether a level between two amplitudes of the board is a mix of both.
    pub(crate) mixed: bool,
}

impl Answer {
    /// Reduces the drives to the problem's targets if they are louder; `wave` is their field at the rows. Returns the
    /// solution.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(crate) fn brought_down(
        self,
        problem: &Problem,
        rows: &Rows,
        wave: &Wave,
        work: &Workspace,
        control: &mut Control,
    ) -> Result<Solution, Error> {
        let Self { mut drive, status, steps: (step, steps), mixed } = self;
        let quantization = problem.quantization();
        let loudest = wave.moduli[..rows.targeted].iter().copied().fold(0.0, f32::max);
        let lower = problem.aim() == Aim::Target && loudest > rows.target;
        let factor = if lower { f64::from(rows.target / loudest) } else { 1.0 };
        let on_grid =
            status != Status::Stopped && quantization.is_some_and(|quantization| quantization.phases().is_some());
        // True if the rows are those of all points of the problem, in its units.
        let known = rows.order.len() == problem.propagation().points();
        if mixed && lower {
            let field = known.then(|| wave.received(problem, rows, 1.0, work));
            if let Some(mut solution) =
                Solution::mixed(problem, &mut drive, (factor, field), (status, step), work, control)
            {
                solution.tell(problem, steps, control);
                return Ok(if on_grid { solution.on_grid() } else { solution });
            }
        }
        let (amplitude, scale) = quantization.map_or((factor, 1.0), |quantization| quantization.lowered(factor));
        for q in &mut drive {
            *q *= amplitude as f32;
        }
        let solution = if known {
            let field = wave.received(problem, rows, amplitude as f32, work);
            Solution::of_field(problem, drive, &field, status, step, work, control)?
        } else {
            Solution::new(problem, drive, (status, step), steps, work, control)?
        };
        let mut solution = solution.scaled(scale);
        if on_grid {
            solution = solution.on_grid();
        }
        solution.tell(problem, steps, control);
        Ok(solution)
    }
}
