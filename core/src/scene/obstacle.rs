//! Obstacles: bodies that reflect or scatter waves, checked once against the array.

use crate::prelude::*;
use crate::scene::body::obstacles;
use crate::scene::geometry::{distance, vector};
use crate::scene::mesh::{Mesh, area_vector};
use crate::scene::surface::ON;
use crate::scene::wall::{Mirror, boards, compatible, mirror};
use crate::scene::{Array, Key, Medium, Surface};

/// The most walls of a scene: a box has six sides.
const MOST_WALLS: usize = 6;

/// The largest radius of a sphere in wavelengths, 102 mm at 40 kHz, about a head. Its scattered wave then has 13,000 terms for
/// each transducer.
const LARGEST_SPHERE: f64 = 12.0;

/// The most boundary elements of all meshes of a scene: their matrix then takes 7 GB.
const MOST_ELEMENTS: f64 = 30_000.0;

/// The least distance between a body and a transducer, in wavelengths. A transducer is computed as a point source.
/// This is wrong for the waves that a nearer body reflects.
const CLEAR: f64 = 0.25;

/// The numbers of each parameter of a body, and its boundary condition.
pub(crate) type Described = (Vec<Vec<f64>>, Surface);

/// A kind of obstacle that a few numbers describe.
#[derive(Debug)]
#[non_exhaustive]
pub struct Body {
    /// The name of the kind in messages.
    pub noun: &'static str,
    /// The parameters, each with its count of numbers.
    pub parts: &'static [(Key, usize)],
    /// Makes the obstacle from the numbers of each parameter and its boundary condition. The caller gives the right counts.
    pub make: fn(&[Vec<f64>], Surface) -> Obstacle,
    /// Returns the numbers of each parameter and the boundary condition; `None` for an obstacle of another kind.
    pub read: fn(&Obstacle) -> Option<Described>,
}

obstacles! {
    /// A body that waves cannot enter.
    #[derive(Clone, Debug, PartialEq)]
    #[non_exhaustive]
    pub enum Obstacle {
        /// An infinite plane. Sound is on the array's side of it; if the array lies in the plane, on the side of the normal.
        Wall = "wall" {
            /// any point x, y, z on it, in m.
            point: [f64; 3], such as "[0.1, 0.0, 0.0]";
            /// its normal, of any length. Its sign matters only if the array lies in the wall: it then points to the side
            /// with the sound.
            normal: [f64; 3], such as "[-1.0, 0.0, 0.0]";
        }
        /// A sphere, the only obstacle of its scene.
        Sphere = "sphere" {
            /// its center x, y, z in m.
            center: [f64; 3], such as "[0.0, 0.0, 0.1]";
            /// its radius in m, at most 12 wavelengths.
            radius: f64, such as "0.02";
        }
        ---
        /// A body of any shape. Its field can be computed once the sound on its surface is known: see [`crate::Boundary`].
        Mesh(Arc<Mesh>) = "mesh",
    }
}

impl Obstacle {
    /// The lowest and highest coordinate of a body along each axis; `None` for a wall.
    pub(crate) fn bounds(&self) -> Option<[[f64; 2]; 3]> {
        match self {
            Self::Sphere { center, radius, .. } => Some(center.map(|x| [x - radius, x + radius])),
            Self::Mesh(mesh) => Some(mesh.bounds()),
            _ => None,
        }
    }
}

/// The checked obstacles of a scene. No transducer is inside an obstacle or behind a wall.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Obstacles {
    list: Arc<[Obstacle]>,
    /// The walls: the index of each in `list`, and its mirror.
    walls: Arc<[(usize, Mirror)]>,
}

