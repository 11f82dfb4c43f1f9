//! Obstacles: what the waves meet beside the array, checked once against it.

use alloc::format;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::error::Error;
use crate::math;
use crate::scene::array::vector;
use crate::scene::geometry::dot;
use crate::scene::value::words;
use crate::scene::{Array, Medium};

/// The most walls of a scene: the sides of a box.
const MOST_WALLS: usize = 6;

/// Metres that count as none beside an obstacle's surface.
const ON: f64 = 1e-9;

/// Cosines that rounding leaves of a right angle.
const SQUARE: f64 = 1e-6;

/// What a surface does to a wave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(clippy::exhaustive_enums, reason = "the two ideal surfaces")]
pub enum Surface {
    /// The air cannot move across it: dp/dn = 0. Solids in air.
    #[default]
    Rigid,
    /// It gives way: p = 0 (pressure-release).
    Soft,
}

words!(Surface: "rigid" = Surface::Rigid, "soft" = Surface::Soft);

impl Surface {
    /// "rigid" or "soft".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::Soft => "soft",
        }
    }
}

/// A body that waves cannot enter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Obstacle {
    /// A plane without end. Sound is on the array's side; where the array lies in the plane, on that of the normal.
    Wall {
        /// Any point of it (3,) in m.
        point: [f64; 3],
        /// The direction (3,) that it faces, of any length.
        normal: [f64; 3],
        /// What it does.
        kind: Surface,
    },
}

/// The obstacles of a scene, checked, each on one side of the array.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Obstacles {
    given: Arc<[Obstacle]>,
    /// The walls: which obstacle each is, a point of it, its unit normal on the side of the array.
    walls: Arc<[(usize, Mirror)]>,
}

/// A reflecting plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mirror {
    point: [f64; 3],
    normal: [f64; 3],
    pub(crate) kind: Surface,
}

impl Mirror {
    /// Metres in front of it.
    fn height(&self, place: [f64; 3]) -> f64 {
        dot([0, 1, 2].map(|x| place[x] - self.point[x]), self.normal)
    }

    /// The image of a place.
    pub(crate) fn place(&self, place: [f64; 3]) -> [f64; 3] {
        let height = self.height(place);
        [0, 1, 2].map(|x| place[x] - 2.0 * height * self.normal[x])
    }

    /// The image of a direction.
    pub(crate) fn direction(&self, direction: [f64; 3]) -> [f64; 3] {
        let along = dot(direction, self.normal);
        [0, 1, 2].map(|x| direction[x] - 2.0 * along * self.normal[x])
    }
}

impl Obstacles {
    /// Obstacles of an array in a medium.
    ///
    /// # Errors
    /// Numbers that are not finite, a normal of length 0, a wall that crosses the array or is too far away for phases in
    /// f32, two walls that are neither parallel nor at a right angle, one behind another, more than six.
    pub(crate) fn new(given: Vec<Obstacle>, array: &Array, medium: Medium) -> Result<Self, Error> {
        let mut walls: Vec<(usize, Mirror)> = Vec::new();
        for (k, obstacle) in given.iter().enumerate() {
            match *obstacle {
                Obstacle::Wall { point, normal, kind } => {
                    let item = format!("obstacles[{k}]");
                    let mirror = mirror(&item, (point, normal, kind), array)?;
                    let far = 2.0 * mirror.height(array.centre());
                    let most = super::extent::reach(medium);
                    if far > most {
                        let cure = format!("leave it out or bring it within {:.3e} m", 0.5 * most);
                        return Err(Error::invalid(item, format!("{:.3e} m from the array", 0.5 * far), cure));
                    }
                    walls.iter().try_for_each(|(other, before)| compatible((k, &mirror), (*other, before)))?;
                    walls.push((k, mirror));
                }
            }
        }
        if let Some((k, _)) = walls.get(MOST_WALLS) {
            let cure = format!("give at most {MOST_WALLS}, the sides of a box");
            return Err(Error::invalid(format!("obstacles[{k}]"), format!("wall {}", MOST_WALLS + 1), cure));
        }
        Ok(Self { given: given.into(), walls: walls.into() })
    }

    /// As they were given.
    pub(crate) fn given(&self) -> &[Obstacle] {
        &self.given
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.given.is_empty()
    }

    /// The walls as mirrors that face the array.
    pub(crate) fn mirrors(&self) -> impl Iterator<Item = &Mirror> + Clone {
        self.walls.iter().map(|(_, mirror)| mirror)
    }

    /// The obstacle that a place is inside of, or behind.
    pub(crate) fn around(&self, place: [f64; 3]) -> Option<usize> {
        self.walls.iter().find(|(_, wall)| wall.height(place) < -ON).map(|(k, _)| *k)
    }

    /// Refuses points inside an obstacle.
    pub(crate) fn check_points(&self, points: &[[f64; 3]]) -> Result<(), Error> {
        let each = |(j, &point): (usize, &[f64; 3])| self.check_point(point, || format!("points[{j}].position"));
        points.iter().enumerate().try_for_each(each)
    }

    /// Refuses a point inside an obstacle by its name.
    pub(crate) fn check_point(&self, point: [f64; 3], name: impl FnOnce() -> String) -> Result<(), Error> {
        let Some(k) = self.around(point) else { return Ok(()) };
        let cure = format!("behind the wall obstacles[{k}], where no sound is: bring it to the array's side");
        Err(Error::invalid(name(), format!("{point:?}"), cure))
    }
}

/// A wall as a mirror that faces the array.
fn mirror(item: &str, (point, normal, kind): ([f64; 3], [f64; 3], Surface), array: &Array) -> Result<Mirror, Error> {
    vector(&format!("{item}.point"), &point)?;
    vector(&format!("{item}.normal"), &normal)?;
    let largest = normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if largest == 0.0 {
        return Err(Error::invalid(
            format!("{item}.normal"),
            format!("{normal:?}"),
            "give the direction the wall faces",
        ));
    }
    let scaled = normal.map(|x| x / largest);
    let length = math::sqrt(dot(scaled, scaled));
    let mut mirror = Mirror { point, normal: scaled.map(|x| x / length), kind };
    if mirror.height(array.centre()) < -ON {
        mirror.normal = mirror.normal.map(|x| -x);
    }
    if let Some(i) = array.positions().iter().position(|&position| mirror.height(position) < -ON) {
        let cure = format!("it crosses the array, transducer {i} is behind it: move the wall or the array");
        return Err(Error::invalid(item, format!("a wall through {point:?}"), cure));
    }
    Ok(mirror)
}

/// Refuses two walls whose images would not do.
fn compatible((k, own): (usize, &Mirror), (other, before): (usize, &Mirror)) -> Result<(), Error> {
    let cosine = dot(own.normal, before.normal);
    if cosine.abs() > SQUARE && cosine.abs() < 1.0 - SQUARE {
        let angle = math::acos(cosine).to_degrees();
        let cure = format!(
            "walls are parallel or at right angles, images are right for no others: turn it to obstacles[{other}]"
        );
        return Err(Error::invalid(format!("obstacles[{k}].normal"), format!("turned by {angle:.3} degrees"), cure));
    }
    if cosine > 0.5 {
        let cure = format!("obstacles[{other}] is parallel to it, one hides the other: leave one out");
        return Err(Error::invalid(format!("obstacles[{k}]"), "a wall on the same side", cure));
    }
    Ok(())
}
