//! Scattering: adds to G the waves of obstacles: image sources for walls, responses of spheres and meshes.

pub(crate) mod bodies;
pub(crate) mod boundary;
pub(crate) mod element;
mod inside;
pub(crate) mod reflection;
pub(crate) mod sphere;

use crate::prelude::*;
use crate::propagation::scattering::bodies::Bodies;
use crate::propagation::scattering::reflection::{Reflection, reflections};
use crate::propagation::scattering::sphere::Sphere;
use crate::propagation::sources::Sources;
use crate::scene::{Obstacle, Obstacles};

/// Obstacles, prepared for the transducers of given [`Sources`].
#[derive(Clone, Debug)]
pub(crate) struct Scattering {
    pub(crate) obstacles: Obstacles,
    /// The array as mirrored by the walls.
    pub(crate) images: Arc<[Sources]>,
    pub(crate) bodies: Option<Arc<Bodies>>,
}

impl Scattering {
    /// Prepares obstacles that have been checked with the array and medium of `sources`. The sound on meshes is not known yet.
    ///
    /// # Errors
    /// A stop by the caller.
    pub(crate) fn new(sources: &Sources, obstacles: Obstacles, control: &mut Control) -> Result<Self> {
        let sphere = obstacles.list().iter().find_map(|obstacle| match obstacle {
            Obstacle::Sphere { center, radius, kind } => {
                Some(Sphere::new(*center, *radius, *kind, sources.medium, sources.array.positions()))
            }
            _ => None,
        });
        let bodies = sphere.map(|sphere| Bodies::of_sphere(sphere, sources, control)).transpose()?.map(Arc::new);
        let reflections = reflections(&sources.array, &obstacles);
        let image = |reflection: &Reflection| Sources::new(&reflection.array(&sources.array), sources.medium);
        Ok(Self { images: reflections.iter().map(image).collect(), obstacles, bodies })
    }

    /// Returns the same obstacles with the responses of the bodies.
    pub(crate) fn with_bodies(self, bodies: Bodies) -> Self {
        Self { bodies: Some(Arc::new(bodies)), ..self }
    }

    /// Checks that the sound on all meshes is known.
    pub(crate) fn check(&self) -> Result<()> {
        if self.bodies.is_some() || self.obstacles.meshes().next().is_none() {
            return Ok(());
        }
        let cure = "solve its Boundary first and give the sound to Model::with_sound";
        Err(Error::invalid("obstacles", "a mesh whose surface is not solved", cure))
    }

    /// The middle of the spheres and meshes; `None` without any.
    pub(crate) fn centre(&self) -> Option<[f64; 3]> {
        let boxes = self.obstacles.list().iter().filter_map(Obstacle::bounds);
        let joined =
            |a: [[f64; 2]; 3], b: [[f64; 2]; 3]| [0, 1, 2].map(|k| [a[k][0].min(b[k][0]), a[k][1].max(b[k][1])]);
        boxes.reduce(joined).map(|all| all.map(|[low, high]| 0.5 * (low + high)))
    }

    /// Adds to the rows, one for each point, the waves of each transducer by way of spheres and meshes, in Pa. Their responses
    /// are stored in single precision.
    pub(crate) fn add(&self, sources: &Sources, points: &[[f64; 3]], rows: &mut [Vec<Complex64>]) {
        if let Some(bodies) = &self.bodies {
            for (row, [re, im]) in rows.iter_mut().zip(bodies.sent(points)) {
                for (i, (g, (re, im))) in row.iter_mut().zip(re.into_iter().zip(im)).enumerate() {
                    *g += sources.array.effect(i) * Complex64::new(f64::from(re), f64::from(im));
                }
            }
        }
    }

    /// How many times longer an entry of the propagation matrix G takes than without obstacles.
    pub(crate) fn cost(&self) -> usize {
        // A wave of a sphere or an element of a mesh takes about a hundredth of the time of a transducer's wave.
        1 + self.images.len() + self.bodies.as_ref().map_or(0, |bodies| bodies.len() / 100)
    }
}

#[cfg(test)]
#[path = "tests/scattering.rs"]
mod tests;
