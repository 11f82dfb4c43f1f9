//! Reflection: walls that a wave meets one after another, as images of the array and of surfaces.
//!
//! A wall through c with unit normal n sends back what a mirrored transducer would send: from x' = x - 2 ((x - c).n) n,
//! looking along n' = v - 2 (v.n) n, times 1 (rigid: dp/dn = 0 on the wall) or -1 (soft: p = 0). So G = G(x) + sum of
//! +-G(x'), every term eq. (5) itself, with its directivity and absorption.
//!
//! Of several walls each mirrors the others' images, too. Two or three at right angles have 3 or 7 images and are exact;
//! two that face each other have infinitely many, and those of more than [`MOST_REFLECTIONS`] reflections are left out.

use alloc::vec;
use alloc::vec::Vec;

use crate::propagation::element::Element;
use crate::scene::wall::Mirror;
use crate::scene::{Array, Obstacles, Surface, distance};

/// Walls that a wave has met one after another. Three make a corner exact.
const MOST_REFLECTIONS: usize = 3;

/// Metres within which two images are the same.
const SAME: f64 = 1e-9;

/// Mirrors that a wave meets one after another.
#[derive(Clone, Debug)]
pub(crate) struct Reflection(Vec<Mirror>);

impl Reflection {
    fn place(&self, place: [f64; 3]) -> [f64; 3] {
        self.0.iter().fold(place, |place, mirror| mirror.place(place))
    }

    pub(crate) fn direction(&self, direction: [f64; 3]) -> [f64; 3] {
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
    // Four places determine a transformation.
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
