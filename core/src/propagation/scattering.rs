//! Scattering: what obstacles add to eq. (5), by image sources.
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

use crate::propagation::sources::Sources;
use crate::scene::{Array, Obstacles, Surface, distance};

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
}

impl Scattering {
    /// Obstacles that have been checked with the sources' array and medium.
    pub(crate) fn new(sources: &Sources, obstacles: Obstacles) -> Self {
        let images = images(&sources.array, &obstacles);
        let images = images.iter().map(|image| Sources::new(image, sources.medium)).collect();
        Self { obstacles, images }
    }

    /// What transducer i sends to a point by way of the obstacles, in Pa, in double precision.
    pub(crate) fn exact(&self, i: usize, point: [f64; 3]) -> Complex64 {
        self.images.iter().map(|image| image.exact(i, point)).sum()
    }
}

/// The array in each mirror, and the mirrors' images in one another.
fn images(array: &Array, obstacles: &Obstacles) -> Vec<Array> {
    // A transformation is told by what it makes of four places.
    let probe = |array: &Array| {
        let [x, y, z] = array.centre();
        [[x, y, z], [x + 1.0, y, z], [x, y + 1.0, z], [x, y, z + 1.0]]
    };
    let mut seen = vec![probe(array)];
    let mut found: Vec<Array> = Vec::new();
    let mut last = vec![(array.clone(), probe(array))];
    for _ in 0..MOST_REFLECTIONS {
        let mut next = Vec::new();
        for (image, corners) in &last {
            for mirror in obstacles.mirrors() {
                let corners = corners.map(|corner| mirror.place(corner));
                let same = |other: &[[f64; 3]; 4]| (0..4).all(|k| distance(other[k], corners[k]) < SAME);
                if seen.iter().any(same) {
                    continue;
                }
                seen.push(corners);
                let places = |place| mirror.place(place);
                let directions = |direction| mirror.direction(direction);
                next.push((image.moved(places, directions, mirror.kind == Surface::Soft), corners));
            }
        }
        found.extend(next.iter().map(|(image, _)| image.clone()));
        last = next;
    }
    found
}

#[cfg(test)]
#[path = "tests/scattering.rs"]
mod tests;
