//! Back-projection: the drive q = f G^H x of the requested pressures x, limited, with its field.

use crate::linalg::Planar;
use crate::prelude::*;
use crate::problem::{Problem, Solution, Status};
use crate::propagation::Strips;
use crate::solvers::amplitude_limit::AmplitudeLimit;
use crate::workspace::Workspace;

/// Creates a solver's solution q_i = `factor`_i sum_j conj(G_ji) x_j within the `limit`. `ended` is its status and the
/// number of steps taken, of `steps`.
#[allow(clippy::too_many_arguments, reason = "what every solver ends with, and what it wants")]
pub(crate) fn back_projected(
    problem: &Problem,
    mut strips: Strips<'_>,
    wanted: &Planar,
    factor: impl Fn(usize) -> f32,
    limit: AmplitudeLimit,
    (ended, steps): ((Status, usize), usize),
    work: &Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    let propagation = problem.propagation();
    let mut parts = strips.back_project(wanted, control)?;
    for part in &mut parts {
        part.iter_mut().enumerate().for_each(|(i, x)| *x *= factor(i));
    }
    limit.apply(propagation.instruction_set(), parts.each_mut().map(|part| &mut part[..]));
    let field = strips.field(&mut parts, control)?;
    let mut drive = work.complexes.empty(propagation.transducers());
    drive.extend(
        parts[0].iter().zip(&parts[1]).map(|(&re, &im)| Complex32::new(re, im)).take(propagation.transducers()),
    );
    let mut solution = Solution::of_field(problem, drive, &field, ended.0, ended.1, work, control)?;
    solution.tell(problem, steps, control);
    Ok(solution)
}
