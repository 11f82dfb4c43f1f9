//! Touch: the predicted motion of a skin under frames that repeat for ever, and its felt strength.

use core::ops::Range;

use midair::touch::{Pushes, REACH, Membrane, Skin, felt_width, strength};
use midair::{Complex32, Control, Error, Medium};

use crate::studio::Studio;

/// Fewest samples of a turn, and the least rate of samples in Hz, if not all frames are needed.
const SAMPLES: usize = 80;
const RATE: f64 = 4000.0;

/// The motion of a skin, and the frames that cause it.
pub(crate) struct Touch {
    skin: Skin,
    /// Number of frames.
    count: usize,
    /// Frames per second.
    rate: f64,
}

impl Studio {
    pub(crate) fn skin(&mut self, rate: f64) -> Result<(), Error> {
        let scene = &self.opened()?.scene;
        let (transducers, medium) = (scene.array().len(), scene.medium());
        let places: Vec<[f64; 3]> = self.numbers_in.as_chunks().0.to_vec();
        let side = places.len().isqrt();
        if side < 2 || side * side != places.len() {
            return Err(Error::invalid("places", places.len(), "give the square of 2 or more"));
        }
        let count = self.frames.len() / transducers;
        let stride = stride(count, rate);
        let mut pushes = Pushes::new(count / stride, rate / stride as f64, places.len())?;
        if pushes.frequencies().is_empty() {
            let lap = format!("{} a second", rate / count as f64);
            return Err(Error::invalid("laps", lap, "give at most 1000: a skin perceives nothing above 1 kHz"));
        }
        for sample in 0..count / stride {
            self.frame(sample * stride)?;
            self.field()?;
            pushes.add(sample, &pushed(&self.pressures, medium))?;
        }
        self.frame(0)?;
        let [speed, loss, mass] = Membrane::SKIN;
        let membrane = Membrane::new(speed, loss, mass)?;
        let step = apart(places[0], places[1]);
        let (frequencies, sides) = (pushes.frequencies(), [side, side]);
        let skin = Skin::on_plane(&membrane, frequencies, pushes.lines(), sides, [step, REACH], &mut Control::none())?;
        let felt: Vec<f64> = skin.slow.iter().zip(&skin.fast).map(|(&slow, &fast)| strength(slow, fast)).collect();
        let best = largest(&felt);
        let touch = Touch { skin, count, rate };
        self.numbers = vec![felt_width(&felt, &places, best), touch.peak()];
        self.numbers.extend(felt);
        self.touch = Some(touch);
        Ok(())
    }

    pub(crate) fn moved(&mut self, frame: usize) -> Result<(), Error> {
        let touch = self.touch.as_ref().filter(|touch| frame < touch.count);
        let touch = touch.ok_or_else(|| Error::invalid("frame", frame, "predict the skin's motion first"))?;
        let places = 0..touch.skin.slow.len();
        self.numbers = touch.at(frame, places).into_iter().map(f64::from).collect();
        Ok(())
    }
}

impl Touch {
    /// Returns the displacement of places in m at the start of a frame.
    fn at(&self, frame: usize, places: Range<usize>) -> Vec<f32> {
        self.skin.motion(frame as f64 / self.rate, places)
    }

    /// Returns the largest displacement in m of the place that moves most.
    fn peak(&self) -> f64 {
        let rms: Vec<f64> = self.skin.rms().into_iter().map(f64::from).collect();
        let best = largest(&rms);
        let course = (0..self.count).flat_map(|frame| self.at(frame, best..best + 1));
        course.fold(0.0, |most, w| f64::from(w.abs()).max(most))
    }
}

/// Returns the number of frames from one sample to the next, a divisor of their number.
fn stride(count: usize, rate: f64) -> usize {
    let most = (count / SAMPLES).min((rate / RATE) as usize);
    (1..=most).rev().find(|stride| count.is_multiple_of(*stride)).unwrap_or(1)
}

/// Returns radiation pressures in Pa.
fn pushed(pressures: &[Complex32], medium: Medium) -> Vec<f32> {
    pressures.iter().map(|p| medium.radiation(f64::from(p.norm())) as f32).collect()
}

/// Returns the index of the largest value.
fn largest(values: &[f64]) -> usize {
    (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0)
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis])).sum::<f64>().sqrt()
}