impl Obstacles {
    /// Checks obstacles against an array and a medium.
    ///
    /// # Errors
    /// Numbers that are not finite, a normal of length 0, an obstacle that crosses the array or is too far away for phases in
    /// f32; two walls that are neither parallel nor at a right angle, one wall behind another, more than six walls; a sphere
    /// that is too large or has other obstacles beside it; a mesh with too many elements or behind a wall.
    pub(crate) fn new(list: Vec<Obstacle>, array: &Array, medium: Medium) -> Result<Self> {
        let mut walls: Vec<(usize, Mirror)> = Vec::new();
        for (k, obstacle) in list.iter().enumerate() {
            let item = format!("obstacles[{k}]");
            match obstacle {
                Obstacle::Wall { point, normal, kind } => {
                    let mirror = mirror(&item, *point, *normal, *kind, array, medium)?;
                    boards(array).try_for_each(|board| compatible((k, &mirror), ("a board", &board)))?;
                    for (other, before) in &walls {
                        compatible((k, &mirror), (&format!("obstacles[{other}]"), before))?;
                    }
                    walls.push((k, mirror));
                }
                Obstacle::Sphere { center, radius, .. } => {
                    check_sphere(&item, *center, *radius, array, medium)?;
                    if list.len() > 1 {
                        let cure = "its series knows of no other obstacle: give it as a mesh";
                        return Err(Error::new(ErrorCode::SphereAmong, item, "a sphere among others", cure));
                    }
                }
                Obstacle::Mesh(mesh) => check_mesh(&item, mesh, array, medium)?,
            }
        }
        if let Some((k, _)) = walls.get(MOST_WALLS) {
            let cure = format!("give at most {MOST_WALLS}, the sides of a box");
            return Err(Error::invalid(format!("obstacles[{k}]"), format!("wall {}", MOST_WALLS + 1), cure));
        }
        let all = Self { list: list.into(), walls: walls.into() };
        all.check_elements(medium)?;
        all.check_clear(medium)?;
        Ok(all)
    }

    /// Returns the index of the obstacle that contains a place, or of the wall in front of it; `None` if the place is in free
    /// air.
    pub(crate) fn around(&self, place: [f64; 3]) -> Option<usize> {
        let behind = self.walls.iter().find(|(_, wall)| wall.height(place) < -ON).map(|(k, _)| *k);
        behind.or_else(|| {
            self.list.iter().position(|obstacle| match obstacle {
                Obstacle::Wall { .. } => false,
                Obstacle::Sphere { center, radius, .. } => distance(*center, place) < radius - ON,
                Obstacle::Mesh(mesh) => mesh.contains(place),
            })
        })
    }

    /// The distance in m from a place in free air to the nearest sphere or mesh.
    pub(crate) fn clearance(&self, place: [f64; 3]) -> f64 {
        let from = |obstacle: &Obstacle| match obstacle {
            Obstacle::Sphere { center, radius, .. } => distance(*center, place) - radius,
            Obstacle::Mesh(mesh) => mesh.distance(place),
            _ => f64::INFINITY,
        };
        self.list.iter().map(from).fold(f64::INFINITY, f64::min)
    }

    /// Checks that no point is inside an obstacle or behind a wall.
    pub(crate) fn check_points(&self, points: &[[f64; 3]]) -> Result<()> {
        let each = |(j, &point): (usize, &[f64; 3])| self.check_point(point, || format!("points[{j}].position"));
        points.iter().enumerate().try_for_each(each)
    }

    /// Checks that a point is not inside an obstacle or behind a wall; `name` makes its name for the error.
    pub(crate) fn check_point(&self, point: [f64; 3], name: impl FnOnce() -> String) -> Result<()> {
        let Some(k) = self.around(point) else { return Ok(()) };
        let cure = match &self.list[k] {
            Obstacle::Wall { .. } => {
                format!("behind the wall obstacles[{k}], where no sound is: bring it to the array's side")
            }
            body => format!("inside the {} obstacles[{k}], where no sound is: bring it out", body.noun()),
        };
        Err(Error::new(ErrorCode::Blocked, name(), format!("{point:?}"), cure))
    }

    /// Checks that the meshes together have few enough boundary elements to be solved. A mesh file in millimetres, read as
    /// metres, fails here.
    fn check_elements(&self, medium: Medium) -> Result<()> {
        let [area, _] = element_size(medium);
        let mut count = 0.0;
        for (k, obstacle) in self.list.iter().enumerate() {
            let Obstacle::Mesh(mesh) = obstacle else { continue };
            count += mesh.triangles().map(|triangle| (0.5 * area_vector(triangle).norm() / area).max(1.0)).sum::<f64>();
            if count > MOST_ELEMENTS {
                let [x, y, z] = mesh.extent();
                let value = format!("{count:.0} elements ({x:.3} x {y:.3} x {z:.3} m, {} faces)", mesh.faces().len());
                if mesh.faces().len() as f64 > MOST_ELEMENTS {
                    let cure = format!("reduce it to {MOST_ELEMENTS:.0} faces or fewer, in a modeller");
                    return Err(Error::invalid(format!("obstacles[{k}]"), value, cure));
                }
                let cure = format!(
                    "give a smaller or coarser one, up to {MOST_ELEMENTS:.0} elements of {area:.1e} m^2; a file in mm wants scale 1e-3"
                );
                return Err(Error::invalid(format!("obstacles[{k}]"), value, cure));
            }
        }
        Ok(())
    }

