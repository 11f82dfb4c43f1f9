//! Air: sound speed, density and absorption as functions of temperature, humidity and air pressure (ISO 9613-1).

use crate::prelude::*;
use crate::scene::medium::Medium;

/// 0 degrees C, in K.
const ZERO: f64 = 273.15;

/// The standard air pressure in Pa (1 atm), used where none is given.
const STANDARD: f64 = 101_325.0;

/// The temperature in degrees C of the air around boards, where none is given.
const ROOM: f64 = 25.0;

/// The relative humidity of the air in percent, used where none is given.
const HUMIDITY: f64 = 50.0;

impl Medium {
    /// Returns air at a frequency in Hz, a temperature in degrees C, a relative humidity in percent and an air pressure in Pa.
    ///
    /// c = 331.3 sqrt(1 + T/273.15) m/s. The density is that of a mixture of two ideal gases, dry air and water vapour. The
    /// absorption follows ISO 9613-1, eq. (3) to (5) and annex B, which is accurate within 10 % from -20 to 50 degrees C.
    ///
    /// ```
    /// let air = midair::Medium::air(40e3, 20.0, 50.0, 101_325.0)?;
    /// assert!((air.absorption * 8.686 - 1.32).abs() < 0.01); // dB/m
    /// assert!((air.density - 1.199).abs() < 0.001);
    /// # Ok::<(), midair::Error>(())
    /// ```
    ///
    /// # Errors
    /// A temperature not above -273.15, a humidity above 100 or between 0 and 1, an air pressure outside of 10 to 200 kPa.
    pub fn air(frequency: f64, temperature: f64, humidity: f64, air_pressure: f64) -> Result<Self> {
        let sound_speed = Self::sound_speed_at(temperature)?;
        real("medium.humidity", humidity, 0.0, false)?;
        if humidity > 100.0 || (humidity > 0.0 && humidity < 1.0) {
            let cure = format!("give percent: 0, or 1 to 100 ({HUMIDITY} is usual)");
            return Err(Error::out_of_range("medium.humidity", humidity, cure));
        }
        if !(1e4..=2e5).contains(&air_pressure) {
            let cure = format!("give Pa, 10000 to 200000 (101.325 kPa are {STANDARD})");
            return Err(Error::out_of_range("medium.air_pressure", format!("{air_pressure:?}"), cure));
        }
        let kelvin = temperature + ZERO;
        // In hot air the formula for saturated vapour would exceed the air pressure. The partial pressure of vapour
        // is therefore limited to the air pressure.
        let vapour = (humidity / 100.0 * saturation(kelvin)).min(air_pressure);
        let density = (air_pressure - vapour) / (287.05 * kelvin) + vapour / (461.5 * kelvin);
        let absorption = absorption(frequency, kelvin, 100.0 * vapour / air_pressure, air_pressure / STANDARD);
        // The fields that do not depend on the air keep their defaults.
        let mut air = Self::default();
        (air.frequency, air.sound_speed, air.absorption, air.density) = (frequency, sound_speed, absorption, density);
        Ok(air)
    }

    /// Returns air of 25 degrees C, 50 % humidity and 101.325 kPa, the default of a scene whose array is a board.
    ///
    /// ```
    /// let air = midair::Medium::room(40e3)?;
    /// assert!((air.sound_speed - 346.13).abs() < 0.01 && (air.density - 1.177).abs() < 0.001);
    /// assert!((air.absorption - 0.160).abs() < 0.001);
    /// # Ok::<(), midair::Error>(())
    /// ```
    ///
    /// # Errors
    /// None: these numbers are in range, and the scene checks the frequency.
    pub fn room(frequency: f64) -> Result<Self> {
        Self::air(frequency, ROOM, HUMIDITY, STANDARD)
    }

    /// Returns the air for a temperature, a humidity and an air pressure. A missing temperature is computed from the sound
    /// speed; the other missing values are the defaults.
    pub(super) fn air_of(self, [temperature, humidity, pressure]: [Option<f64>; 3]) -> Result<Self> {
        let temperature = temperature.unwrap_or_else(|| self.temperature());
        Self::air(self.frequency, temperature, humidity.unwrap_or(HUMIDITY), pressure.unwrap_or(STANDARD))
    }
}

/// The pressure of saturated water vapour in Pa, eq. (B.2) and (B.3) of ISO 9613-1.
fn saturation(kelvin: f64) -> f64 {
    STANDARD * math::pow(10.0, -6.8346 * math::pow(273.16 / kelvin, 1.261) + 4.6151)
}

/// The absorption alpha in Np/m, eq. (3) to (5) of ISO 9613-1. `vapour` is the molar part of water vapour in percent,
/// `pressure` the air pressure in units of the standard pressure.
fn absorption(frequency: f64, kelvin: f64, vapour: f64, pressure: f64) -> f64 {
    let warmth = kelvin / 293.15;
    let oxygen = pressure * (24.0 + 4.04e4 * vapour * (0.02 + vapour) / (0.391 + vapour));
    let drag = math::exp(-4.17 * (1.0 / math::cbrt(warmth) - 1.0));
    let nitrogen = pressure / math::sqrt(warmth) * (9.0 + 280.0 * vapour * drag);
    let squared = frequency * frequency;
    let relaxation =
        |strength: f64, heat: f64, rate: f64| strength * math::exp(-heat / kelvin) / (rate + squared / rate);
    let relaxations = relaxation(0.01275, 2239.1, oxygen) + relaxation(0.1068, 3352.0, nitrogen);
    squared * (1.84e-11 / pressure * math::sqrt(warmth) + math::pow(warmth, -2.5) * relaxations)
}
