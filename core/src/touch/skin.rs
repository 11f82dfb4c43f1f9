//! Skin: the spectrum of radiation pressure in frames that repeat, the motion that it causes, its felt strength; hands.

use crate::prelude::*;
use crate::scene::{Array, Axis, Plane, distance};
use crate::touch::{Channel, GAIN, HIGHEST, Membrane, REACH, felt_width, steady, strength};

/// Spectral lines weaker than this fraction of the strongest one are rounding errors and are left out.
const QUIET: f32 = 1e-6;

/// Number of places whose spectra are summed at once, so that they stay in the cache.
const BLOCK: usize = 256;

/// Spectrum up to [`HIGHEST`] of the radiation pressure at P places, in a sequence of T frames that repeats without end.
#[derive(Clone, Debug)]
pub struct Pushes {
    count: usize,
    places: usize,
    frequencies: Vec<f64>,
    mean: Vec<f32>,
    lines: Vec<Complex32>,
}

impl Pushes {
    /// Creates a spectrum of zeros for `count` frames at `rate` frames per second.
    ///
    /// # Errors
    /// No frame, no place; the errors of [`frame_rate`]; more memory than allowed.
    pub fn new(count: usize, rate: f64, places: usize, control: &Control) -> Result<Self> {
        frame_rate(rate)?;
        if count == 0 || places == 0 {
            let value = alloc::format!("{count} at {places} places");
            return Err(Error::out_of_range("frames", value, "give at least one, and one place"));
        }
        let apart = rate / count as f64;
        // A line at the end is kept even if rounding has moved its frequency slightly above it.
        let lines = (HIGHEST / apart * (1.0 + 1e-9)) as usize;
        control.room("the spectrum at a skin", [0, places], bytes(8, &[lines, places.saturating_add(1)]))?;
        let frequencies = (1..=lines).map(|k| (k as f64 * apart).min(HIGHEST)).collect();
        Ok(Self { count, places, frequencies, mean: vec![0.0; places], lines: vec![Complex32::ZERO; lines * places] })
    }

    /// Adds frames (K, P) of radiation pressure in Pa, from frame `first` on. The pressure of a frame is constant
    /// during the frame, so that line h of T frames is harmonic h of the samples times sinc(h/T).
    ///
    /// # Errors
    /// Frames beyond the last, and rows of another length; a stop.
    pub fn add(&mut self, first: usize, values: &[f32], control: &mut Control) -> Result<()> {
        let (count, places) = (self.count, self.places);
        let frames = values.len() / places;
        if frames * places != values.len() || first + frames > count {
            let cure = alloc::format!("give {places} for each of {count} frames");
            return Err(Error::invalid("values", alloc::format!("{} from frame {first} on", values.len()), cure));
        }
        control.room("the factors of lines", [0, frames], bytes(8, &[self.frequencies.len(), frames]))?;
        let mut factors = Vec::with_capacity(self.frequencies.len() * frames);
        for harmonic in 1..=self.frequencies.len() {
            control.pulse()?;
            let half = PI * harmonic as f64 / count as f64;
            let sinc = math::sin(half) / half * 2.0 / count as f64;
            factors.extend((first..first + frames).map(|frame| {
                let turned = sinc * math::phasor(-TAU * (harmonic * frame % count) as f64 / count as f64);
                Complex32::new(turned.re as f32, turned.im as f32)
            }));
        }
        for start in (0..places).step_by(BLOCK) {
            let block = start..(start + BLOCK).min(places);
            for (t, row) in values.chunks_exact(places).enumerate() {
                control.pulse()?;
                let row = &row[block.clone()];
                let mean = &mut self.mean[block.clone()];
                mean.iter_mut().zip(row).for_each(|(sum, value)| *sum += value / count as f32);
                for (line, factors) in self.lines.chunks_exact_mut(places).zip(factors.chunks_exact(frames)) {
                    let factor = factors[t];
                    line[block.clone()].iter_mut().zip(row).for_each(|(sum, value)| *sum += factor * *value);
                }
            }
        }
        Ok(())
    }
}

