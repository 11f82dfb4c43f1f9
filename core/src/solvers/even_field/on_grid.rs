//! Rounds an even field to a board's grid by error diffusion, or with few phases by a search of neighbouring codes.

use crate::device::quantization::Quantization;
use crate::error::Error;
use crate::kernels::tiles::error_diffusion::{Choice, Task, diffuse, floats};
use crate::solvers::common::refinement::refine;
use crate::solvers::common::tiled::Wave;
use crate::solvers::even_field::run::Run;

/// Least number of phases for error diffusion. Fewer are too far apart for tangents: it would lose a tenth of the
/// level.
pub(super) const FEWEST: u32 = 8;

/// Rounds `wave` to the board's grid, if it has one and the run was not stopped, and computes its field again. The
/// points stay as even as the grid allows. A field that is not `even` has errors too large for the next transducers to
/// correct: the neighbouring codes are searched, too. After a stop the drive is partly unchanged.
pub(super) fn bring(run: &mut Run, even: bool, wave: &mut Wave<'_>) {
    if let Some(quantization) = run.problem.quantization()
        && !run.stopped
    {
        run.stopped = round(run, quantization, even, wave).is_err();
    }
}

fn round(run: &mut Run, quantization: &Quantization, even: bool, wave: &mut Wave<'_>) -> Result<(), Error> {
    let (problem, rows, work, control) = (run.problem, run.rows, run.work, &mut *run.control);
    let points = rows.order.len();
    if let Some(phases) = &quantization.grid().phases
        && even
        && points > 1
        && quantization.phases() >= Some(FEWEST)
    {
        let mut weights = work.floats.take_any(points);
        for (weight, &j) in weights.iter_mut().zip(&rows.order) {
            *weight = problem.weights()[j as usize];
        }
        let mut memory = work.floats.take_any(floats(points));
        let mut codes = work.floats.take_any(rows.lanes);
        let task = Task {
            tiles: rows.tiles(),
            choice: Choice::even(phases, f32::INFINITY),
            weights: &weights,
            targeted: rows.targeted,
            memory: &mut memory,
        };
        let drive = wave.drive.each_mut().map(|plane| &mut plane[..]);
        let field = wave.field.each_ref().map(|plane| &plane[..points]);
        diffuse(rows.set, task, drive, field, &mut codes, control)?;
        wave.hear(rows);
    } else {
        let mut drive = wave.drives(problem.propagation().transducers(), work);
        if points > 1 {
            refine(problem, &mut drive, work, control);
        } else {
            // A single point is even with any codes.
            quantization.grid().round(rows.set, 1.0, [1.0; 2], &mut drive);
        }
        wave.play(rows, drive.iter().copied());
        work.complexes.give(drive);
    }
    Ok(())
}
