//! Sources: an array's transducers, prepared for the kernels, and their waves in f64 by eq. (5) of Suzuki et al. 2021.

use crate::kernels::{Radiation, Source, SourceList, padded};
use crate::prelude::*;
use crate::scene::{Array, Medium, check_places, distance};

/// An array in a medium, prepared to compute rows of the propagation matrix G. Positions are in wavelengths, relative to the
/// array's middle.
///
/// A distance in wavelengths *is* a phase in turns. The f32 rows therefore need no multiplication, and no rounding,
/// to get the phase from the distance.
#[derive(Clone, Debug)]
pub(crate) struct Sources {
    pub(crate) array: Array,
    pub(crate) medium: Medium,
    centre: [f64; 3],
    pub(crate) transducers: SourceList,
    pub(crate) radiation: Radiation,
}

impl Sources {
    pub(crate) fn new(array: &Array, medium: Medium) -> Self {
        let centre = array.centre();
        let wavelength = medium.wavelength();
        // P0 cancels, because the reference is 1000 P0.
        let unit = 1.0 / (1000.0 * wavelength);
        let transducers: Vec<_> = (0..array.len())
            .map(|i| {
                let Complex64 { re, im } = array.effect(i);
                let (amplitude, turns) = if im == 0.0 && re >= 0.0 {
                    (unit * re, 0.0)
                } else {
                    (unit * math::hypot(re, im), math::atan2(im, re) / TAU)
                };
                Source {
                    position: wavelengths(array.positions()[i], centre, wavelength),
                    normal: array.normals()[i].map(|x| x as f32),
                    amplitude: amplitude as f32,
                    turns: turns as f32,
                }
            })
            .collect();
        let decay = -medium.absorption * wavelength * core::f64::consts::LOG2_E;
        let radiation = Radiation {
            decay: (decay < 0.0).then_some(decay as f32),
            pattern: array.transducer().directivity.pattern(medium.wavenumber()),
        };
        Self { array: array.clone(), medium, centre, transducers: SourceList::new(&transducers), radiation }
    }

    /// Converts points to wavelengths relative to the array's middle: lists of x, y and z, padded with copies of the last
    /// point.
    pub(crate) fn frame(&self, points: &[[f64; 3]]) -> [Vec<f32>; 3] {
        let mut frame = [(); 3].map(|()| vec![0.0; padded(points.len())]);
        self.write_frame(points, &mut frame);
        frame
    }

    /// Writes the points into `frame`, three lists as [`Sources::frame`] returns them, for the same number of points.
    pub(crate) fn write_frame(&self, points: &[[f64; 3]], frame: &mut [Vec<f32>; 3]) {
        for (j, point) in points.iter().enumerate() {
            let position = wavelengths(*point, self.centre, self.medium.wavelength());
            for (axis, x) in frame.iter_mut().zip(position) {
                axis[j] = x;
            }
        }
        // The kernels compute the padding too, so it repeats the last point. Padding with zeros may lie so far from the
        // array that absorption makes its results denormal numbers, each of which takes a hundred cycles.
        for axis in frame {
            let (places, padding) = axis.split_at_mut(points.len());
            if let Some(&last) = places.last() {
                padding.fill(last);
            }
        }
    }

    /// Checks that there are points, and that all are finite and near enough for phases in f32.
    pub(crate) fn check_points(&self, points: &[[f64; 3]]) -> Result<()> {
        refuse_if!(points.is_empty(), Error::missing("points", "empty", "give at least one point"));
        check_places(self.centre, self.medium, "points", ".position", points)
    }

    /// The unit of the rows in Pa.
    pub(crate) fn reference(&self) -> f64 {
        1000.0 * self.array.transducer().source_pressure
    }

    /// Returns the pressure in Pa of transducer i at a point, at full drive and with its response, in double precision.
    pub(crate) fn exact(&self, i: usize, point: [f64; 3]) -> Complex64 {
        self.array.effect(i) * self.sent(i, point)
    }

    /// Returns the pressure in Pa of transducer i at a point, at full drive and without its response, in double precision.
    pub(crate) fn sent(&self, i: usize, point: [f64; 3]) -> Complex64 {
        let transducer = self.array.transducer();
        let ray = Vec3(point) - self.array.positions()[i];
        let r = ray.norm().max(self.medium.wavelength() / 100.0);
        let cos_theta = ray.dot(self.array.normals()[i]) / r;
        let k = self.medium.wavenumber();
        let amplitude = transducer.source_pressure / r
            * transducer.directivity.value(cos_theta, k)
            * math::exp(-self.medium.absorption * r);
        Complex64::new(amplitude * math::cos(k * r), amplitude * math::sin(k * r))
    }

    /// Checks that no point is nearer to transducer `i` than a hundredth of the wavelength.
    pub(crate) fn check_distances(&self, i: usize, points: &[[f64; 3]]) -> Result<()> {
        points.iter().enumerate().try_for_each(|(j, &point)| self.check_distance(i, j, point))
    }

    /// Checks that a point is not nearer to transducer `i` than a hundredth of the wavelength. Errors name it as point `j`.
    pub(crate) fn check_distance(&self, i: usize, j: usize, point: [f64; 3]) -> Result<()> {
        let least = self.medium.wavelength() / 100.0;
        let distance = distance(self.array.positions()[i], point);
        if distance < least {
            let value = format!("{distance:.3e} m from transducer {i}");
            let cure = format!("move it at least {least:.3e} m (a hundredth of the wavelength) away");
            return Err(Error::new(ErrorCode::TooNear, format!("points[{j}]"), value, cure));
        }
        Ok(())
    }
}

/// Converts a position to wavelengths relative to `centre`; it is rounded to f32 only after the subtraction.
fn wavelengths(position: [f64; 3], centre: [f64; 3], wavelength: f64) -> [f32; 3] {
    [0, 1, 2].map(|axis| ((position[axis] - centre[axis]) / wavelength) as f32)
}

#[cfg(test)]
#[path = "tests/sources.rs"]
mod tests;
