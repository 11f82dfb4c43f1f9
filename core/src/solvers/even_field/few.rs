//! Few points: the start of their highest level, found by branch and bound over the points' phases.

use crate::error::Error;
use crate::math::phasor;
use crate::problem::optimum::{self, Effort};
use crate::solvers::even_field::point_phases::Starts;
use crate::solvers::even_field::run::Run;

/// Largest number of targets. The search of the phases takes milliseconds for three points, and a hundred times as long
/// for four.
pub(super) const FEW: usize = 3;

/// Effort of the search. It is small, because later steps improve the field.
const EFFORT: Effort = Effort { gap: 1e-4, boxes: 512 };

/// Returns the point phases and weights of the highest level; `None` after a stop.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn start<'w>(run: &mut Run<'_, '_, 'w>) -> Result<Option<Starts<'w>>, Error> {
    let (rows, work) = (run.rows, run.work);
    let mut own = [(); 2].map(|()| work.floats.take(rows.lanes));
    let mut planes = [(); 2].map(|()| work.doubles.take(rows.targeted * rows.lanes));
    for k in 0..rows.targeted {
        rows.conjugate(k, own.each_mut().map(|plane| &mut plane[..]));
        for (plane, own) in planes.iter_mut().zip(&own) {
            let to = &mut plane[k * rows.lanes..][..rows.lanes];
            to.iter_mut().zip(own).for_each(|(to, own)| *to = f64::from(*own));
        }
    }
    // The planes contain conj(G), so the found phases are the negatives of the wanted ones.
    let planes = planes.each_ref().map(|plane| &plane[..]);
    let found = match optimum::search(rows.set, planes, rows.targeted, EFFORT, work, run.control) {
        Err(error) if error.is_stop() => {
            run.stopped = true;
            return Ok(None);
        }
        found => found?,
    };
    let mut weights = work.floats.take(rows.targeted);
    let mut phasors = [(); 2].map(|()| work.floats.take(rows.targeted));
    for k in 0..rows.targeted {
        let v = phasor(-found.phases[k]);
        (phasors[0][k], phasors[1][k]) = (v.re as f32, v.im as f32);
        weights[k] = found.weights[k] as f32;
    }
    Ok(Some(Starts { count: 1, weights, phasors, echoes: work.floats.take(1) }))
}
