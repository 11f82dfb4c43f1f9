//! Scattering: what obstacles add to eq. (5), by image sources of walls and the answers of bodies.
//!
//! A wall through c with unit normal n sends back what a mirrored transducer would send: from x' = x - 2 ((x - c).n) n,
//! looking along n' = v - 2 (v.n) n, times 1 (rigid: dp/dn = 0 on the wall) or -1 (soft: p = 0). So G = G(x) + sum of
//! +-G(x'), every term eq. (5) itself, with its directivity and absorption.
//!
//! Of several walls each mirrors the others' images, too. Two or three at right angles have 3 or 7 images and are exact;
//! two that face each other have them without end, and those of more than [`MOST_REFLECTIONS`] are left out.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

use num_complex::Complex64;

use crate::error::Error;
use crate::propagation::bodies::Bodies;
use crate::propagation::element::Element;
use crate::propagation::sources::Sources;
use crate::propagation::sphere::Sphere;
use crate::scene::wall::Mirror;
use crate::scene::{Array, Obstacle, Obstacles, Surface, distance};

/// Walls that a wave has met one after another. Three make a corner exact.
const MOST_REFLECTIONS: usize = 3;

/// Metres within which two images are the same.
const SAME: f64 = 1e-9;

/// Obstacles prepared for the transducers of some [`Sources`].
#[derive(Clone, Debug)]
pub(crate) struct Scattering {
    pub(crate) obstacles: Obstacles,
    /// The array as its mirrors show it.
    pub(crate) images: Arc<[Sources]>,
    pub(crate) bodies: Option<Arc<Bodies>>,
}

impl Scattering {
    /// Obstacles that have been checked with the sources' array and medium; the sound on meshes is still to be found.
    pub(crate) fn new(sources: &Sources, obstacles: Obstacles) -> Self {
        let bodies = obstacles.given().iter().find_map(|obstacle| match obstacle {
            Obstacle::Sphere { center, radius, kind } => {
                let sphere = Sphere::new((*center, *radius, *kind), sources.medium, sources.array.positions());
                Some(Arc::new(Bodies::of_sphere(sphere, sources)))
            }
            _ => None,
        });
        let reflections = reflections(sources.array.centre(), &obstacles);
        let image = |reflection: &Reflection| Sources::new(&reflection.array(&sources.array), sources.medium);
        Self { images: reflections.iter().map(image).collect(), obstacles, bodies }
    }

    /// The same with the bodies' answers.
    pub(crate) fn with_bodies(self, bodies: Bodies) -> Self {
        Self { bodies: Some(Arc::new(bodies)), ..self }
    }

    /// Refuses meshes whose sound has not been found.
    pub(crate) fn check(&self) -> Result<(), Error> {
        if self.bodies.is_some() || self.obstacles.meshes().next().is_none() {
            return Ok(());
        }
        let cure = "solve its Boundary first and give the sound to Model::with_sound";
        Err(Error::invalid("obstacles", "a mesh whose surface is not solved", cure))
    }

    /// Adds what each transducer of some sources sends to a point by way of the obstacles, in Pa, in double precision.
    pub(crate) fn add(&self, sources: &Sources, point: [f64; 3], row: &mut [Complex64]) {
        for image in &*self.images {
            row.iter_mut().enumerate().for_each(|(i, g)| *g += image.exact(i, point));
        }
        if let Some(bodies) = &self.bodies {
            let sent = bodies.sent(point);
            row.iter_mut().enumerate().for_each(|(i, g)| *g += sources.array.effect(i) * sent[i]);
        }
    }

    /// How much longer an entry of G takes behind them than without.
    pub(crate) fn cost(&self) -> usize {
        // A wave or an element takes a hundredth of the time of eq. (5).
        1 + self.images.len() + self.bodies.as_ref().map_or(0, |bodies| bodies.len() / 100)
    }
}

/// Mirrors that a wave meets one after another.
#[derive(Clone, Debug)]
pub(crate) struct Reflection(Vec<Mirror>);

impl Reflection {
    fn place(&self, place: [f64; 3]) -> [f64; 3] {
        self.0.iter().fold(place, |place, mirror| mirror.place(place))
    }

    fn direction(&self, direction: [f64; 3]) -> [f64; 3] {
        self.0.iter().fold(direction, |direction, mirror| mirror.direction(direction))
    }

    /// -1 after an odd number of soft walls.
    pub(crate) fn sign(&self) -> f64 {
        let soft = self.0.iter().filter(|mirror| mirror.kind == Surface::Soft).count();
        if soft % 2 == 1 { -1.0 } else { 1.0 }
    }

    /// The array as the mirrors show it.
    pub(crate) fn array(&self, array: &Array) -> Array {
        array.moved(|place| self.place(place), |direction| self.direction(direction), self.sign() < 0.0)
    }

    /// An element as the mirrors show it.
    pub(crate) fn element(&self, element: &Element) -> Element {
        element.moved(|place| self.place(place), |direction| self.direction(direction))
    }
}

/// Each mirror, and the mirrors' images in one another, as seen about a place.
pub(crate) fn reflections(centre: [f64; 3], obstacles: &Obstacles) -> Vec<Reflection> {
    // A transformation is told by what it makes of four places.
    let [x, y, z] = centre;
    let probe = [[x, y, z], [x + 1.0, y, z], [x, y + 1.0, z], [x, y, z + 1.0]];
    let mut seen = vec![probe];
    let mut found: Vec<Reflection> = Vec::new();
    let mut last = vec![(Reflection(Vec::new()), probe)];
    for _ in 0..MOST_REFLECTIONS {
        let mut next = Vec::new();
        for (before, corners) in &last {
            for mirror in obstacles.mirrors() {
                let corners = corners.map(|corner| mirror.place(corner));
                let same = |other: &[[f64; 3]; 4]| (0..4).all(|k| distance(other[k], corners[k]) < SAME);
                if seen.iter().any(same) {
                    continue;
                }
                seen.push(corners);
                let mirrors = before.0.iter().chain([mirror]).copied().collect();
                next.push((Reflection(mirrors), corners));
            }
        }
        found.extend(next.iter().map(|(reflection, _)| reflection.clone()));
        last = next;
    }
    found
}

#[cfg(test)]
#[path = "tests/scattering.rs"]
mod tests;
