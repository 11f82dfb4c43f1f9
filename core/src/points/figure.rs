//! Figures: lines, circles and polylines.

use alloc::vec::Vec;
use core::f64::consts::PI;

use crate::error::{Error, real};
use crate::math;
use crate::points::contour::{along, count, few, spaced};
use crate::scene::{cross, dot};

/// Points from start to end in m, both included; `step` is the distance of neighbours in m.
///
/// # Errors
/// An end that is the start, a number that is not finite, a step that is not above 0, more than [`MOST`](crate::points::MOST)
/// points.
///
/// ```
/// let points = midair::points::line([-0.02, 0.0, 0.15], [0.02, 0.0, 0.15], 0.01)?;
/// assert_eq!(points.len(), 5);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn line(start: [f64; 3], end: [f64; 3], step: f64) -> Result<Vec<[f64; 3]>, Error> {
    place("start", start)?;
    place("end", end)?;
    if start == end {
        return Err(Error::invalid("end", format_args!("{end:?}"), "it is where the start is, give another point"));
    }
    along(&[[start, end].into()], step)
}

/// Points of a circle around a center, in the plane normal to `normal` of any length; center, radius and step in m.
///
/// The first lies along x, as far as the plane allows (else along y); the others follow counterclockwise, seen against the
/// normal.
///
/// # Errors
/// A radius or step that is not above 0, a number that is not finite, a normal of no length, more than
/// [`MOST`](crate::points::MOST) points.
///
/// ```
/// let points = midair::points::circle([0.0, 0.0, 0.15], 0.02, [0.0, 0.0, 1.0], midair::points::STEP)?;
/// assert_eq!(points.len(), 59);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn circle(center: [f64; 3], radius: f64, normal: [f64; 3], step: f64) -> Result<Vec<[f64; 3]>, Error> {
    place("center", center)?;
    let length = 2.0 * PI * real("radius", radius, 0.0, true)?;
    let [across, up] = axes(normal)?;
    few(length, real("step", step, 0.0, true)?)?;
    let steps = count(length, step);
    let at = |k: usize| {
        let angle = 2.0 * PI * k as f64 / steps as f64;
        let (sin, cos) = (math::sin(angle), math::cos(angle));
        [0, 1, 2].map(|axis| center[axis] + radius * (cos * across[axis] + sin * up[axis]))
    };
    Ok(spaced((0..steps).map(at).collect(), step))
}

/// Points along straight lines between `points`, at least two; where `closed`, also from the last back to the first. Steps
/// run on around corners.
///
/// # Errors
/// Fewer than two points, points that are all in one place, a number that is not finite, a step that is not above 0, more
/// than [`MOST`](crate::points::MOST) points.
///
/// ```
/// let corners = [[0.0, 0.0, 0.15], [0.01, 0.0, 0.15], [0.01, 0.01, 0.15], [0.0, 0.01, 0.15]];
/// assert_eq!(midair::points::polyline(&corners, true, 0.005)?.len(), 8);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn polyline(points: &[[f64; 3]], closed: bool, step: f64) -> Result<Vec<[f64; 3]>, Error> {
    along(&[corners("points", points, closed)?], step)
}

/// The corners of a polyline, the first once more where it closes.
pub(crate) fn corners(item: &str, points: &[[f64; 3]], closed: bool) -> Result<Vec<[f64; 3]>, Error> {
    let refused = |cure: &str| Err(Error::invalid(item, format_args!("{points:?}"), cure));
    if points.len() < 2 {
        return refused("give at least two");
    }
    if points.iter().all(|point| *point == points[0]) {
        return refused("they are all in one place, give different ones");
    }
    points.iter().try_for_each(|&point| place(item, point).map(drop))?;
    Ok(points.iter().chain(points.first().filter(|_| closed)).copied().collect())
}

/// Unit vectors normal to `normal`: along x as far as it allows (else along y), and to the left.
pub(crate) fn axes(normal: [f64; 3]) -> Result<[[f64; 3]; 2], Error> {
    let size = size(normal);
    if !(size > 0.0 && size < f64::INFINITY) {
        return Err(Error::invalid("normal", format_args!("{normal:?}"), "give a direction such as [0, 0, 1]"));
    }
    let normal = normal.map(|x| x / size);
    // A normal along x leaves no direction along x in its plane.
    let axis = if normal[0].abs() < 0.999 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let part = dot(axis, normal);
    let across = [0, 1, 2].map(|k| axis[k] - normal[k] * part);
    let length = self::size(across);
    let across = across.map(|x| x / length);
    Ok([across, cross(normal, across)])
}

fn size([x, y, z]: [f64; 3]) -> f64 {
    math::hypot(math::hypot(x, y), z)
}

/// Refuses a place that is none.
pub(crate) fn place(item: &str, at: [f64; 3]) -> Result<[f64; 3], Error> {
    if at.iter().all(|x| x.is_finite()) {
        return Ok(at);
    }
    Err(Error::invalid(item, format_args!("{at:?}"), "give three finite numbers"))
}
