//! Momentum: the force of sound on a sphere of any size, from the spherical waves at its surface.
//!
//! Around the sphere, the sound of the drive is a sum of regular waves a_k j_n(kr) Y_k. The sphere scatters outgoing waves s_n
//! a_k h_n(kr) Y_k. Far away, half of each regular wave goes outwards. The force is the momentum that flows in less the
//! momentum that flows out. The regular waves alone carry as much momentum in as out, so
//!
//! ```text
//! F = -1/(2 rho c^2) int n Re(S conj(S + 2 f)) dn,   S = sum_k (-j)^(n+1) s_n a_k Y_k/k,   f = sum_k (-j)^(n+1) a_k Y_k/(2k)
//! s_n = -(k j_n' - g_n j_n)/(k h_n' - g_n h_n) at ka,   g_n = rho/rho_p k_p j_n'(k_p a)/j_n(k_p a)
//! ```
//!
//! Here a is the radius, n the direction, and k in Y_k/k the wavenumber. The sphere is a fluid of density rho_p and sound speed
//! c_p = omega/k_p (V. C. Anderson, J. Acoust. Soc. Am. 22, 426, 1950). For a large c_p it is rigid, and moves with the sound
//! as far as its mass allows: g_1 = rho/(rho_p a), g_0 = 0. The air has no viscosity and, around the sphere, no absorption.

use crate::prelude::*;
use crate::propagation::jet::Jet;
use crate::propagation::scattering::sphere::{Rules, Sphere};
use crate::scene::{Medium, Particle, Surface, dot};

/// A sphere in air, on which sound exerts a force.
pub(crate) struct Pushed {
    radius: f64,
    medium: Medium,
    rules: Rules,
    /// For each order n: j_n(ka), j_n'(ka), and the factors of the slope and of the pressure at the surface in s_n a_k.
    orders: Vec<[Complex64; 4]>,
}

impl Pushed {
    /// Returns a sphere with the size and density of a particle.
    pub(crate) fn new(particle: Particle, medium: Medium) -> Self {
        let medium = Medium { absorption: 0.0, ..medium };
        let size = medium.wavenumber() * particle.radius;
        // Waves of higher orders are below 1e-8 (W. J. Wiscombe, Applied Optics 19, 1505, 1980).
        let order = math::ceil(size + 4.05 * math::cbrt(size) + 4.0) as usize;
        let (sphere, orders) = orders(particle, medium, order);
        Self { radius: particle.radius, medium, orders, rules: Rules::new(&sphere) }
    }

    /// Returns the force in N on the sphere around `center`. `pressure` returns the real and imaginary part at a place.
    ///
    /// # Errors
    /// The errors of `pressure`, a stop by the caller.
    pub(crate) fn force(
        &self,
        center: [f64; 3],
        pressure: impl Fn([f64; 3]) -> Result<[Jet; 2]>,
        control: &mut Control,
    ) -> Result<[f64; 3]> {
        let met = |way: [f64; 3]| {
            let [re, im] = pressure((Vec3(center) + self.radius * Vec3(way)).0)?;
            let slope = Complex64::new(dot(re.gradient(), way), dot(im.gradient(), way));
            Ok([Complex64::new(re.value(), im.value()), slope])
        };
        let [mut sent, mut both] = self.rules.waves(met, control)?;
        let wavenumber = self.medium.wavenumber();
        let mut turn = -Complex64::I / wavenumber;
        for (n, [j, slope, by_slope, by_pressure]) in self.orders.iter().enumerate() {
            for k in n * n..(n + 1) * (n + 1) {
                let (p, rise) = (sent[k], both[k]);
                // a_k follows from p = a_k j_n and its slope = a_k k j_n'. A weighted mean of both is used, because one of them
                // can be 0.
                let coefficient = (p * j + rise * slope / wavenumber) / (j * j + slope * slope);
                let answer = rise * by_slope + p * by_pressure;
                sent[k] = answer * turn;
                both[k] = (answer + coefficient) * turn;
            }
            turn *= -Complex64::I;
        }
        let sum = self.rules.turned(&sent, &both);
        let push = -0.5 / (self.medium.density * self.medium.sound_speed * self.medium.sound_speed);
        Ok(sum.map(|x| push * x))
    }
}

/// Returns s_n of the module's head for the orders 0 to `order`.
pub(crate) fn scattered(particle: Particle, medium: Medium, order: usize) -> Vec<Complex64> {
    let medium = Medium { absorption: 0.0, ..medium };
    let (k, (_, orders)) = (medium.wavenumber(), orders(particle, medium, order));
    orders.iter().map(|[j, slope, by_slope, by_pressure]| by_slope * slope * k + by_pressure * j).collect()
}

/// Largest size k a inside of a sphere from which the continued fraction begins. A larger sphere has no use, but its terms
/// would need gigabytes.
const MOST_SIZE: f64 = 1e5;

/// Returns a sphere in a medium without absorption, and [`Pushed::orders`] from 0 to `order`.
fn orders(particle: Particle, medium: Medium, order: usize) -> (Sphere, Vec<[Complex64; 4]>) {
    let sphere = Sphere::of_order([0.0; 3], particle.radius, Surface::Rigid, medium, order);
    let inside = medium.wavenumber() * medium.sound_speed / particle.sound_speed;
    let size = inside * particle.radius;
    // j_(n+1)/j_n by a continued fraction, from an order at which it is 0.
    let mut ratio = 0.0;
    let mut gains: Vec<f64> = (0..order + size.min(MOST_SIZE) as usize + 20)
        .rev()
        .map(|n| {
            ratio = 1.0 / ((2 * n + 3) as f64 / size - ratio);
            medium.density / particle.density * inside * (n as f64 / size - ratio)
        })
        .collect();
    gains.reverse();
    let each = (0..=order).map(|n| {
        let [h, slope] = sphere.outgoing(n);
        let under = slope * medium.wavenumber() - h * gains[n];
        [h.re.into(), slope.re.into(), -under.inv(), gains[n] * under.inv()]
    });
    let orders = each.collect();
    (sphere, orders)
}

#[cfg(test)]
#[path = "tests/momentum.rs"]
pub(crate) mod tests;