getters! {
    Pushes:

    /// Returns the frequencies f (L,) of the spectral lines in Hz, 0 < f <= 500 Hz. There is none if the sequence
    /// repeats more often than 500 times a second.
    pub frequencies(self) -> &[f64] = &self.frequencies;

    /// Returns the mean pressure over time (P,) in Pa.
    pub mean(self) -> &[f32] = &self.mean;

    /// Returns the complex amplitudes (L, P) in Pa: a line's pressure at time t is the real part of amplitude times
    /// e^(2 pi j f t).
    pub lines(self) -> &[Complex32] = &self.lines;
}

/// Returns, for each of L spectral lines (L, P), whether it is above rounding errors at any place.
pub fn live_lines(lines: &[Complex32], places: usize) -> Vec<bool> {
    let largest = |line: &[Complex32]| line.iter().map(Complex32::norm_sqr).fold(0.0, f32::max);
    let loudest: Vec<f32> = lines.chunks_exact(places).map(|line| math::sqrtf(largest(line))).collect();
    let most = loudest.iter().copied().fold(0.0, f32::max);
    loudest.iter().map(|&each| each > QUIET * most).collect()
}

/// Motion of a flat skin at each spectral line, and the factors by which it exceeds the thresholds of both tactile
/// channels.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Skin {
    /// Frequencies (L,) of the lines in Hz.
    pub frequencies: Vec<f64>,
    /// Complex displacements (L, P) in m: a line's motion at time t is the real part of displacement times e^(2 pi j f
    /// t).
    pub displacement: Vec<Complex32>,
    /// Factor by which the motion exceeds the threshold of the slow channel (P,).
    pub slow: Vec<f64>,
    /// Factor by which the motion exceeds the threshold of the fast channel (P,).
    pub fast: Vec<f64>,
}

impl Skin {
    /// Predicts the motion under pressure lines (L, R, C) in Pa at frequencies (L,) in Hz, on squares of side `step` in
    /// m. The slow channel senses the gradient of the displacement times `reach` in m; the fast channel senses the
    /// displacement.
    ///
    /// # Errors
    /// The errors of [`Membrane::moved`].
    pub fn on_plane(
        membrane: &Membrane,
        frequencies: &[f64],
        lines: &[Complex32],
        [rows, columns]: [usize; 2],
        [step, reach]: [f64; 2],
        control: &mut Control,
    ) -> Result<Self> {
        let places = rows * columns;
        let live = live_lines(lines, places.max(1));
        let tones: Vec<f64> = frequencies.iter().zip(&live).filter(|&(_, &live)| live).map(|(&f, _)| f).collect();
        let pushing = lines.chunks_exact(places.max(1)).zip(&live).filter(|&(_, &live)| live);
        let pushing: Vec<Complex32> = pushing.flat_map(|(line, _)| line).copied().collect();
        let moved = membrane.moved(&tones, &pushing, [rows, columns], step, control)?;
        let squares: Vec<f32> = moved.iter().map(Complex32::norm_sqr).collect();
        let slopes: Vec<f32> = moved.chunks_exact(places).flat_map(|line| slopes(line, columns, step)).collect();
        let fast = Channel::Fast.excess(&tones, &squares, places);
        let slow = Channel::Slow.excess(&tones, &slopes, places).into_iter().map(|each| reach * each).collect();
        let mut displacement = vec![Complex32::ZERO; lines.len()];
        let into = displacement.chunks_exact_mut(places).zip(&live).filter(|(_, live)| **live);
        into.zip(moved.chunks_exact(places)).for_each(|((to, _), from)| to.copy_from_slice(from));
        Ok(Self { frequencies: frequencies.to_vec(), displacement, slow, fast })
    }
}

