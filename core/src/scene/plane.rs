//! Plane: a square of pixels normal to an axis, for pictures of the field; and how planes are chosen that show given points.

use crate::error::find;
use crate::prelude::*;
use crate::scene::geometry::{bounds, vector};

/// A point within this many wavelengths of a plane is shown in it: at this distance even a standing wave has 4/5 of its
/// pressure.
const NEAR: f64 = 0.1;

/// How many wavelengths around the points a plane shows, if its size is not given.
const MARGIN: f64 = 2.0;

/// The side of a plane through a trap, in wavelengths: the picture shows the loud shell around the trap and the next
/// shell.
const TRAP: f64 = 2.5;

/// The most planes for foci, and the most traps for which planes are made; further planes and traps are left out.
const MOST_PLANES: usize = 4;

/// Pixels along each side of a plane whose size is not given.
const PIXELS: usize = 200;

/// An axis of space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The axis along the rows of a flat array.
    X,
    /// The axis along the columns of a flat array.
    Y,
    /// The axis normal to a flat array.
    Z,
}

impl Axis {
    /// Every axis, in order of preference: if several fit as the normal of a plane, the first is used.
    const ALL: [Self; 3] = [Self::Z, Self::Y, Self::X];

    /// Returns the axis of this name: "x", "y" or "z".
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str) -> Result<Self> {
        let names = [("x", Self::X), ("y", Self::Y), ("z", Self::Z)];
        find("axis", name, &names, |(name, _)| name).map(|(_, axis)| *axis)
    }

    /// The index of the axis in [x, y, z].
    const fn index(self) -> usize {
        self as usize
    }

    /// The indices of the other two axes: the horizontal and the vertical axis of a picture.
    const fn others(self) -> [usize; 2] {
        match self {
            Self::X => [1, 2],
            Self::Y => [0, 2],
            Self::Z => [0, 1],
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(["x", "y", "z"][self.index()])
    }
}

/// A square of pixels normal to an axis, for pictures of the field. The horizontal and vertical axes of the picture are x and y
/// for the normal z, x and z for y, and y and z for x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// The axis normal to the plane.
    pub axis: Axis,
    /// The coordinate of the plane along that axis in m.
    pub at: f64,
    /// The side of the square in m.
    pub size: f64,
    /// Pixels along each side, ends included.
    pub pixels: usize,
    /// The middle of the square in m, as (horizontal, vertical) coordinate.
    pub center: [f64; 2],
}

impl Plane {
    /// Returns a plane at height z of `pixels` x `pixels` samples, at center + linspace(-size/2, size/2, pixels).
    ///
    /// # Errors
    /// The errors of [`Plane::normal_to`].
    pub fn new(z: f64, size: f64, pixels: usize, center: [f64; 2]) -> Result<Self> {
        Self::normal_to(Axis::Z, z, size, pixels, center)
    }

    /// Returns a plane normal to `axis` at the coordinate `at` along it, sampled as by [`Plane::new`].
    ///
    /// # Errors
    /// A coordinate that is not finite, a size that is not above 0, fewer than 2 or more than 8192 pixels.
    pub fn normal_to(axis: Axis, at: f64, size: f64, pixels: usize, center: [f64; 2]) -> Result<Self> {
        vector(&format!("plane {axis} and center"), &[at, center[0], center[1]])?;
        real("plane.size", size, 0.0, true)?;
        refuse_if!(!(2..=8192).contains(&pixels), Error::out_of_range("plane.pixels", pixels, "give 2 to 8192"));
        Ok(Self { axis, at, size, pixels, center })
    }

    /// Returns planes that show `points` and at least two wavelengths around them. If the points lie in a plane normal to z, y
    /// or x, only that plane is returned. Otherwise the normal is the axis along which the points have the fewest different
    /// places, with one plane for each place, at most four. Planes with the most points come first. The planes differ only in
    /// their coordinate along the normal.
    pub fn around(points: &[[f64; 3]], wavelength: f64) -> Vec<Self> {
        let layers = |axis| Self::layers(axis, points, wavelength);
        let mut planes = Axis::ALL.map(layers).into_iter().min_by_key(Vec::len).unwrap_or_default();
        planes.truncate(MOST_PLANES);
        planes
    }

    /// Returns two upright planes of one size through each of the first four traps: first all normal to y, then all normal to
    /// x. A trap is a node of the pressure, and a plane across the array's axis may contain only nodes.
    pub(crate) fn upright(traps: &[[f64; 3]], wavelength: f64) -> Vec<Self> {
        let through = |axis: Axis| {
            let middle = move |trap: &[f64; 3]| (trap[axis.index()], axis.others().map(|k| trap[k]));
            let size = TRAP * wavelength;
            let plane = move |(at, center)| Self { axis, at, size, pixels: PIXELS, center };
            traps.iter().take(MOST_PLANES).map(middle).map(plane)
        };
        through(Axis::Y).chain(through(Axis::X)).collect()
    }

    /// Returns the plane normal to y through the middle of a body with these bounds. It shows the body and `points`.
    pub(crate) fn through_body(body: [[f64; 2]; 3], points: &[[f64; 3]], wavelength: f64) -> Self {
        let corners = [0, 1].map(|end| body.map(|side| side[end]));
        let around = Self::layers(Axis::Y, &[points, &corners].concat(), wavelength)[0];
        Self { at: 0.5 * (body[1][0] + body[1][1]), ..around }
    }

