//! Particle: the Gor'kov potential of a small sphere in a pressure field, and other forces on the sphere.

use alloc::format;

use crate::math;
use crate::propagation::jet::Jet;
use crate::scene::{Medium, Particle};
use crate::vec3::Vec3;

/// The largest radius of a small sphere in wavelengths: k a = 0.79.
pub(crate) const LARGEST: f64 = 0.125;

impl Particle {
    /// Returns the factors of |p|^2 and of -|grad p|^2 in the potential U.
    #[must_use]
    pub fn factors(&self, medium: Medium) -> [f64; 2] {
        let speeds = medium.sound_speed / self.sound_speed;
        let ratio = self.density / medium.density;
        let compressibility = medium.density * medium.sound_speed * medium.sound_speed;
        let f1 = 1.0 - speeds * speeds / ratio;
        let f2 = 2.0 * (ratio - 1.0) / (2.0 * ratio + 1.0);
        let volume = self.volume();
        let omega = core::f64::consts::TAU * medium.frequency;
        [volume * f1 / (4.0 * compressibility), volume * 3.0 * f2 / (8.0 * medium.density * omega * omega)]
    }

    /// The derivative of the factor of |p|^2 by the medium's sound speed; the other factor does not depend on it.
    pub(crate) fn factor_slope(&self, medium: Medium) -> f64 {
        -self.volume() / (2.0 * medium.density * medium.sound_speed * medium.sound_speed * medium.sound_speed)
    }

    fn volume(&self) -> f64 {
        4.0 / 3.0 * core::f64::consts::PI * self.radius * self.radius * self.radius
    }

    /// The mass in kg that a force accelerates: the particle's own and half that of the displaced air, which moves with it.
    #[must_use]
    pub fn mass(&self, medium: Medium) -> f64 {
        (self.density + 0.5 * medium.density) * self.volume()
    }

    /// Returns the weight less buoyancy in N, for a `gravity` in m/s^2.
    #[must_use]
    pub fn weight(&self, medium: Medium, gravity: [f64; 3]) -> [f64; 3] {
        gravity.map(|g| (self.density - medium.density) * self.volume() * g)
    }

    /// Returns the drag in N of still air at a `speed` in m/s, by Schiller and Naumann (1933), for Reynolds numbers Re up to
    /// 800:
    ///
    /// ```text
    /// F = 6 pi eta a v (1 + 0.15 Re^0.687),   Re = 2 a rho v/eta
    /// ```
    #[must_use]
    pub fn drag(&self, medium: Medium, speed: f64) -> f64 {
        let viscosity = medium.viscosity();
        let reynolds = 2.0 * self.radius * medium.density * speed / viscosity;
        let stokes = 6.0 * core::f64::consts::PI * viscosity * self.radius * speed;
        stokes * (1.0 + 0.15 * math::pow(reynolds, 0.687))
    }

    /// Returns the force in N that a velocity in m/s and an acceleration in m/s^2 require, besides weight and buoyancy.
    #[must_use]
    pub fn needed(&self, medium: Medium, velocity: [f64; 3], acceleration: [f64; 3]) -> [f64; 3] {
        let (mass, speed) = (self.mass(medium), Vec3(velocity).norm());
        let drag = if speed > 0.0 { self.drag(medium, speed) / speed } else { 0.0 };
        (mass * Vec3(acceleration) + drag * Vec3(velocity)).0
    }

    /// Returns a remark if the radius exceeds an eighth of the wavelength, where the Gor'kov potential is inaccurate.
    #[must_use]
    pub fn remark(&self, medium: Medium) -> Option<alloc::string::String> {
        let most = LARGEST * medium.wavelength();
        (self.radius > most).then(|| {
            format!(
                "bead.radius is {} m: Gor'kov's potential is for spheres small beside the wavelength, up to {most:.2e} m",
                self.radius
            )
        })
    }
}

/// Returns the potential U for the real and the imaginary part of a pressure; the factors are those of [`Particle::factors`].
pub(crate) fn potential(pressure: &[Jet], [compression, motion]: [f64; 2]) -> Jet {
    let mut potential = Jet::ZERO;
    for part in pressure {
        potential.add(&part.times(part), compression);
        for slope in [0, 1, 2].map(|axis| part.derivative(axis)) {
            potential.add(&slope.times(&slope), -motion);
        }
    }
    potential
}

/// Returns the cotangents of the real and imaginary part of a pressure, for the cotangent of its potential U.
pub(crate) fn back(pressure: &[Jet; 2], [compression, motion]: [f64; 2], potential: &Jet) -> [Jet; 2] {
    pressure.each_ref().map(|part| {
        let mut back = Jet::ZERO;
        back.add(&potential.back_times(part), 2.0 * compression);
        for axis in 0..3 {
            back.add(&potential.back_times(&part.derivative(axis)).back_derivative(axis), -2.0 * motion);
        }
        back
    })
}
