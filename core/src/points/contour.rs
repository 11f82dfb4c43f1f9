//! Contours as points: equal steps along each, and no two points nearer than half a step.

use alloc::collections::BTreeMap;

use crate::prelude::*;
use crate::scene::{distance, short};

/// Default distance of neighbours in m: a quarter of the wavelength at 40 kHz and 340 m/s.
pub const STEP: f64 = 340.0 / 40e3 / 4.0;

/// Largest number of points of a shape: more points usually come from a wrong unit.
pub const MOST: usize = 100_000;

/// Allowance for rounding in the comparison of a distance with half a step.
const ROUNDING: f64 = 1e-9;

/// Returns points along contours of straight lines. Each contour goes from vertex to vertex (K, 3) in m, both ends
/// included.
///
/// Each contour has equal steps, as near to `step` (m) as possible. A point nearer than half a step to an earlier one
/// is left out, so that a contour that ends where it began has no point twice.
///
/// # Errors
/// A step that is not above 0, a contour without vertices, a coordinate that is not finite, more than [`MOST`] points.
///
/// ```
/// let corner = vec![[0.0, 0.0, 0.15], [0.01, 0.0, 0.15], [0.01, 0.01, 0.15]];
/// let points = midair::points::along(&[corner], 0.005)?;
/// assert_eq!(points.len(), 5);
/// assert!((points[3][1] - 0.005).abs() < 1e-12);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn along(contours: &[Vec<[f64; 3]>], step: f64) -> Result<Vec<[f64; 3]>> {
    real("step", step, 0.0, true)?;
    let measured: Vec<Lines> = contours.iter().map(|vertices| Lines::new(vertices)).collect::<Result<_, _>>()?;
    few(measured.iter().map(Lines::length).sum(), step)?;
    let points = measured.iter().flat_map(|lines| even(lines.length(), step, |way| lines.after(way)));
    Ok(spaced(points.collect(), step))
}

/// Returns the points of `make` for the least step from [`STEP`] on (within 2 %) that gives at most `most` points.
///
/// # Errors
/// The errors of `make`.
///
/// ```
/// use midair::points::{Curve, fitted};
///
/// let circle = Curve::circle([0.0, 0.0, 0.15], 0.03, [0.0, 0.0, 1.0], 0.0)?;
/// let ring = fitted(20, |step| circle.points(step))?;
/// assert!((18..=20).contains(&ring.len()));
/// # Ok::<(), midair::Error>(())
/// ```
pub fn fitted(most: usize, mut make: impl FnMut(f64) -> Result<Vec<[f64; 3]>>) -> Result<Vec<[f64; 3]>> {
    let mut step = STEP;
    let mut points = make(step)?;
    while points.len() > most.max(1) {
        step *= (points.len() as f64 / most.max(1) as f64 / 1.2).clamp(1.02, 4.0);
        points = make(step)?;
    }
    Ok(points)
}

/// Checks a length; returns an error if it has too many steps.
pub(crate) fn few(length: f64, step: f64) -> Result<()> {
    if length / step <= MOST as f64 {
        return Ok(());
    }
    let cure = "give sizes in m (5 cm are 0.05), or a larger step";
    let cure = format!("{} m of contours would be more than {MOST} points, {cure}", short(length));
    Err(Error::invalid("step", format_args!("{step:?}"), cure))
}

/// Returns the places after equal steps along a length, as near to `step` as possible, both ends included.
pub(crate) fn even(length: f64, step: f64, after: impl Fn(f64) -> [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
    let steps = math::rint(length / step).max(1.0);
    (0..=steps as usize).map(move |k| after(length * k as f64 / steps))
}

/// Returns the points in their order, without those nearer than half a step to an earlier one.
pub(crate) fn spaced(mut points: Vec<[f64; 3]>, step: f64) -> Vec<[f64; 3]> {
    let least = step / 2.0 * (1.0 - ROUNDING);
    // Points nearer than a cell's side are in the same cell or in the cells around it.
    let mut cells: BTreeMap<[i64; 3], Vec<[f64; 3]>> = BTreeMap::new();
    points.retain(|&point| {
        let cell = point.map(|x| math::floor(x / least) as i64);
        let around = (0..27).map(|k: i64| [k / 9, k / 3 % 3, k % 3]);
        let mut near =
            around.filter_map(|by| cells.get(&[0, 1, 2].map(|axis| cell[axis].saturating_add(by[axis] - 1)))).flatten();
        let apart = near.all(|&other| distance(point, other) >= least);
        if apart {
            cells.entry(cell).or_default().push(point);
        }
        apart
    });
    points
}

/// Straight lines from vertex to vertex, and the distance along them to each vertex.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lines {
    vertices: Vec<[f64; 3]>,
    ways: Vec<f64>,
}

impl Lines {
    pub(crate) fn new(vertices: &[[f64; 3]]) -> Result<Self> {
        if vertices.is_empty() || vertices.iter().flatten().any(|x| !x.is_finite()) {
            return Err(Error::invalid("contour", format_args!("{vertices:?}"), "give vertices of finite numbers"));
        }
        let mut ways = vec![0.0];
        let mut way = 0.0;
        ways.extend(vertices.windows(2).map(|pair| {
            way += distance(pair[0], pair[1]);
            way
        }));
        Ok(Self { vertices: vertices.into(), ways })
    }

    pub(crate) fn length(&self) -> f64 {
        self.ways[self.ways.len() - 1]
    }

    /// Returns the place at a distance along the lines: their start for a negative distance, their end beyond their
    /// length.
    pub(crate) fn after(&self, way: f64) -> [f64; 3] {
        let way = way.max(0.0);
        let next = self.ways.partition_point(|&end| end <= way);
        let (Some(&to), Some(&end)) = (self.vertices.get(next), self.ways.get(next)) else {
            return self.vertices[self.vertices.len() - 1];
        };
        let (from, begin) = (self.vertices[next - 1], self.ways[next - 1]);
        [0, 1, 2].map(|axis| (to[axis] - from[axis]) / (end - begin) * (way - begin) + from[axis])
    }
}

#[cfg(test)]
#[path = "tests/contour.rs"]
mod tests;
