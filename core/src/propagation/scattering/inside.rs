//! Inside: finds meshes that cannot be solved, by their geometry and by the sound that a solution leaves inside.
//!
//! A place inside one body has the winding number 1, because the solid angles of all its triangles add up to 4 pi.
//! The number is 2 where two bodies overlap, and 0 outside. It is computed slightly below the middle of each element.
//! If a plate is too thin for its elements, that place is already outside of the plate.

use crate::prelude::*;
use crate::propagation::scattering::boundary::Boundary;
use crate::propagation::scattering::element::Element;
use crate::scene::Mesh;
use crate::scene::mesh::Triangle;

/// The depth below an element at which the body must still be, as a part of the element's reach. It comes from trials with
/// rigid plates of different thickness. The sound in their shadow is within 2 % from a thickness of 0.18 of the reach on. It is
/// wrong by 12 % at 0.06, and at 0.03 the plate is transparent.
const DEPTH: f64 = 0.12;

/// The most elements that are tested for sound inside.
const LOOKS: usize = 64;

impl Boundary {
    /// Checks that bodies do not coincide, cross or contain each other, and that plates are thick enough for their elements.
    pub(crate) fn enclosed(&self, control: &mut Control) -> Result<()> {
        let parts = self.elements.iter().collect();
        control.each(parts, &|element: &Element, control| {
            let place = (element.center() - DEPTH * element.reach() * element.normal).0;
            let winding: f64 = self.obstacles.meshes().map(|mesh| mesh.winding(place)).sum();
            let [x, y, z] = element.center().0;
            let at = format!("near ({x:.4}, {y:.4}, {z:.4}) m");
            if winding > 1.5 {
                let value = format!("bodies that cross, contain each other or are there twice {at}");
                return Err(Error::invalid("obstacles", value, "join them to one surface, a union of the modeller's"));
            }
            if winding < 0.5 {
                let least = 1e3 * DEPTH * element.reach();
                let value = format!("a body thinner than {least:.2} mm, or one that crosses itself, {at}");
                let cure = "make it thicker, give finer faces, or mend the surface";
                return Err(Error::invalid("obstacles", value, cure));
            }
            control.pulse()
        })
    }

    /// Returns how much sound a solution (E, N) leaves inside the bodies, relative to the incident sound there. It is 0 for an
    /// exact solution and 1 for transparent bodies. It is the root mean square over transducers and places halfway through the
    /// bodies.
    ///
    /// # Errors
    /// Sound of another boundary; a stop by the caller.
    pub fn left_inside(&self, sound: &[Complex32], control: &mut Control) -> Result<f64> {
        self.check_sound(sound)?;
        let triangles: Vec<Triangle> = self.obstacles.meshes().flat_map(Mesh::triangles).collect();
        let transducers = self.transducers();
        let (mut left, mut came) = (0.0, 0.0);
        let mut row = Vec::new();
        for element in self.elements.iter().step_by(self.elements.len().div_ceil(LOOKS)) {
            let (from, way) = (element.center(), -element.normal);
            let far = triangles.iter().filter_map(|&triangle| hit(from, way, triangle)).fold(f64::INFINITY, f64::min);
            if !far.is_finite() {
                continue;
            }
            let place = (from - 0.5 * far * element.normal).0;
            self.row(place, &mut row);
            for i in 0..transducers {
                let sent: Complex64 = self.sources.iter().map(|sources| sources.exact(i, place)).sum();
                let received = row.iter().enumerate().map(|(e, received)| {
                    let u = sound[e * transducers + i];
                    received * Complex64::new(f64::from(u.re), f64::from(u.im))
                });
                left += (sent + received.sum::<Complex64>()).norm_sqr();
                came += sent.norm_sqr();
            }
            control.pulse()?;
        }
        Ok(if came > 0.0 { math::sqrt(left / came) } else { 0.0 })
    }
}

/// Returns the distance along a ray to a triangle, or `None` if the ray does not meet it or begins on it (T. Moeller and B.
/// Trumbore, J. Graph. Tools 2, 21, 1997). The unit is the length of `way`.
fn hit(from: Vec3, way: Vec3, [a, b, c]: Triangle) -> Option<f64> {
    let (ab, ac, start) = (b - a, c - a, from - a);
    let across = way.cross(ac);
    let scale = ab.dot(across);
    let (u, turned) = (start.dot(across) / scale, start.cross(ab));
    let (v, far) = (way.dot(turned) / scale, ac.dot(turned) / scale);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && far > 1e-6 * ab.norm()).then_some(far)
}

#[cfg(test)]
#[path = "tests/inside.rs"]
mod tests;
