//! Cones: starts whose waves have one focus in front of or behind all points, so that their fields are smooth there.

use crate::math::{phasor, sqrt};
use crate::scene::distance;
use crate::solvers::even_field::point_phases::{Foci, Starts};
use crate::solvers::even_field::run::Run;

/// Distances of the focus from the middle of the points, away from the array, relative to their root mean square
/// distance.
const PLACES: [f64; 6] = [1.0, 2.0, 4.0, -1.0, -2.0, -4.0];

/// Returns the phases of a cone at the points; `None` if the points have no known places.
pub(super) fn start<'w>(run: &Run<'_, '_, 'w>, foci: &Foci, which: usize) -> Option<Starts<'w>> {
    let (rows, work, setup) = (run.rows, run.work, run.problem.setup());
    let points = run.problem.propagation().control_points()?;
    let at = |k: usize| points[rows.order[k] as usize];
    let middle = |places: &mut dyn Iterator<Item = [f64; 3]>, count: usize| {
        places.fold([0.0; 3], |sum, place| [0, 1, 2].map(|axis| sum[axis] + place[axis] / count as f64))
    };
    let positions = setup.positions.as_ref()?;
    let array = middle(&mut positions.iter().copied(), positions.len());
    let centre = middle(&mut (0..rows.targeted).map(at), rows.targeted);
    let spread = (0..rows.targeted).map(|k| distance(at(k), centre)).map(|r| r * r).sum::<f64>() / rows.targeted as f64;
    let (place, away) = (PLACES[which], distance(array, centre).max(f64::MIN_POSITIVE));
    let focus = [0, 1, 2].map(|axis| centre[axis] + place * sqrt(spread) * (centre[axis] - array[axis]) / away);
    let mut phasors = [(); 2].map(|()| work.floats.take(rows.targeted));
    for k in 0..rows.targeted {
        let v = phasor(-place.signum() * setup.medium.wavenumber() * distance(at(k), focus));
        (phasors[0][k], phasors[1][k]) = (v.re as f32, v.im as f32);
    }
    let mut weights = work.floats.take_any(rows.targeted);
    weights.copy_from_slice(&foci.weights);
    Some(Starts { count: 1, weights, phasors, echoes: work.floats.take(1) })
}
