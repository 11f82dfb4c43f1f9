//! Membrane: viscoelastic skin under periodic pressure, solved for each line of the spectrum.
//!
//! At the angular frequency w, with the time factor e^(+j w t), the pressure p displaces the membrane by u. The
//! membrane has the mass m per area, the wave speed c and the loss factor eta:
//!
//! ```text
//! T (laplacian u - s^2 u) = -p,    T = m c^2 (1 + j eta),    s = j w/(c sqrt(1 + j eta)).
//! ```
//!
//! A point force F displaces a place at the distance r by u = F K_0(s r)/(2 pi T), with the modified Bessel function
//! `K_0`. These waves decay to 1/e in about 2 c/(eta w), so that high frequencies spread less far than low ones. At
//! 0 Hz an infinite membrane has no solution.

use crate::prelude::*;
use crate::touch::bessel::{modified_bessel, turn};
use crate::touch::fourier::Fourier;

/// Least and largest |z| in the table of `K_0`(z).
const LEAST: f64 = 1e-5;
const MOST: f64 = 400.0;
/// Number of entries of the table. Interpolation has a relative error of about 1e-6 |z|^2: 0.2 % at |z| = 43.
const ENTRIES: usize = 6000;

/// An infinite membrane, with the symbols of the module's head.
#[derive(Clone, Debug)]
pub struct Membrane {
    /// T in N/m.
    tension: Complex64,
    /// s at 1 Hz in 1/m.
    decay: Complex64,
    /// `K_0`(z) at [`ENTRIES`] numbers z that have the angle of s; log |z| is evenly spaced.
    table: Vec<Complex64>,
}

impl Membrane {
    /// Values for skin. The wave speed, in m/s, is within the 5 to 8 m/s of Frier et al. (EuroHaptics 2018). With the
    /// loss factor, waves of 200 Hz decay to 1/e in 26 mm. The mass, in kg/m^2, is fitted to the threshold of 0.4 mN at
    /// 200 Hz on the finger (Dalecki et al. 1995).
    pub const SKIN: [f64; 3] = [6.0, 0.4, 6.4];

    /// Creates a membrane from its wave speed in m/s, loss factor, and mass in kg/m^2.
    ///
    /// # Errors
    /// Numbers outside of 1e-6 to 1e6, with which single precision would not hold the motion.
    pub fn new(speed: f64, loss: f64, mass: f64) -> Result<Self> {
        for (item, value) in [("speed", speed), ("loss", loss), ("mass", mass)] {
            let within = (1e-6..=1e6).contains(&value);
            refuse_if!(!within, Error::out_of_range(item, value, "give a number from 1e-6 to 1e6"));
        }
        let elastic = Complex64::new(1.0, loss);
        let root = math::sqrt(math::hypot(1.0, loss)) * math::phasor(turn(elastic) / 2.0);
        let decay = Complex64::new(0.0, TAU) / (speed * root);
        let direction = math::phasor(turn(decay));
        let step = math::log(MOST / LEAST) / (ENTRIES - 1) as f64;
        let entry = |k| modified_bessel(0, LEAST * math::exp(step * k as f64) * direction);
        Ok(Self { tension: mass * speed * speed * elastic, decay, table: (0..ENTRIES).map(entry).collect() })
    }

    /// Returns T in N/m.
    pub fn tension(&self) -> Complex64 {
        self.tension
    }

    /// Returns s in 1/m for a frequency in Hz: waves decay as e^(-Re(s) r), and their phase falls by Im(s) r.
    pub fn decay(&self, frequency: f64) -> Complex64 {
        self.decay * frequency
    }

    /// Returns the displacement in m/N at a distance in m from a point force of a frequency in Hz.
    pub fn response(&self, frequency: f64, distance: f64) -> Complex64 {
        let size = math::hypot(self.decay.re, self.decay.im) * frequency * distance;
        let step = math::log(MOST / LEAST) / (ENTRIES - 1) as f64;
        let place = math::log(size.clamp(LEAST, MOST) / LEAST) / step;
        let below = (math::floor(place) as usize).min(ENTRIES - 2);
        let [a, b] = [self.table[below], self.table[below + 1]];
        (a + (b - a) * (place - below as f64)) / (TAU * self.tension)
    }

    /// Returns the displacement in m/Pa of a square of side `step` in m under pressure on it. The square is replaced by
    /// a disc of the same area.
    fn self_response(&self, frequency: f64, step: f64) -> Complex64 {
        let s = self.decay(frequency);
        let z = s * (step / math::sqrt(PI));
        (1.0 - z * modified_bessel(1, z)) / (s * s * self.tension)
    }

