//! Plane: a square of pixels normal to an axis, for pictures of the field, and the planes that show given points.

use alloc::format;
use alloc::vec::Vec;
use core::fmt;

use crate::error::{Error, find, real};
use crate::scene::geometry::bounds;
use crate::scene::geometry::vector;

/// A point within this part of the wavelength of a plane lies in it: even a standing wave has 4/5 of its pressure there.
const NEAR: f64 = 0.1;

/// Wavelengths that a plane of its own accord shows around the points.
const MARGIN: f64 = 2.0;

/// Side of a plane through a trap in wavelengths: the shell around it and the next.
const TRAP: f64 = 2.5;

/// The most planes that points, and the most traps that two planes each are shown in; further ones are left out.
const MOST_PLANES: usize = 4;

/// Pixels along a side of such a plane.
const PIXELS: usize = 200;

/// An axis of space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::exhaustive_enums, reason = "space has three")]
pub enum Axis {
    /// The axis along a flat array's rows.
    X,
    /// The axis along its columns.
    Y,
    /// The axis away from it.
    Z,
}

impl Axis {
    /// Every axis; where several would do as the normal of a plane, the first of these is taken.
    const ALL: [Self; 3] = [Self::Z, Self::Y, Self::X];

    /// The axis of this name: "x", "y" or "z".
    ///
    /// # Errors
    /// Another name.
    pub fn named(name: &str) -> Result<Self, Error> {
        let names = [("x", Self::X), ("y", Self::Y), ("z", Self::Z)];
        find("axis", name, &names, |(name, _)| name).map(|(_, axis)| *axis)
    }

    /// Its coordinate's index.
    const fn index(self) -> usize {
        self as usize
    }

    /// The indices of the other two, across and up a picture.
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

/// A square of pixels normal to an axis, for pictures of the field: of z, x runs across and y up; of y, x and z; of x,
/// y and z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// The axis that it is normal to.
    pub axis: Axis,
    /// Its place along that axis in m.
    pub at: f64,
    /// Side in m.
    pub size: f64,
    /// Pixels along each side, ends included.
    pub pixels: usize,
    /// Middle in m, across and up.
    pub center: [f64; 2],
}

impl Plane {
    /// A plane at height z, of `pixels` x `pixels` samples at center + linspace(-size/2, size/2, pixels).
    ///
    /// # Errors
    /// As [`Plane::normal_to`].
    pub fn new(z: f64, size: f64, pixels: usize, center: [f64; 2]) -> Result<Self, Error> {
        Self::normal_to(Axis::Z, z, size, pixels, center)
    }

    /// A plane normal to `axis` at the place `at` along it, sampled as that of [`Plane::new`].
    ///
    /// # Errors
    /// A coordinate that is not finite, a size that is not above 0, fewer than 2 or more than 8192 pixels.
    pub fn normal_to(axis: Axis, at: f64, size: f64, pixels: usize, center: [f64; 2]) -> Result<Self, Error> {
        vector(&format!("plane {axis} and center"), &[at, center[0], center[1]])?;
        real("plane.size", size, 0.0, true)?;
        if !(2..=8192).contains(&pixels) {
            return Err(Error::invalid("plane.pixels", pixels, "give 2 to 8192"));
        }
        Ok(Self { axis, at, size, pixels, center })
    }

    /// The planes that show `points`, at least two wavelengths around them, those with the most points first: one where
    /// they lie in a plane normal to z, y or x; else one for each of their places along the axis with the fewest, at
    /// most four. All are equal but for their place.
    #[must_use]
    pub fn around(points: &[[f64; 3]], wavelength: f64) -> Vec<Self> {
        let layers = |axis| Self::layers(axis, points, wavelength);
        let mut planes = Axis::ALL.map(layers).into_iter().min_by_key(Vec::len).unwrap_or_default();
        planes.truncate(MOST_PLANES);
        planes
    }

