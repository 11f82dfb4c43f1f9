//! Medium: frequency, sound speed, absorption and density of the air.

use num_complex::Complex64;

use crate::error::{Error, real};
use crate::math;
use crate::scene::key::numbers;

numbers! {
    /// A homogeneous medium and the frequency used in it. Left out, its numbers are those of the paper: a wavelength of 8.5 mm.
    pub struct Medium of "medium" {
        /// Frequency f in Hz; left out 40e3.
        frequency = 40e3, above 0.0, such as 40e3;
        /// Sound speed c in m/s; left out 340. Or temperature.
        sound_speed = 340.0, above 0.0, such as 340.0;
        /// Absorption alpha of the amplitude in Np/m; left out 0. Air at 40 kHz has 0.15, 1.3 dB/m.
        absorption = 0.0, least 0.0, such as 0.15;
        /// Density rho in kg/m^3; left out 1.18.
        density = 1.18, above 0.0, such as 1.2;
    }
    or by {
        /// In degrees C, in place of sound_speed: c = 331.3 sqrt(1 + T/273.15) m/s.
        temperature, such as 25.0;
    }
}

impl Medium {
    /// c = 331.3 sqrt(1 + T/273.15) m/s, T in degrees Celsius (ideal gas, dry air).
    ///
    /// # Errors
    /// A temperature that is not finite or not above -273.15.
    pub fn sound_speed_at(temperature: f64) -> Result<f64, Error> {
        real("medium.temperature", temperature, -273.15, true)?;
        Ok(331.3 * math::sqrt(1.0 + temperature / 273.15))
    }

    /// The temperature in degrees C at which air has this sound speed.
    #[must_use]
    pub fn temperature(&self) -> f64 {
        let ratio = self.sound_speed / 331.3;
        273.15 * (ratio * ratio - 1.0)
    }

    /// The medium with some of [`Medium::KEYS`] changed.
    ///
    /// ```
    /// let warm = midair::Medium::default().with(&[("temperature", 25.0), ("density", 1.184)])?;
    /// assert!((warm.sound_speed - 346.1).abs() < 0.1);
    /// # Ok::<(), midair::Error>(())
    /// ```
    ///
    /// # Errors
    /// An unknown name; a temperature beside a sound speed, or not above -273.15. Other ranges are checked by a scene.
    pub fn with(mut self, given: &[(&str, f64)]) -> Result<Self, Error> {
        let of = |name: &str| given.iter().find(|(key, _)| *key == name).map(|&(_, value)| value);
        if let Some(temperature) = of("temperature") {
            if of("sound_speed").is_some() {
                let cure = "sound_speed is given too: keep one of them";
                return Err(Error::invalid("medium.temperature", temperature, cure));
            }
            self.sound_speed = Self::sound_speed_at(temperature)?;
        }
        for &(name, value) in given {
            if !self.set(name, value) && name != "temperature" {
                return Err(Error::unknown("key of medium", name, Self::KEYS.iter().map(|key| key.name)));
            }
        }
        Ok(self)
    }

    /// c/f in m.
    #[must_use]
    pub fn wavelength(&self) -> f64 {
        self.sound_speed / self.frequency
    }

    /// k = 2 pi f/c in 1/m.
    #[must_use]
    pub fn wavenumber(&self) -> f64 {
        core::f64::consts::TAU / self.wavelength()
    }

    /// k + j alpha in 1/m: of a wave e^{jkr}/r that the air absorbs.
    pub(crate) fn complex_wavenumber(&self) -> Complex64 {
        Complex64::new(self.wavenumber(), self.absorption)
    }

    /// Radiation pressure in Pa on a rigid wall at normal incidence, |p|^2/(rho c^2) for a peak pressure |p| in Pa.
    ///
    /// ```
    /// let pascals = midair::Medium::default().radiation(5e3);
    /// assert!((pascals - 183.3).abs() < 0.1);
    /// ```
    #[must_use]
    pub fn radiation(&self, pressure: f64) -> f64 {
        pressure * pressure / (self.density * self.sound_speed * self.sound_speed)
    }

    /// The estimated share of the second harmonic in a focus of |p| Pa, for the part that the linear model leaves out:
    /// beta omega |p| L/(4 rho c^3), half the growth of a plane wave's harmonic (Fubini) over a focal depth L of three
    /// wavelengths; that is 3 pi beta |p|/(2 rho c^2), with beta = 1.2 of air. An estimate for |p| below some 10 kPa.
    ///
    /// ```
    /// let air = midair::Medium::default();
    /// let shares = [2e3, 5e3, 10e3].map(|pressure| (100.0 * air.second_harmonic(pressure)).round());
    /// assert_eq!(shares, [8.0, 21.0, 41.0]);
    /// ```
    #[must_use]
    pub fn second_harmonic(&self, pressure: f64) -> f64 {
        const BETA: f64 = 1.2;
        1.5 * core::f64::consts::PI * BETA * self.radiation(1.0) * pressure
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
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

/// The sound pressure level in dB of a peak pressure in Pa: 20 log10(|p| / sqrt(2) / 20 uPa).
///
/// ```
/// assert!((midair::spl(2e-5 * 2f64.sqrt()) - 0.0).abs() < 1e-12);
/// assert!((midair::spl(2000.0) - 157.0).abs() < 0.1);
/// ```
#[must_use]
pub fn spl(pressure: f64) -> f64 {
    20.0 * math::log10(pressure.abs() / core::f64::consts::SQRT_2 / 20e-6)
}