impl Skin {
    /// Returns the displacement in m of a range of places at a time in s, without its mean over time.
    pub fn motion(&self, time: f64, places: Range<usize>) -> Vec<f32> {
        let mut moved = vec![0.0; places.len()];
        for (frequency, line) in self.frequencies.iter().zip(self.displacement.chunks_exact(self.slow.len())) {
            let turned = math::phasor(TAU * frequency * time);
            let (re, im) = (turned.re as f32, turned.im as f32);
            moved.iter_mut().zip(&line[places.clone()]).for_each(|(sum, w)| *sum += re * w.re - im * w.im);
        }
        moved
    }

    /// Returns the root mean square over time of the displacement (P,) in m.
    pub fn rms(&self) -> Vec<f32> {
        let mut squares = vec![0.0; self.slow.len()];
        for line in self.displacement.chunks_exact(squares.len()) {
            squares.iter_mut().zip(line).for_each(|(sum, w)| *sum += w.norm_sqr() / 2.0);
        }
        squares.into_iter().map(math::sqrtf).collect()
    }

    /// Returns the felt strength (P,); 1 is the threshold.
    pub fn strength(&self) -> Vec<f64> {
        self.slow.iter().zip(&self.fast).map(|(&slow, &fast)| strength(slow, fast)).collect()
    }
}

/// Returns |gradient|^2 of a spectral line (R, C): central differences inside, one-sided differences at the edges.
fn slopes(line: &[Complex32], columns: usize, step: f64) -> Vec<f32> {
    let rows = line.len() / columns;
    let part = |k: usize, at: usize, side: usize, stride: usize| {
        let (below, above) = (at.min(1), (side - 1 - at).min(1));
        let way = (below + above).max(1) as f32 * step as f32;
        ((line[k + above * stride] - line[k - below * stride]) / way).norm_sqr()
    };
    let place = |k: usize| part(k, k / columns, rows, columns) + part(k, k % columns, columns, 1);
    (0..line.len()).map(place).collect()
}

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
pub fn hand(points: &[[f64; 3]], array: &Array, margin: f64, pixels: usize) -> Result<Plane> {
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
    /// The radiation pressure (P,) in Pa that the channel of pressure passes.
    pub pressed: Vec<f64>,
    /// Side of the square around a place in m.
    step: f64,
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
        pushed: &mut dyn FnMut(usize) -> Result<Vec<f32>>,
        control: &mut Control,
    ) -> Result<Self> {
        let side = places.len().isqrt();
        if side < 2 || side * side != places.len() {
            return Err(Error::out_of_range("places", places.len(), "give the square of 2 or more"));
        }
        let stride = stride(count, frame_rate(rate)?);
        let mut pushes = Pushes::new(count / stride, rate / stride as f64, places.len(), control)?;
        if pushes.frequencies().is_empty() {
            let lap = format!("{} a second", rate / count as f64);
            return Err(Error::out_of_range("laps", lap, "give at most 500: the thresholds end at 500 Hz"));
        }
        for sample in 0..count / stride {
            pushes.add(sample, &pushed(sample * stride)?, control)?;
        }
        let [speed, loss, mass] = Membrane::SKIN;
        let membrane = Membrane::new(speed, loss, mass)?;
        let step = distance(places[0], places[1]);
        let (frequencies, lines) = (pushes.frequencies(), pushes.lines());
        let skin = Skin::on_plane(&membrane, frequencies, lines, [side, side], [step, REACH], control)?;
        Ok(Self { skin, pressed: steady(frequencies, lines, places.len()), step, count, rate })
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

    /// Returns the force in N of a contact that is felt alike, to a factor of 2.
    pub fn force(&self) -> f64 {
        GAIN * self.step * self.step * self.pressed.iter().sum::<f64>()
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

#[cfg(test)]
#[path = "tests/skin.rs"]
mod tests;