    /// Two upright planes through each of the first four traps, all of one size: those normal to y, then those normal to
    /// x. A trap is a node, and a plane across the axis may contain only nodes.
    #[must_use]
    pub(crate) fn upright(traps: &[[f64; 3]], wavelength: f64) -> Vec<Self> {
        let through = |axis: Axis| {
            let middle = move |trap: &[f64; 3]| (trap[axis.index()], axis.others().map(|k| trap[k]));
            let size = TRAP * wavelength;
            let plane = move |(at, center)| Self { axis, at, size, pixels: PIXELS, center };
            traps.iter().take(MOST_PLANES).map(middle).map(plane)
        };
        through(Axis::Y).chain(through(Axis::X)).collect()
    }

    /// The plane normal to y through the middle of a body of those bounds, which shows it and `points`.
    pub(crate) fn through_body(body: [[f64; 2]; 3], points: &[[f64; 3]], wavelength: f64) -> Self {
        let corners = [0, 1].map(|end| body.map(|side| side[end]));
        let around = Self::layers(Axis::Y, &[points, &corners].concat(), wavelength)[0];
        Self { at: 0.5 * (body[1][0] + body[1][1]), ..around }
    }

    /// Whether the plane cuts the box of those bounds.
    pub(crate) fn cuts(&self, bounds: [[f64; 2]; 3]) -> bool {
        let within = |k: usize, at: f64, half: f64| bounds[k][0] < at + half && at - half < bounds[k][1];
        let mut beside = self.axis.others().into_iter().zip(self.center);
        within(self.axis.index(), self.at, 0.0) && beside.all(|(k, at)| within(k, at, 0.5 * self.size))
    }

    /// The planes normal to `axis` that show all `points`, those with the most of them first; at least one.
    pub(crate) fn layers(axis: Axis, points: &[[f64; 3]], wavelength: f64) -> Vec<Self> {
        let bounds = bounds(points);
        let [across, up] = axis.others().map(|k| bounds[k]);
        let middle = |[low, high]: [f64; 2]| 0.5 * low + 0.5 * high;
        let size = (across[1] - across[0]).max(up[1] - up[0]) + 2.0 * MARGIN * wavelength;
        let center = [middle(across), middle(up)];
        let mut places: Vec<f64> = points.iter().map(|point| point[axis.index()]).collect();
        places.sort_unstable_by(f64::total_cmp);
        // From each lowest place up to the last one for which the plane's middle is near to all.
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

    /// The place along `axis` that `z` or, of any axis, `at` tells, if either does.
    ///
    /// # Errors
    /// Both are given, or z for another axis.
    pub fn place(axis: Axis, z: Option<f64>, at: Option<f64>) -> Result<Option<f64>, Error> {
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

    /// Whether a picture shows this point: it lies within half a pixel of the square and a tenth of the wavelength of
    /// the plane.
    #[must_use]
    pub fn shows(&self, point: [f64; 3], wavelength: f64) -> bool {
        let edge = 0.5 * self.size * (1.0 + 1.0 / (self.pixels as f64 - 1.0));
        let inside =
            self.axis.others().into_iter().zip(self.center).all(|(k, center)| (point[k] - center).abs() <= edge);
        // Rounding in the middle of two places must not lose both.
        inside && (point[self.axis.index()] - self.at).abs() <= 1.001 * NEAR * wavelength
    }

    /// The same in whole micrometres, for messages.
    #[must_use]
    pub fn rounded(&self) -> Self {
        let round = |x: f64| libm::round(x * 1e6) / 1e6;
        Self { at: round(self.at), size: round(self.size), center: self.center.map(round), ..*self }
    }

    /// Coordinates in m of the pixels along a side of the picture: `side` 0 is across, 1 is up.
    #[must_use]
    pub fn samples(&self, side: usize) -> Vec<f64> {
        let step = self.size / (self.pixels as f64 - 1.0);
        (0..self.pixels).map(|i| self.center[side] - self.size / 2.0 + i as f64 * step).collect()
    }

    /// Coordinates in m of the pixels along an axis of space, `None` for the axis that is normal to the plane.
    #[must_use]
    pub fn along(&self, axis: Axis) -> Option<Vec<f64>> {
        let side = self.axis.others().into_iter().position(|k| k == axis.index())?;
        Some(self.samples(side))
    }

    /// The samples row by row, the axis across fastest: pixel (up, across) is at index up * pixels + across.
    #[must_use]
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

/// The number as a person would write it.
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
