//! Regular sets of points: rings, grids and lines have equal couplings, for which a single start is sometimes bad.

use crate::scene::distance;
use crate::workspace::Workspace;

/// Distances that agree within this part count as equal.
const ALIKE: f32 = 1e-3;

/// Largest number of points checked: the loop is quadratic.
const MOST: usize = 256;

/// Returns whether three quarters of the points are at equal distances from their nearest neighbours. Of random
/// points at most half have equal distances: those in pairs that are each other's nearest neighbours.
pub(super) fn regular(points: &[[f64; 3]], work: &Workspace) -> bool {
    if !(3..=MOST).contains(&points.len()) {
        return false;
    }
    let nearest = |j: usize| {
        let others = (0..points.len()).filter(|&k| k != j);
        others.map(|k| distance(points[j], points[k])).fold(f64::INFINITY, f64::min)
    };
    let mut distances = work.floats.take(points.len());
    distances.iter_mut().enumerate().for_each(|(j, distance)| *distance = nearest(j) as f32);
    distances.sort_unstable_by(f32::total_cmp);
    let middle = distances[points.len() / 2];
    let alike = distances.iter().filter(|distance| (**distance - middle).abs() <= ALIKE * middle).count();
    4 * alike >= 3 * points.len()
}
