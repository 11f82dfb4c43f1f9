//! Regular sets of points: rings, grids and lines, whose couplings have ties that one start breaks badly now and then.

use crate::scene::distance;
use crate::workspace::Workspace;

/// Distances that agree to this part are alike.
const ALIKE: f32 = 1e-3;

/// The most points looked at: the loop is quadratic.
const MOST: usize = 256;

/// Whether three quarters of the points are as far from their nearest neighbour as the others are. Of random points, half are
/// at most: two that are each other's nearest.
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