    /// Returns displacements (L, R, C) in m for pressure lines (L, R, C) in Pa at `frequencies` (L,) in Hz, on squares
    /// of side `step` in m. The pressure is convolved with the response to a point force by FFTs of at least twice the
    /// size, so that the membrane is infinite.
    ///
    /// # Errors
    /// Lists of wrong lengths, a stop, too little memory.
    ///
    /// ```
    /// use midair::{Complex32, Control, touch::Membrane};
    ///
    /// let membrane = Membrane::new(6.0, 0.4, 6.4)?;
    /// let mut pressure = [Complex32::ZERO; 64];
    /// pressure[27] = Complex32::ONE;
    /// let moved = membrane.moved(&[200.0], &pressure, [8, 8], 1e-3, &mut Control::none())?;
    /// let near = membrane.response(200.0, 2e-3) * 1e-6;
    /// assert!((f64::from(moved[29].re) - near.re).abs() < 1e-3 * near.norm());
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn moved(
        &self,
        frequencies: &[f64],
        lines: &[Complex32],
        [rows, columns]: [usize; 2],
        step: f64,
        control: &mut Control,
    ) -> Result<Vec<Complex32>> {
        let places = rows * columns;
        if lines.len() != frequencies.len() * places || places == 0 {
            let cure = alloc::format!("give {rows} x {columns} for each of {} frequencies", frequencies.len());
            return Err(Error::invalid("lines", alloc::format!("{} numbers", lines.len()), cure));
        }
        crate::error::real("the distance of places", step, 0.0, true)?;
        let [down, across] = [rows, columns].map(|side| (2 * side - 1).next_power_of_two().max(2));
        control.room("the waves of a skin", [0, places], bytes(16, &[2, down, across]))?;
        let waves = Waves { along: Fourier::new(across), up: Fourier::new(down), size: [down, across] };
        let mut displacement = vec![Complex32::ZERO; lines.len()];
        let pairs = lines.chunks_exact(places).zip(displacement.chunks_exact_mut(places));
        for (&frequency, (line, moved)) in frequencies.iter().zip(pairs) {
            let response = waves.spectrum(self, frequency, step, control)?;
            waves.spread(line, columns, &response, moved, control)?;
        }
        Ok(displacement)
    }
}

/// The Fourier transforms of a rectangle padded with zeros.
struct Waves {
    along: Fourier,
    up: Fourier,
    /// Numbers of rows and columns, powers of two.
    size: [usize; 2],
}

impl Waves {
    /// Returns a quarter (N/2 + 1, M/2 + 1) of the spectrum of the response to 1 Pa on a square. Response and spectrum
    /// are even along both axes, so that a quarter determines the rest.
    fn spectrum(
        &self,
        membrane: &Membrane,
        frequency: f64,
        step: f64,
        control: &mut Control,
    ) -> Result<Vec<Complex64>> {
        let [half, width] = self.size.map(|side| side / 2 + 1);
        // A transform and its inverse together multiply by the number of squares.
        let share = step * step / (self.size[0] * self.size[1]) as f64;
        let mut quarter = vec![Complex64::ZERO; half * width];
        for i in 0..half {
            control.pulse()?;
            for j in 0..width {
                quarter[i * width + j] = match (i, j) {
                    (0, 0) => membrane.self_response(frequency, step) * share / (step * step),
                    // The response at this distance was computed in row j, because it is symmetric in i and j.
                    _ if j < i && i < width => quarter[j * width + i],
                    _ => membrane.response(frequency, step * math::hypot(i as f64, j as f64)) * share,
                };
            }
        }
        let mut line = Vec::with_capacity(self.size[0].max(self.size[1]));
        for row in quarter.chunks_exact_mut(width) {
            mirror(row.iter().copied(), &mut line);
            self.along.forward(&mut line);
            row.copy_from_slice(&line[..width]);
        }
        for j in 0..width {
            mirror(quarter[j..].iter().step_by(width).copied(), &mut line);
            self.up.forward(&mut line);
            quarter[j..].iter_mut().step_by(width).zip(&line).for_each(|(to, from)| *to = *from);
        }
        Ok(quarter)
    }

    /// Writes to `moved` the convolution of a line (R, C) of `pressure` with the response, whose spectrum is
    /// `response`.
    fn spread(
        &self,
        pressure: &[Complex32],
        columns: usize,
        response: &[Complex64],
        moved: &mut [Complex32],
        control: &mut Control,
    ) -> Result<()> {
        let [down, across] = self.size;
        let rows = pressure.len() / columns;
        let mut wide = vec![Complex64::ZERO; rows * across];
        for (row, source) in wide.chunks_exact_mut(across).zip(pressure.chunks_exact(columns)) {
            control.pulse()?;
            let parts = source.iter().map(|p| Complex64::new(p.re.into(), p.im.into()));
            row.iter_mut().zip(parts).for_each(|(to, from)| *to = from);
            self.along.forward(row);
        }
        let mut line = vec![Complex64::ZERO; down];
        for k in 0..across {
            control.pulse()?;
            line.fill(Complex64::ZERO);
            line.iter_mut().zip(wide[k..].iter().step_by(across)).for_each(|(to, from)| *to = *from);
            self.up.forward(&mut line);
            let column = k.min(across - k);
            for (i, value) in line.iter_mut().enumerate() {
                *value *= response[i.min(down - i) * (across / 2 + 1) + column];
            }
            self.up.backward(&mut line);
            // The rows beyond those of the skin are padding.
            wide[k..].iter_mut().step_by(across).zip(&line).for_each(|(to, from)| *to = *from);
        }
        for (row, to) in wide.chunks_exact_mut(across).zip(moved.chunks_exact_mut(columns)) {
            self.along.backward(row);
            for (to, from) in to.iter_mut().zip(row) {
                *to = Complex32::new(from.re as f32, from.im as f32);
            }
        }
        Ok(())
    }
}

/// Fills `line` with n + 1 numbers, followed by the mirror image of those between the first and the last: 2 n numbers.
fn mirror(half: impl Iterator<Item = Complex64>, line: &mut Vec<Complex64>) {
    line.clear();
    line.extend(half);
    let last = line.len() - 1;
    line.extend_from_within(1..last);
    line[last + 1..].reverse();
}

#[cfg(test)]
#[path = "tests/membrane.rs"]
mod tests;
