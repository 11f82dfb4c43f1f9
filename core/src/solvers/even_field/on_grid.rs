//! An even field brought to a board's phases: error diffusion where it is even, else a search of the neighbouring codes.

use crate::control::Control;
use crate::error::Error;
use crate::kernels::grid::Phases;
use crate::kernels::lanes::padded;
use crate::kernels::tiles::error_diffusion::{Task, diffuse, floats};
use crate::math::sqrtf;
use crate::problem::Problem;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::Workspace;

/// Passes that exchange codes: a third gains nothing at 256 phases and less than a tenth at 16 (N = 996, M = 4 to 64).
const ROUNDS: usize = 2;

/// Brings `wave`, which is even, to the phases and leaves the points as even as these allow.
///
/// # Errors
/// A stop: the drive is then partly where it was.
pub(super) fn round(
    problem: &Problem,
    rows: &Rows,
    phases: &Phases,
    wave: &mut Wave<'_>,
    work: &Workspace,
    control: &mut Control,
) -> Result<(), Error> {
    let points = rows.order.len();
    let mut roots = work.floats.take(padded(points));
    for (root, &j) in roots.iter_mut().zip(&rows.order) {
        *root = sqrtf(problem.weights()[j as usize]);
    }
    let mut memory = work.floats.take_any(floats(points));
    let mut codes = work.floats.take_any(rows.lanes);
    let task = Task { tiles: rows.tiles(), phases, roots: &roots, targeted: rows.targeted, memory: &mut memory };
    let (drive, field) =
        (wave.drive.each_mut().map(|plane| &mut plane[..]), wave.field.each_ref().map(|plane| &plane[..points]));
    diffuse(rows.set, task, ROUNDS, drive, field, &mut codes, control)?;
    wave.hear(rows);
    Ok(())
}