    /// Whether the plane's square cuts the box with these bounds.
    pub(crate) fn cuts(&self, bounds: [[f64; 2]; 3]) -> bool {
        let within = |k: usize, at: f64, half: f64| bounds[k][0] < at + half && at - half < bounds[k][1];
        let mut beside = self.axis.others().into_iter().zip(self.center);
        within(self.axis.index(), self.at, 0.0) && beside.all(|(k, at)| within(k, at, 0.5 * self.size))
    }

    /// Returns the planes normal to `axis` that together show all `points`, at least one plane. Those with the most points come
    /// first.
    pub(crate) fn layers(axis: Axis, points: &[[f64; 3]], wavelength: f64) -> Vec<Self> {
        let bounds = bounds(points);
        let [across, up] = axis.others().map(|k| bounds[k]);
        let middle = |[low, high]: [f64; 2]| 0.5 * low + 0.5 * high;
        let size = (across[1] - across[0]).max(up[1] - up[0]) + 2.0 * MARGIN * wavelength;
        let center = [middle(across), middle(up)];
        let mut places: Vec<f64> = points.iter().map(|point| point[axis.index()]).collect();
        places.sort_unstable_by(f64::total_cmp);
        // Each plane shows the lowest remaining point and the points up to 2 NEAR above it. The plane lies halfway between the
        // lowest and the highest of these points.
        let mut layers: Vec<_> = Vec::new();
        let mut rest = &places[..];
        while let Some(&low) = rest.first() {
            let count = rest.partition_point(|place| place - low <= 2.0 * NEAR * wavelength);
            layers.push((count, middle([low, rest[count - 1]])));
            rest = &rest[count..];
        }
        if layers.is_empty() {
            layers.push((0, 0.0));
        }
        layers.sort_by_key(|&(count, _)| core::cmp::Reverse(count));
        layers.into_iter().map(|(_, at)| Self { axis, at, size, pixels: PIXELS, center }).collect()
    }

    /// Returns the coordinate along `axis`, given as `z` or as `at`; `None` if neither is given.
    ///
    /// # Errors
    /// If both are given, or z for an axis other than z.
    pub fn place(axis: Axis, z: Option<f64>, at: Option<f64>) -> Result<Option<f64>> {
        match (axis, z, at) {
            (_, Some(_), Some(at)) => Err(Error::invalid("plane.at", at, "z is given too: give one of them")),
            (Axis::X | Axis::Y, Some(z), None) => {
                let cure = format!(
                    "the plane is normal to {axis}: give at, its place along {axis}; center is {}",
                    if axis == Axis::X { "(y, z)" } else { "(x, z)" }
                );
                Err(Error::invalid("plane.z", z, cure))
            }
            _ => Ok(z.or(at)),
        }
    }

    /// Whether a picture of the plane shows this point: it lies in the square, with half a pixel as margin, and within a tenth
    /// of the wavelength of the plane.
    pub fn shows(&self, point: [f64; 3], wavelength: f64) -> bool {
        let edge = 0.5 * self.size * (1.0 + 1.0 / (self.pixels as f64 - 1.0));
        let inside =
            self.axis.others().into_iter().zip(self.center).all(|(k, center)| (point[k] - center).abs() <= edge);
        // The factor 1.001 allows for rounding: without it a plane halfway between two points might show neither.
        inside && (point[self.axis.index()] - self.at).abs() <= 1.001 * NEAR * wavelength
    }

    /// Returns a copy of this plane with all lengths rounded to micrometres, for messages.
    #[must_use]
    pub fn rounded(&self) -> Self {
        let round = |x: f64| libm::round(x * 1e6) / 1e6;
        Self { at: round(self.at), size: round(self.size), center: self.center.map(round), ..*self }
    }

    /// Coordinates in m of the pixels along one side of the picture: `side` 0 is horizontal, 1 is vertical.
    pub fn samples(&self, side: usize) -> Vec<f64> {
        let step = self.size / (self.pixels as f64 - 1.0);
        (0..self.pixels).map(|i| self.center[side] - self.size / 2.0 + i as f64 * step).collect()
    }

    /// Coordinates in m of the pixels along an axis of space; `None` for the normal of the plane.
    pub fn along(&self, axis: Axis) -> Option<Vec<f64>> {
        let side = self.axis.others().into_iter().position(|k| k == axis.index())?;
        Some(self.samples(side))
    }

    /// The samples row by row, the horizontal axis fastest: pixel (up, across) has the index up * pixels + across.
    pub fn points(&self) -> Vec<[f64; 3]> {
        let [across, up] = self.axis.others();
        let row = self.samples(0);
        let point = |u: f64, v: f64| {
            let mut point = [self.at; 3];
            (point[across], point[up]) = (u, v);
            point
        };
        self.samples(1).into_iter().flat_map(|v| row.iter().map(move |&u| point(u, v))).collect()
    }
}

/// Writes the plane as the Python call that makes it.
impl fmt::Display for Plane {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { axis, at, size, pixels, center: [across, up] } = self;
        match axis {
            Axis::Z => write!(f, "Plane(z={at}, ")?,
            _ => write!(f, "Plane(axis=\"{axis}\", at={at}, ")?,
        }
        write!(f, "size={size}, pixels={pixels}, center=({across}, {up}))")
    }
}