    /// Checks that no mesh crosses or touches a wall.
    fn check_clear(&self, medium: Medium) -> Result<()> {
        let [_, edge] = element_size(medium);
        for (k, obstacle) in self.list.iter().enumerate() {
            let Obstacle::Mesh(mesh) = obstacle else { continue };
            for (other, wall) in &*self.walls {
                let lowest = mesh.vertices().iter().map(|&vertex| wall.height(vertex)).fold(f64::INFINITY, f64::min);
                if lowest < 0.5 * edge {
                    let value = format!("{lowest:.2e} m before the wall obstacles[{other}]");
                    let cure = format!("leave {:.1e} m between them", 0.5 * edge);
                    return Err(Error::invalid(format!("obstacles[{k}]"), value, cure));
                }
            }
        }
        Ok(())
    }
}

getters! {
    Obstacles:

    /// The obstacles in the order in which they were given.
    pub(crate) list(self) -> &[Obstacle] = &self.list;

    pub(crate) is_empty(self) -> bool = self.list.is_empty();

    /// The walls as mirrors that face the array.
    pub(crate) mirrors(self) -> impl Iterator<Item = &Mirror> + Clone = self.walls.iter().map(|(_, mirror)| mirror);

    /// The meshes.
    pub(crate) meshes(self) -> impl Iterator<Item = &Mesh> + Clone =
        self.list.iter().filter_map(|obstacle| if let Obstacle::Mesh(mesh) = obstacle { Some(&**mesh) } else { None });
}

/// The largest area in m^2 and the longest edge in m of a boundary element: about 2.5 elements per wavelength. The edge limit
/// concerns only slender triangles.
pub(crate) fn element_size(medium: Medium) -> [f64; 2] {
    let edge = 0.4 * medium.wavelength();
    [0.433 * edge * edge, 2.0 * edge]
}

fn check_sphere(item: &str, center: [f64; 3], radius: f64, array: &Array, medium: Medium) -> Result<()> {
    vector(&format!("{item}.center"), &center)?;
    let name = format!("{item}.radius");
    real(&name, radius, 0.0, true)?;
    let most = LARGEST_SPHERE * medium.wavelength();
    if radius > most {
        let cure =
            format!("give at most {most:.3} m, {LARGEST_SPHERE} wavelengths, or a mesh of the part that matters");
        let notice = Notice::new(ErrorCode::SphereSize, name, format!("{radius} m"), cure);
        return Err(Error::of(notice.other(format!("{most:.3} m"))));
    }
    super::check_places(array.centre(), medium, "obstacles", ".center", &[center])?;
    let clear = radius + CLEAR * medium.wavelength();
    let near = array.positions().iter().position(|&position| distance(position, center) < clear);
    near.map_or(Ok(()), |i| Err(crossing(item, i, "sphere", medium)))
}

fn check_mesh(item: &str, mesh: &Mesh, array: &Array, medium: Medium) -> Result<()> {
    let corners = [0, 1].map(|end| mesh.bounds().map(|bound| bound[end]));
    super::check_places(array.centre(), medium, "obstacles", ".vertices", &corners)?;
    let clear = CLEAR * medium.wavelength();
    let near = array.positions().iter().position(|&position| {
        let beside = |axis: usize| {
            let [low, high] = mesh.bounds()[axis];
            position[axis] > low - clear && position[axis] < high + clear
        };
        (0..3).all(beside) && (mesh.contains(position) || mesh.distance(position) < clear)
    });
    near.map_or(Ok(()), |i| Err(crossing(item, i, "mesh", medium)))
}

fn crossing(item: &str, i: usize, noun: &str, medium: Medium) -> Error {
    let clear = CLEAR * medium.wavelength();
    let cure = format!("transducer {i} is inside or within {clear:.1e} m of it: move the {noun} or the array");
    Error::new(ErrorCode::CrossesArray, item, format!("a {noun} that crosses the array"), cure)
}
