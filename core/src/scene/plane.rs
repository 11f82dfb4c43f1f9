//! Plane: a square of pixels in which a field is computed.

use alloc::vec::Vec;

use crate::error::{Error, real};
use crate::scene::array::vector;
use crate::scene::geometry::bounds;

/// A square of pixels at height z, for pictures of the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Height in m.
    pub z: f64,
    /// Side in m.
    pub size: f64,
    /// Pixels along each side, ends included.
    pub pixels: usize,
    /// Middle (x, y) in m.
    pub center: [f64; 2],
}

impl Plane {
    /// A plane of `pixels` x `pixels` samples at center + linspace(-size/2, size/2, pixels).
    ///
    /// # Errors
    /// A coordinate that is not finite, a size that is not above 0, fewer than 2 or more than 8192 pixels.
    pub fn new(z: f64, size: f64, pixels: usize, center: [f64; 2]) -> Result<Self, Error> {
        vector("plane z and center", &[z, center[0], center[1]])?;
        real("plane.size", size, 0.0, true)?;
        if !(2..=8192).contains(&pixels) {
            return Err(Error::invalid("plane.pixels", pixels, "give 2 to 8192"));
        }
        Ok(Self { z, size, pixels, center })
    }

    /// The plane around `points`: z is theirs if equal within 1 um, else their mean; the centre the middle of
    /// their bounding box; the side 1.25 times its larger one, at least 0.04 m.
    #[must_use]
    pub fn around(points: &[[f64; 3]]) -> Self {
        let [x, y, z] = bounds(points);
        let middle = |[low, high]: [f64; 2]| 0.5 * low + 0.5 * high;
        let mean = points.iter().map(|point| point[2] / points.len() as f64).sum();
        let size = (1.25 * (x[1] - x[0]).max(y[1] - y[0])).max(0.04);
        let z = if z[1] - z[0] <= 1e-6 { points.first().map_or(0.0, |point| point[2]) } else { mean };
        Self { z, size, pixels: 200, center: [middle(x), middle(y)] }
    }

    /// The samples along x (axis 0) or y (axis 1), in m.
    #[must_use]
    pub fn axis(&self, axis: usize) -> Vec<f64> {
        let step = self.size / (self.pixels as f64 - 1.0);
        (0..self.pixels).map(|i| self.center[axis] - self.size / 2.0 + i as f64 * step).collect()
    }

    /// The samples row by row, x fastest: pixel (y, x) is at index y * pixels + x.
    #[must_use]
    pub fn points(&self) -> Vec<[f64; 3]> {
        let xs = self.axis(0);
        self.axis(1).iter().flat_map(|&y| xs.iter().map(move |&x| [x, y, self.z])).collect()
    }
}
