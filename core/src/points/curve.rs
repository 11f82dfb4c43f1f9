//! Curves by arc length: a circle or straight lines, as evenly spaced points and as the place at a distance.

use crate::points::contour::{Lines, even, few, spaced};
use crate::prelude::*;

/// Straight pieces per period of a sine: a Lissajous figure of 0.1 m has an error of 1e-9 m.
const PIECES: usize = 16384;

/// The largest number of periods of a Lissajous figure; more are probably a mistake.
const MOST_LOBES: f64 = 100.0;

/// A curve in space, open or closed.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    length: f64,
    closed: bool,
    course: Course,
}

#[derive(Clone, Debug, PartialEq)]
enum Course {
    Circle { center: [f64; 3], across: [f64; 3], up: [f64; 3], angle: f64 },
    Lines(Lines),
}

impl Curve {
    /// Creates a circle around a center, in the plane normal to `normal` of any length; center and radius in m.
    ///
    /// It begins at `angle` (rad) from x, as far as the plane allows (else from y), and goes counterclockwise, seen
    /// against the normal: c + r (cos(a) u + sin(a) v), a = angle + way/r.
    ///
    /// # Errors
    /// A radius that is not above 0, a number that is not finite, a normal of no length.
    ///
    /// ```
    /// let circle = midair::points::Curve::circle([0.0, 0.0, 0.15], 0.02, [0.0, 0.0, 1.0], 0.0)?;
    /// assert_eq!(circle.after(0.0), [0.02, 0.0, 0.15]);
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn circle(center: [f64; 3], radius: f64, normal: [f64; 3], angle: f64) -> Result<Self> {
        place("center", center)?;
        let length = 2.0 * PI * real("radius", radius, 0.0, true)?;
        let angle = real("start_angle", angle, f64::MIN, false)?;
        let [across, up] = axes(normal)?;
        Ok(Self { length, closed: true, course: Course::Circle { center, across, up, angle } })
    }

    /// Creates straight lines from corner to corner (K, 3) in m, at least two; if `closed`, also from the last to the
    /// first.
    ///
    /// # Errors
    /// Fewer than two corners, corners that are all in one place, a number that is not finite. The messages call them
    /// `item`.
    ///
    /// ```
    /// let corners = [[0.0, 0.0, 0.15], [0.01, 0.0, 0.15], [0.01, 0.01, 0.15], [0.0, 0.01, 0.15]];
    /// let square = midair::points::Curve::lines("corners", &corners, true)?;
    /// assert_eq!(square.after(0.02), [0.01, 0.01, 0.15]);
    /// assert_eq!(square.points(0.005)?.len(), 8);
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn lines(item: &str, corners: &[[f64; 3]], closed: bool) -> Result<Self> {
        let refused = |cure: &str| Err(Error::invalid(item, format_args!("{corners:?}"), cure));
        if corners.len() < 2 {
            return refused("give at least two");
        }
        if corners.iter().all(|corner| *corner == corners[0]) {
            return refused("they are all in one place, give different ones");
        }
        corners.iter().try_for_each(|&corner| place(item, corner))?;
        let corners: Vec<[f64; 3]> = corners.iter().chain(corners.first().filter(|_| closed)).copied().collect();
        let lines = Lines::new(&corners)?;
        Ok(Self { length: lines.length(), closed, course: Course::Lines(lines) })
    }

    /// Creates a straight line from start to end in m, and back if `there_and_back`.
    ///
    /// # Errors
    /// An end that is the start, a number that is not finite.
    ///
    /// ```
    /// let line = midair::points::Curve::line([-0.02, 0.0, 0.15], [0.02, 0.0, 0.15], false)?;
    /// assert_eq!(line.points(0.01)?.len(), 5);
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn line(start: [f64; 3], end: [f64; 3], there_and_back: bool) -> Result<Self> {
        place("start", start)?;
        if start == end {
            let cure = "it is where the start is, give another point";
            return Err(Error::invalid("end", format_args!("{end:?}"), cure));
        }
        Self::lines("end", &[start, end], there_and_back)
    }

