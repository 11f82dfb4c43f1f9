//! Reflection: walls that a wave meets one after another, as mirror images of the array and of surfaces.
//!
//! Let a wall contain the point c and have the unit normal n. It reflects the wave of a transducer at x with normal v like a
//! mirrored transducer at x' = x - 2 ((x - c).n) n with normal v' = v - 2 (v.n) n. The factor is 1 for a rigid wall (dp/dn = 0
//! on it) and -1 for a soft one (p = 0). So an element of the propagation matrix is G(x) + sum of +-G(x'). Here G(x) is the
//! wave of a transducer at x, with its directivity and absorption.
//!
//! With several walls, each also mirrors the images of the others. Two or three walls at right angles have 3 or 7 images and
//! are exact. Two walls that face each other have infinitely many; images of more than [`MOST_REFLECTIONS`] reflections are
//! left out.

use crate::prelude::*;
use crate::propagation::scattering::element::Element;
use crate::scene::wall::{Mirror, boards};
use crate::scene::{Array, Obstacles};

/// The most walls that a wave meets one after another. With three, a corner of three walls is exact.
const MOST_REFLECTIONS: usize = 3;

/// Images nearer than this, in m, are the same.
const SAME: f64 = 1e-9;

/// The mirrors that a wave meets one after another.
#[derive(Clone, Debug)]
pub(crate) struct Reflection(Vec<Mirror>);

impl Reflection {
    fn place(&self, place: Vec3) -> Vec3 {
        self.0.iter().fold(place, |place, mirror| mirror.place(place))
    }

    pub(crate) fn direction(&self, direction: Vec3) -> Vec3 {
        self.0.iter().fold(direction, |direction, mirror| mirror.direction(direction))
    }

    /// The factor of the reflected wave: -1 after an odd number of soft walls.
    pub(crate) fn factor(&self) -> f64 {
        self.0.iter().map(|mirror| mirror.factor).product()
    }

    /// The mirror image of an array.
    pub(crate) fn array(&self, array: &Array) -> Array {
        array.mirrored(|x| self.place(Vec3(x)).0, |v| self.direction(Vec3(v)).0, self.factor())
    }

    /// The mirror image of an element.
    pub(crate) fn element(&self, element: &Element) -> Element {
        element.moved(|place| self.place(place), |direction| self.direction(direction))
    }
}

/// Returns all reflections of up to [`MOST_REFLECTIONS`] walls, without those that give the same image. The
/// boards of an array that reflects are walls, too.
pub(crate) fn reflections(array: &Array, obstacles: &Obstacles) -> Vec<Reflection> {
    let mirrors: Vec<Mirror> = obstacles.mirrors().copied().chain(boards(array)).collect();
    // Two reflections are the same if they map four places alike.
    let [x, y, z] = array.centre();
    let probe = [[x, y, z], [x + 1.0, y, z], [x, y + 1.0, z], [x, y, z + 1.0]].map(Vec3);
    let mut seen = vec![probe];
    let mut all: Vec<Reflection> = Vec::new();
    let mut last = vec![(Reflection(Vec::new()), probe)];
    for _ in 0..MOST_REFLECTIONS {
        let mut next = Vec::new();
        for (before, corners) in &last {
            for mirror in &mirrors {
                let corners = corners.map(|corner| mirror.place(corner));
                let same = |other: &[Vec3; 4]| (0..4).all(|k| other[k].distance(corners[k]) < SAME);
                if seen.iter().any(same) {
                    continue;
                }
                seen.push(corners);
                let mirrors = before.0.iter().chain([mirror]).copied().collect();
                next.push((Reflection(mirrors), corners));
            }
        }
        all.extend(next.iter().map(|(reflection, _)| reflection.clone()));
        last = next;
    }
    all
}
