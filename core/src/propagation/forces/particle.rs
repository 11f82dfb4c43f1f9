//! Particle: mass, weight and drag of a sphere.

use crate::prelude::*;
use crate::scene::{Medium, Particle};

/// The largest radius of a small sphere in wavelengths: k a = 0.79. Its force is that of [`crate::propagation::forces::response`].
pub(crate) const LARGEST: f64 = 0.125;

impl Particle {
    pub(crate) fn volume(&self) -> f64 {
        4.0 / 3.0 * core::f64::consts::PI * self.radius * self.radius * self.radius
    }

    /// The mass in kg that a force accelerates: the particle's own and half that of the displaced air, which moves with it.
    pub fn mass(&self, medium: Medium) -> f64 {
        (self.density + 0.5 * medium.density) * self.volume()
    }

    /// Returns the weight less buoyancy in N, for a `gravity` in m/s^2.
    pub fn weight(&self, medium: Medium, gravity: [f64; 3]) -> [f64; 3] {
        gravity.map(|g| (self.density - medium.density) * self.volume() * g)
    }

    /// Stokes' friction over speed in N s/m, 6 pi eta a.
    pub(crate) fn friction(&self, medium: Medium) -> f64 {
        6.0 * core::f64::consts::PI * medium.viscosity() * self.radius
    }

    /// The factor 6 a^2 sqrt(pi rho eta) of the integral of u'(s)/sqrt(t - s) in Basset's history force, in SI units.
    pub(crate) fn history(&self, medium: Medium) -> f64 {
        6.0 * self.radius * self.radius * math::sqrt(core::f64::consts::PI * medium.density * medium.viscosity())
    }

    /// Returns the drag in N of still air at a constant `speed` in m/s, by Schiller and Naumann (1933), for Reynolds numbers
    /// Re up to 800:
    ///
    /// ```text
    /// F = 6 pi eta a v (1 + 0.15 Re^0.687),   Re = 2 a rho v/eta
    /// ```
    pub fn drag(&self, medium: Medium, speed: f64) -> f64 {
        let reynolds = 2.0 * self.radius * medium.density * speed / medium.viscosity();
        self.friction(medium) * speed * (1.0 + 0.15 * math::pow(reynolds, 0.687))
    }

    /// Returns the force in N that a velocity in m/s and an acceleration in m/s^2 require, besides weight and buoyancy.
    pub fn needed(&self, medium: Medium, velocity: [f64; 3], acceleration: [f64; 3]) -> [f64; 3] {
        let (mass, speed) = (self.mass(medium), Vec3(velocity).norm());
        let drag = if speed > 0.0 { self.drag(medium, speed) / speed } else { 0.0 };
        (mass * Vec3(acceleration) + drag * Vec3(velocity)).0
    }

    /// Returns a remark if the radius exceeds an eighth of the wavelength, where waves above the quadrupole matter.
    pub fn remark(&self, medium: Medium) -> Option<alloc::string::String> {
        let most = LARGEST * medium.wavelength();
        (self.radius > most).then(|| {
            format!(
                "bead.radius is {} m: the force has waves up to the quadrupole, for spheres up to {most:.2e} m",
                self.radius
            )
        })
    }
}
