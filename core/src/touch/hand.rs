//! Hand: the plane of a hand at points, and its touch under frames that repeat for ever.

use core::ops::Range;

use crate::error::frame_rate;
use crate::prelude::*;
use crate::scene::{Array, Axis, Plane, distance};
use crate::touch::membrane::Membrane;
use crate::touch::skin::{Pushes, Skin};
use crate::touch::thresholds::{REACH, felt_width};

/// Fewest samples of all frames together, and the least rate of samples in Hz, if not all frames are needed.
const SAMPLES: usize = 80;
const RATE: f64 = 4000.0;

/// Returns the plane of a hand through the middle of points in m, with a margin in m around them: normal to the axis along which the
/// points are farthest from the array.
///
/// # Errors
/// No points, too few pixels.
///
/// ```
/// let array = midair::Array::grid(10, 10, 10e-3)?;
/// let hand = midair::touch::hand(&[[0.0, 0.0, 0.1], [0.02, 0.01, 0.1]], &array, 0.02, 64)?;
/// assert_eq!((hand.axis, hand.at, hand.center), (midair::Axis::Z, 0.1, [0.01, 0.005]));
/// assert!((hand.size - 0.06).abs() < 1e-15);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn hand(points: &[[f64; 3]], array: &Array, margin: f64, pixels: usize) -> Result<Plane, Error> {
    let side = |axis: usize| {
        let along = points.iter().map(|point| point[axis]);
        (along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max))
    };
    let sides = [0, 1, 2].map(side);
    let middle = sides.map(|(least, most)| f64::midpoint(least, most));
    let positions = array.positions();
    let away = [0, 1, 2].map(|axis| {
        let mean = positions.iter().map(|position| position[axis]).sum::<f64>() / positions.len() as f64;
        (middle[axis] - mean).abs()
    });
    let normal = (1..3).fold(0, |normal, axis| if away[axis] > away[normal] { axis } else { normal });
    let (right, up) = [(1, 2), (0, 2), (0, 1)][normal];
    let size = [right, up].map(|axis| sides[axis].1 - sides[axis].0).into_iter().fold(0.0, f64::max) + 2.0 * margin;
    let axis = [Axis::X, Axis::Y, Axis::Z][normal];
    Plane::normal_to(axis, middle[normal], size, pixels, [middle[right], middle[up]])
}

/// The motion of the skin of a hand under frames that repeat for ever.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Touch {
    /// The skin's motion and its excess of the thresholds.
    pub skin: Skin,
    /// Number of frames.
    count: usize,
    /// Frames per second.
    rate: f64,
}

impl Touch {
    /// Predicts the touch of a fingertip's skin at places (P,) in m, a square lattice, under `count` frames at `rate` frames per
    /// second. `pushed` returns the radiation pressures (P,) in Pa of a frame. Frames that change slowly are not all needed.
    ///
    /// # Errors
    /// Places that are no square lattice, no frame, laps that a skin does not perceive; the errors of `pushed`.
    pub fn of_frames(
        count: usize,
        rate: f64,
        places: &[[f64; 3]],
        pushed: &mut dyn FnMut(usize) -> Result<Vec<f32>, Error>,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let side = places.len().isqrt();
        if side < 2 || side * side != places.len() {
            return Err(Error::invalid("places", places.len(), "give the square of 2 or more"));
        }
        let stride = stride(count, frame_rate(rate)?);
        let mut pushes = Pushes::new(count / stride, rate / stride as f64, places.len(), control)?;
        if pushes.frequencies().is_empty() {
            let lap = format!("{} a second", rate / count as f64);
            return Err(Error::invalid("laps", lap, "give at most 1000: a skin perceives nothing above 1 kHz"));
        }
        for sample in 0..count / stride {
            pushes.add(sample, &pushed(sample * stride)?, control)?;
        }
        let [speed, loss, mass] = Membrane::SKIN;
        let membrane = Membrane::new(speed, loss, mass)?;
        let step = distance(places[0], places[1]);
        let (frequencies, lines) = (pushes.frequencies(), pushes.lines());
        let skin = Skin::on_plane(&membrane, frequencies, lines, [side, side], [step, REACH], control)?;
        Ok(Self { skin, count, rate })
    }

    /// The number of frames.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Returns the displacement in m of a range of places at the start of a frame.
    pub fn at(&self, frame: usize, places: Range<usize>) -> Vec<f32> {
        self.skin.motion(frame as f64 / self.rate, places)
    }

    /// Returns the largest displacement in m of the place that moves most.
    pub fn peak(&self) -> f64 {
        let rms: Vec<f64> = self.skin.rms().into_iter().map(f64::from).collect();
        let best = largest(&rms);
        let course = (0..self.count).flat_map(|frame| self.at(frame, best..best + 1));
        course.fold(0.0, |most, w| f64::from(w.abs()).max(most))
    }

    /// Returns the felt width in m at the strongest of the places.
    pub fn width(&self, places: &[[f64; 3]]) -> f64 {
        let strength = self.skin.strength();
        felt_width(&strength, places, largest(&strength))
    }
}

/// Returns the number of frames from one sample to the next, a divisor of their number.
fn stride(count: usize, rate: f64) -> usize {
    let most = (count / SAMPLES).min((rate / RATE) as usize);
    (1..=most).rev().find(|stride| count.is_multiple_of(*stride)).unwrap_or(1)
}

/// Returns the index of the largest value.
fn largest(values: &[f64]) -> usize {
    (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0)
}
