//! Medium: frequency, sound speed, absorption and density of the air.

use crate::prelude::*;
use crate::scene::key::numbers;

numbers! {
    /// A homogeneous medium and the frequency used in it. The default is that of Suzuki et al. 2021: air of 14.5 degrees C
    /// without absorption, in which the wavelength is 8.5 mm. [`Array::medium`](crate::Array::medium) is the default for an
    /// array.
    pub struct Medium of "medium" {
        /// Frequency f in Hz; by default the frequency of the array's board, or 40e3.
        frequency = 40e3, above 0.0, such as 40e3;
        /// Sound speed c in m/s; by default that of the given temperature, else of 25 degrees C for a board, or 340.
        sound_speed = 340.0, above 0.0, such as 340.0;
        /// Absorption alpha of the amplitude in Np/m; by default that of the given air, else of room air for a board, or 0.
        absorption = 0.0, least 0.0, such as 0.15;
        /// Density rho in kg/m^3; by default that of the given air, else of room air for a board, or 1.223.
        density = 1.223, above 0.0, such as 1.2;
    }
    or by {
        /// Temperature T of the air in degrees C, instead of the sound speed c = 331.3 sqrt(1 + T/273.15) m/s; also changes
        /// absorption and density.
        temperature, such as 25.0;
        /// Relative humidity of the air in percent, for absorption (ISO 9613-1) and density; default 50.
        humidity, such as 50.0;
        /// Pressure of the air in Pa, for absorption and density; default 101325.
        air_pressure, such as 101325.0;
    }
}

/// The keys that describe the air; the fields of [`Medium`] are computed from these keys.
const AIR: [&str; 3] = ["temperature", "humidity", "air_pressure"];

impl Medium {
    /// Returns the sound speed in dry air (an ideal gas), c = 331.3 sqrt(1 + T/273.15) m/s with T in degrees Celsius.
    ///
    /// # Errors
    /// A temperature that is not finite or not above -273.15.
    pub fn sound_speed_at(temperature: f64) -> Result<f64> {
        real("medium.temperature", temperature, -273.15, true)?;
        Ok(331.3 * math::sqrt(1.0 + temperature / 273.15))
    }

    /// The temperature in degrees C at which air has this sound speed.
    pub fn temperature(&self) -> f64 {
        let ratio = self.sound_speed / 331.3;
        273.15 * (ratio * ratio - 1.0)
    }

    /// Viscosity eta in Pa s of air at [`Medium::temperature`], by W. Sutherland, Phil. Mag. 36, 507 (1893), with the constants
    /// of the US Standard Atmosphere 1976.
    ///
    /// ```
    /// assert!((1e5 * midair::Medium::default().viscosity() - 1.79).abs() < 0.01);
    /// ```
    pub fn viscosity(&self) -> f64 {
        let kelvin = 273.15 + self.temperature();
        1.458e-6 * kelvin * math::sqrt(kelvin) / (kelvin + 110.4)
    }

    /// Returns the medium with the given values of [`Medium::KEYS`]. If a temperature, a humidity or an air pressure is among
    /// them, [`Medium::air`] computes all numbers that are not given. A missing temperature follows from the sound speed.
    ///
    /// ```
    /// let warm = midair::Medium::default().with(&[("temperature", 25.0), ("density", 1.18)])?;
    /// assert_eq!(warm.density, 1.18);
    /// assert!((warm.sound_speed - 346.1).abs() < 0.1 && (warm.absorption - 0.160).abs() < 0.001);
    /// # Ok::<(), midair::Error>(())
    /// ```
    ///
    /// # Errors
    /// An unknown name; a temperature and a sound speed together; values that [`Medium::air`] rejects. A scene checks the other
    /// ranges.
    pub fn with(mut self, numbers: &[(&str, f64)]) -> Result<Self> {
        let of = |name: &str| numbers.iter().find(|(key, _)| *key == name).map(|&(_, value)| value);
        for &(name, value) in numbers {
            if !self.set(name, value) && !AIR.contains(&name) {
                return Err(Error::unknown("key of medium", name, Self::KEYS.iter().map(|key| key.name)));
            }
        }
        let air = AIR.map(of);
        if air.iter().all(Option::is_none) {
            return Ok(self);
        }
        if let (Some(temperature), Some(_)) = (air[0], of("sound_speed")) {
            let cure = "sound_speed is given too: keep one of them";
            return Err(Error::invalid("medium.temperature", temperature, cure));
        }
        let mut made = self.air_of(air)?;
        for (name, value) in self.numbers() {
            if of(name).is_some() || (name == "sound_speed" && air[0].is_none()) {
                made.set(name, value);
            }
        }
        Ok(made)
    }

    /// Radiation pressure in Pa on a rigid wall at normal incidence, |p|^2/(rho c^2) for a peak pressure |p| in Pa.
    ///
    /// ```
    /// let pascals = midair::Medium::default().radiation(5e3);
    /// assert!((pascals - 176.8).abs() < 0.1);
    /// ```
    pub fn radiation(&self, pressure: f64) -> f64 {
        pressure * pressure / (self.density * self.sound_speed * self.sound_speed)
    }

    /// Estimates the share of the second harmonic in a focus of |p| Pa; the linear model leaves this harmonic out. The share is
    /// 3 pi beta |p|/(2 rho c^2), with beta = 1.2 for air. It is half of beta omega |p| L/(2 rho c^3), the harmonic of a plane
    /// wave (Fubini) after a focal depth L of three wavelengths. The estimate holds for |p| below about 10 kPa.
    ///
    /// ```
    /// let air = midair::Medium::default();
    /// let shares = [2e3, 5e3, 10e3].map(|pressure| (100.0 * air.second_harmonic(pressure)).round());
    /// assert_eq!(shares, [8.0, 20.0, 40.0]);
    /// ```
    pub fn second_harmonic(&self, pressure: f64) -> f64 {
        const BETA: f64 = 1.2;
        1.5 * PI * BETA * self.radiation(1.0) * pressure
    }

    pub(crate) fn check(&self) -> Result<()> {
        self.in_range()?;
        let wavelength = self.wavelength();
        if !(1e-9..=1e9).contains(&wavelength) {
            return Err(Error::invalid(
                "medium.frequency",
                self.frequency,
                alloc::format!("the wavelength would be {wavelength:e} m: give Hz and m/s"),
            ));
        }
        Ok(())
    }
}

getters! {
    Medium:

    /// The wavelength c/f in m.
    pub wavelength(self) -> f64 = self.sound_speed / self.frequency;

    /// The wavenumber k = 2 pi f/c in 1/m.
    pub wavenumber(self) -> f64 = TAU / self.wavelength();

    /// The complex wavenumber k + j alpha in 1/m: a wave e^{j(k + j alpha)r}/r loses amplitude to absorption.
    pub(crate) complex_wavenumber(self) -> Complex64 = Complex64::new(self.wavenumber(), self.absorption);
}

/// The sound pressure level in dB of a peak pressure in Pa: 20 log10(|p| / sqrt(2) / 20 uPa).
///
/// ```
/// assert!((midair::spl(2e-5 * 2f64.sqrt()) - 0.0).abs() < 1e-12);
/// assert!((midair::spl(2000.0) - 157.0).abs() < 0.1);
/// ```
pub fn spl(pressure: f64) -> f64 {
    20.0 * math::log10(pressure.abs() / core::f64::consts::SQRT_2 / 20e-6)
}