    /// Creates the figure x = width / 2 sin(a u + phase), y = height / 2 sin(b u) around a center, for a period of u, as
    /// short straight lines; `size` is width and height in m, `ratio` is a and b.
    ///
    /// # Errors
    /// A size of 0 or below along both axes, numbers a and b that are not whole or not from 1 to 100, a number that is not
    /// finite.
    ///
    /// ```
    /// let eight = midair::points::Curve::lissajous([0.0, 0.0, 0.15], [0.04, 0.02], [1.0, 2.0], 0.0)?;
    /// assert!(eight.closed() && eight.length() > 0.08);
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn lissajous(center: [f64; 3], size: [f64; 2], ratio: [f64; 2], phase: f64) -> Result<Self> {
        place("center", center)?;
        real("phase", phase, f64::MIN, false)?;
        if !size.iter().all(|&side| (0.0..f64::INFINITY).contains(&side)) || size == [0.0; 2] {
            return Err(Error::invalid("size", format_args!("{size:?}"), "give (width, height) in m, not both 0"));
        }
        if !ratio.iter().all(|&lobes| lobes % 1.0 == 0.0 && (1.0..=MOST_LOBES).contains(&lobes)) {
            let cure = format!("give two whole numbers from 1 to {MOST_LOBES}");
            return Err(Error::out_of_range("ratio", format_args!("{ratio:?}"), cure));
        }
        // In lowest terms, one period runs through the figure once.
        let lobes = ratio.map(|lobes| lobes as usize);
        let common = (1..=lobes[0]).rev().find(|n| lobes.iter().all(|lobes| lobes.is_multiple_of(*n))).unwrap_or(1);
        let [a, b] = lobes.map(|lobes| (lobes / common) as f64);
        let pieces = PIECES * lobes[0].max(lobes[1]) / common;
        let corners = (0..pieces).map(|k| {
            let u = TAU * k as f64 / pieces as f64;
            let (x, y) = (size[0] / 2.0 * math::sin(a * u + phase), size[1] / 2.0 * math::sin(b * u));
            [center[0] + x, center[1] + y, center[2]]
        });
        Self::lines("figure", &corners.collect::<Vec<_>>(), true)
    }

    /// Returns evenly spaced points in m from the start, `step` m apart or as near to that as equal steps can be.
    ///
    /// The last point is the end, unless the curve is closed. A point nearer than half a step to an earlier one is left
    /// out.
    ///
    /// # Errors
    /// A step that is not above 0, more than [`MOST`](crate::points::MOST) points.
    pub fn points(&self, step: f64) -> Result<Vec<[f64; 3]>> {
        few(self.length, real("step", step, 0.0, true)?)?;
        Ok(spaced(even(self.length, step, |way| self.after(way)).collect(), step))
    }

    /// Returns the length in m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Returns whether the curve is closed.
    pub fn closed(&self) -> bool {
        self.closed
    }

    /// Returns the place at a distance in m from the start. Lines stop at their end; a circle goes on.
    pub fn after(&self, way: f64) -> [f64; 3] {
        match &self.course {
            Course::Lines(lines) => lines.after(way),
            Course::Circle { center, across, up, angle } => {
                let radius = self.length / (2.0 * PI);
                let angle = angle + way / radius;
                let (sin, cos) = (math::sin(angle), math::cos(angle));
                [0, 1, 2].map(|axis| center[axis] + radius * (cos * across[axis] + sin * up[axis]))
            }
        }
    }
}

/// Returns two unit vectors normal to `normal`: the first as near to x as possible (else to y), the second to its left.
fn axes(normal: [f64; 3]) -> Result<[[f64; 3]; 2]> {
    let size = size(normal);
    if !(size > 0.0 && size < f64::INFINITY) {
        return Err(Error::invalid("normal", format_args!("{normal:?}"), "give a direction such as [0, 0, 1]"));
    }
    let normal = Vec3(normal) / size;
    // A normal along x leaves no direction along x in its plane.
    let axis = Vec3(if normal[0].abs() < 0.999 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] });
    let across = axis - axis.dot(normal) * normal;
    let across = across / self::size(across.0);
    Ok([across.0, normal.cross(across).0])
}

fn size([x, y, z]: [f64; 3]) -> f64 {
    math::hypot(math::hypot(x, y), z)
}

/// Checks a place; returns an error if a coordinate is not finite.
fn place(item: &str, at: [f64; 3]) -> Result<()> {
    if at.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err(Error::invalid(item, format_args!("{at:?}"), "give three finite numbers"))
}

#[cfg(test)]
#[path = "tests/curve.rs"]
mod tests;
