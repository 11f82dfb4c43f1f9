//! Bead: the sphere that traps are made for, and its gravity.

use crate::prelude::*;
use crate::scene::geometry::vector;
use crate::scene::key::{Key, numbers};

numbers! {
    /// A sphere that should be trapped.
    ///
    /// The default is a bead of expanded polystyrene, 2 mm across and 29 kg/m^3: the density of the beads of A. Marzo et al.,
    /// "Holographic acoustic elements for manipulation of levitated objects", Nature Communications 6, 8661 (2015). Its sound
    /// speed, 900 m/s, hardly matters: with 1052 m/s, as other authors have, a standing wave traps it 0.1 % more strongly.
    pub struct Particle of "bead" {
        /// Radius a in m; default 1e-3.
        radius = 1e-3, above 0.0, such as 1e-3;
        /// Density in kg/m^3; default 29, that of expanded polystyrene.
        density = 29.0, above 0.0, such as 29.0;
        /// Sound speed in the sphere's material in m/s; default 900.
        sound_speed = 900.0, above 0.0, such as 900.0;
    }
    or by {}
}

/// A sphere and the gravity that acts on it.
///
/// ```
/// use midair::{Bead, Particle};
///
/// let heavy = Bead { particle: Particle { density: 100.0, ..Particle::default() }, ..Bead::default() };
/// assert_eq!(heavy.gravity, [0.0, 0.0, -9.81]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bead {
    /// The sphere.
    pub particle: Particle,
    /// Gravity in m/s^2.
    pub gravity: [f64; 3],
}

impl Default for Bead {
    fn default() -> Self {
        Self { particle: Particle::default(), gravity: [0.0, 0.0, -9.81] }
    }
}

impl Bead {
    /// Every key of the table `bead` in a scene file.
    pub const KEYS: &[Key] = &[
        Particle::KEYS[0],
        Particle::KEYS[1],
        Particle::KEYS[2],
        Key::new(
            "gravity",
            "[0.0, 0.0, -9.81]",
            "Gravity along x, y and z in m/s^2; default 9.81 in the direction -z.",
        ),
    ];

    /// Returns a copy of this bead with some of its numbers replaced, by name, and with another gravity if one is given.
    ///
    /// # Errors
    /// A number that is not above 0, a gravity that is not finite.
    pub fn with(mut self, numbers: &[(&str, f64)], gravity: Option<[f64; 3]>) -> Result<Self> {
        for &(name, value) in numbers {
            if !self.particle.set(name, value) {
                return Err(Error::unknown("key of bead", name, Self::KEYS.iter().map(|key| key.name)));
            }
        }
        self.gravity = gravity.unwrap_or(self.gravity);
        self.check()?;
        Ok(self)
    }

    pub(crate) fn check(&self) -> Result<()> {
        self.particle.in_range()?;
        vector("bead.gravity", &self.gravity)
    }
}
