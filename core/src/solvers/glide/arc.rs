//! Arc: turns phases that stay within an arc around 1 until all points are even.
//!
//! Projected Gauss-Newton on r_j = |P_j| - s, s free. Phases at an end of the arc stay there. If the others do not
//! suffice (for points that move faster than the bound allows), those that the steepest descent of sum r^2 turns
//! inwards may leave the end (Bertsekas, SIAM J. Control Optim. 20(2), 1982).

use crate::kernels::tiles::unit::Arc;
use crate::solvers::even_field::newton::Newton;
use crate::solvers::prelude::*;

/// Number of tries of a step, each half as far as the one before.
const HALVINGS: usize = 4;

/// A phase is at its bound if the cosine of its change differs from that of the bound by at most this.
const AT_BOUND: f32 = 1e-6;

/// After a step that leaves more than this part of the squared error, phases at their bound may turn inwards, too.
const SLOW: f64 = 0.25;

/// The range of phases, and the number of steps.
#[derive(Clone, Copy)]
pub(crate) struct Steps {
    pub(crate) arc: Arc,
    pub(crate) most: u32,
    /// The largest deviation from the mean that counts as even, relative to it.
    pub(crate) even: f32,
}

/// Makes `wave` even; `trial` is memory. Returns the largest deviation from the mean that remains, relative to the
/// mean. `hear` adds the other parts of a field to that of the drive.
///
/// # Errors
/// More memory than allowed is needed, or a stop.
pub(crate) fn even_within<'w>(
    Steps { arc, most, even }: Steps,
    problem: &Problem,
    rows: &Rows,
    hear: &impl Fn(&mut Wave<'_>),
    (wave, trial): (&mut Wave<'w>, &mut Wave<'w>),
    work: &'w Workspace,
    control: &mut Control,
) -> Result<f32> {
    let arcs = rows.arcs(arc, work);
    let mut mask = work.floats.take_any(rows.lanes);
    let mut newton = Newton::new(problem, rows, 0.0, work, control)?;
    let mut cost = newton.cost(rows, wave, wave.level(rows));
    let mut inward = false;
    for _ in 0..most {
        if wave.unevenness(rows, wave.level(rows), 0.0) <= even {
            break;
        }
        let bound = if arc[0] > -1.0 { arc[0] + AT_BOUND } else { f32::NEG_INFINITY };
        if inward {
            newton.descent(rows, wave, control)?;
        }
        let free = |cos: f32| if cos <= bound { 0.0 } else { 1.0 };
        mask.iter_mut().zip(&wave.drive[0]).for_each(|(mask, &cos)| *mask = free(cos));
        if inward {
            for ((mask, &sin), &rotation) in mask.iter_mut().zip(&wave.drive[1]).zip(&newton.rotations[..]) {
                *mask = if rotation * sin < 0.0 { 1.0 } else { *mask };
            }
        }
        let tries = if newton.direction(rows, wave, Some(&mask), control)? { HALVINGS } else { 0 };
        // Some phases reach their bound before the end of the step. A step of half the length may then be better.
        let mut left = 1.0;
        for _ in 0..tries {
            trial.rotate_within(rows, wave, &newton.rotations, [&arcs[0], &arcs[1]]);
            hear(trial);
            let after = newton.cost(rows, trial, trial.level(rows));
            if after < cost {
                (left, cost) = (after / cost, after);
                core::mem::swap(wave, trial);
                break;
            }
            newton.rotations.iter_mut().for_each(|rotation| *rotation *= 0.5);
        }
        if left >= 1.0 && inward {
            break;
        }
        inward |= left > SLOW;
    }
    Ok(wave.unevenness(rows, wave.level(rows), 0.0))
}
