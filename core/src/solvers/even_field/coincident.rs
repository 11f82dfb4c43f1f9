//! Coincident points: points in one place get the mean of their targets.

use crate::control::{Control, bytes};
use crate::error::Error;
use crate::kernels::LANES;
use crate::kernels::tiles::products;
use crate::solvers::common::tiled::Rows;
use crate::workspace::Workspace;

/// Rows of G that are parallel within this part belong to coincident points, about lambda/1000 apart.
const COINCIDENT: f64 = 1e-5;

/// Gives coincident points the mean of their targets. `powers` are the sums of |G|^2 over each row.
///
/// Most points differ in one tile in the middle. Only rows that look parallel there are compared as a whole.
pub(super) fn merge(rows: &mut Rows, powers: &mut [f32], work: &Workspace, control: &mut Control) -> Result<(), Error> {
    let points = rows.targeted;
    let middle = rows.lanes / LANES / 2;
    control.room("the matrix G G^H", [rows.lanes, points], bytes(8, &[points, points]))?;
    let mut matrix = [(); 2].map(|()| work.floats.take(points * points));
    let [re, im] = &mut matrix;
    products::couplings(rows.set, rows.tiles(), middle..middle + 1, points, [&mut *re, &mut *im], control)?;
    let entry = |k: usize, l: usize| [&*re, &*im].map(|plane| f64::from(plane[k * points + l]));
    let own = |k: usize| entry(k, k)[0].max(f64::from(f32::MIN_POSITIVE));
    // If two rows are parallel, they differ in the middle tile by at most this part of their power in that tile.
    let slack = |k: usize| 4.0 * COINCIDENT * (f64::from(powers[k]) / own(k)).max(1.0);
    let mut homes = work.counting(points);
    let mut apart = true;
    for first in 0..points {
        control.pulse()?;
        if homes[first] != first as u32 {
            continue;
        }
        let (power, slack_here) = (own(first), slack(first));
        for k in first + 1..points {
            let [re, im] = entry(first, k);
            let looks = re * re + im * im >= (1.0 - slack_here.min(slack(k))) * power * own(k);
            if looks && parallel(rows, powers, first, k) {
                (homes[k], apart) = (first as u32, false);
            }
        }
    }
    if !apart {
        for first in 0..points as u32 {
            let group = || (0..points).filter(|&k| homes[k] == first);
            let mean = group().map(|k| 1.0 / rows.scale[k]).sum::<f32>() / group().count() as f32;
            for k in group() {
                let factor = 1.0 / (mean * rows.scale[k]);
                rows.rescale(k, factor);
                powers[k] *= factor * factor;
            }
        }
    }
    Ok(())
}

/// Returns whether two whole rows are parallel.
fn parallel(rows: &Rows, powers: &[f32], k: usize, l: usize) -> bool {
    let [re, im] = products::coupling(rows.set, rows.tiles(), k, l).map(f64::from);
    re * re + im * im >= (1.0 - 2.0 * COINCIDENT) * f64::from(powers[k]) * f64::from(powers[l])
}
