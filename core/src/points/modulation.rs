//! Modulation: factors of a target that repeat, 1 - depth + depth s(t).

use crate::error::find;
use crate::prelude::*;

/// Tolerance of times, relative to a frame or a period, so that rounding errors never decide whether a time is before or after
/// a jump.
pub(super) const ROUNDING: f64 = 1e-9;

/// A shape s as a function of the periods since the start, from 1.
type Shape = fn(f64) -> f64;

/// The shapes. The force on a hand is proportional to the square of the pressure: with "sqrt" it has one line in its spectrum.
const SHAPES: [(&str, Shape); 3] = [
    ("sqrt", |periods| math::sqrt(f64::midpoint(1.0, math::cos(TAU * periods)))),
    ("cosine", |periods| f64::midpoint(1.0, math::cos(TAU * periods))),
    ("square", |periods| f64::from(u8::from((periods + ROUNDING) % 1.0 < 0.5))),
];

/// A modulation of the amplitude: 1 - depth + depth s(t), where s is a shape or samples, and repeats.
#[derive(Clone, Debug)]
pub struct Modulation {
    frequency: f64,
    /// The highest frequency that frames must be able to represent, in Hz.
    finest: f64,
    depth: f64,
    wave: Wave,
}

#[derive(Clone, Debug)]
enum Wave {
    Shape(Shape),
    /// Values (S,) of s in a period.
    Samples(Vec<f64>),
}

impl Modulation {
    /// Creates a modulation of a frequency in Hz, and of a shape: sqrt, cosine or square.
    ///
    /// # Errors
    /// A frequency that is not above 0, an unknown shape, a depth beyond 0 to 1.
    pub fn new(frequency: f64, shape: &str, depth: f64) -> Result<Self> {
        real("frequency", frequency, 0.0, true)?;
        let wave = Wave::Shape(find("shape", shape, &SHAPES, |(name, _)| *name)?.1);
        Ok(Self { frequency, finest: frequency, depth: deep(depth)?, wave })
    }

    /// Creates a modulation by samples (S,) from 0 to 1, at a rate in Hz.
    ///
    /// # Errors
    /// No samples, samples or a depth beyond 0 to 1, a rate that is not above 0.
    pub fn of_samples(samples: Vec<f64>, rate: f64, depth: f64) -> Result<Self> {
        if samples.is_empty() {
            let cure = "give samples (S,) from 0 to 1, and samples_rate in Hz";
            return Err(Error::invalid("samples", "an empty list", cure));
        }
        if let Some(k) = samples.iter().position(|sample| !(0.0..=1.0).contains(sample)) {
            let value = format!("{:?}", samples[k]);
            return Err(Error::out_of_range(format!("samples[{k}]"), value, "give numbers from 0 to 1"));
        }
        let rate = real("samples_rate", rate, 0.0, true)?;
        let frequency = rate / samples.len() as f64;
        Ok(Self { frequency, finest: rate / 2.0, depth: deep(depth)?, wave: Wave::Samples(samples) })
    }

    /// The frequency in Hz.
    pub fn frequency(&self) -> f64 {
        self.frequency
    }

    /// The highest frequency that frames must be able to represent, in Hz.
    pub fn finest(&self) -> f64 {
        self.finest
    }

    /// Returns the factor after a number of periods since the start.
    pub fn factor(&self, periods: f64) -> f64 {
        let s = match &self.wave {
            Wave::Shape(shape) => shape(periods),
            Wave::Samples(samples) => {
                samples[math::floor(samples.len() as f64 * (periods + ROUNDING)) as usize % samples.len()]
            }
        };
        1.0 - self.depth + self.depth * s
    }
}

fn deep(depth: f64) -> Result<f64> {
    if (0.0..=1.0).contains(&depth) {
        return Ok(depth);
    }
    Err(Error::out_of_range("depth", format!("{depth:?}"), "give a number from 0 to 1"))
}
