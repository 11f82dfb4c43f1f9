//! Walls: infinite planes as obstacles, and boards that reflect, each with a mirror that faces the array.

use crate::prelude::*;
use crate::scene::geometry::vector;
use crate::scene::surface::{ON, Surface};
use crate::scene::{Array, Medium};

/// Two normals are at a right angle if the modulus of their cosine is below this, which allows for rounding.
const SQUARE: f64 = 1e-6;

/// Transducers of one board are in one plane, to this distance in m.
const FLAT: f64 = 1e-6;

/// A reflecting plane with a unit normal on the array's side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mirror {
    point: Vec3,
    normal: Vec3,
    /// The reflected over the arriving pressure: 1 for a rigid wall, -1 for a soft one.
    pub(crate) factor: f64,
}

impl Mirror {
    /// The distance in m of a place in front of the plane; negative behind it.
    pub(crate) fn height(&self, place: impl Into<Vec3>) -> f64 {
        (place.into() - self.point).dot(self.normal)
    }

    /// The mirror image of a place.
    pub(crate) fn place(&self, place: Vec3) -> Vec3 {
        place - 2.0 * self.height(place) * self.normal
    }

    /// The mirror image of a direction.
    pub(crate) fn direction(&self, direction: Vec3) -> Vec3 {
        direction - 2.0 * direction.dot(self.normal) * self.normal
    }
}

/// Returns the mirror of a wall. Its normal points to the side of the array.
pub(crate) fn mirror(
    item: &str,
    point: [f64; 3],
    normal: [f64; 3],
    kind: Surface,
    array: &Array,
    medium: Medium,
) -> Result<Mirror> {
    vector(&format!("{item}.point"), &point)?;
    vector(&format!("{item}.normal"), &normal)?;
    let largest = normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if largest == 0.0 {
        let cure = "give the direction the wall faces";
        return Err(Error::invalid(format!("{item}.normal"), format!("{normal:?}"), cure));
    }
    let factor = if kind == Surface::Soft { -1.0 } else { 1.0 };
    let mut mirror = Mirror { point: Vec3(point), normal: (Vec3(normal) / largest).unit(), factor };
    if mirror.height(array.centre()) < -ON {
        mirror.normal = -mirror.normal;
    }
    if let Some(i) = array.positions().iter().position(|&position| mirror.height(position) < -ON) {
        let cure = format!("it crosses the array, transducer {i} is behind it: move the wall or the array");
        return Err(Error::new(ErrorCode::CrossesArray, item, format!("a wall through {point:?}"), cure));
    }
    let far = 2.0 * mirror.height(array.centre());
    let most = super::extent::reach(medium);
    if far > most {
        let cure = format!("leave it out or bring it within {:.3e} m", 0.5 * most);
        return Err(Error::invalid(item, format!("{:.3e} m from the array", 0.5 * far), cure));
    }
    Ok(mirror)
}

impl Array {
    /// Returns a copy of this array whose two boards reflect this part of |p|, 0 to 1. Each is then a mirror in the plane of its
    /// transducers. As between two walls, up to three reflections are computed.
    ///
    /// # Errors
    /// A part out of range; another array than two flat boards that face each other.
    pub fn with_reflecting(mut self, reflecting: f64) -> Result<Self> {
        let part = real("array.reflecting", reflecting, 0.0, false)?;
        if part > 1.0 {
            return Err(Error::out_of_range("array.reflecting", part, "give the part of |p| that returns, 0 to 1"));
        }
        self.reflecting = part;
        if !face(&self) {
            let cure = "only two flat boards that face each other reflect, such as openmpd_pair: leave it out";
            return Err(Error::conflict("array.reflecting", part, cure));
        }
        Ok(self)
    }
}

/// Returns the boards of an array that reflects, as mirrors in the planes of their transducers.
pub(crate) fn boards(array: &Array) -> impl Iterator<Item = Mirror> {
    let (places, normals, factor) = (array.positions(), array.normals(), array.reflecting());
    let along = |i: usize| Vec3(places[i]).dot(normals[0]);
    let far = (0..array.len()).max_by(|&i, &j| along(i).total_cmp(&along(j))).unwrap_or(0);
    let boards = [0, far].map(|i| Mirror { point: Vec3(places[i]), normal: Vec3(normals[i]), factor });
    boards.into_iter().filter(move |_| factor > 0.0)
}

/// Whether the boards of an array that reflects are flat and face each other.
fn face(array: &Array) -> bool {
    let boards: Vec<Mirror> = boards(array).collect();
    let [one, other] = &boards[..] else { return true };
    let on = |(place, normal): (&[f64; 3], &[f64; 3])| {
        boards.iter().any(|board| board.height(*place).abs() < FLAT && board.normal.dot(*normal) > 1.0 - SQUARE)
    };
    one.normal.dot(other.normal) < SQUARE - 1.0
        && one.height(other.point) > FLAT
        && array.positions().iter().zip(array.normals()).all(on)
}

/// Checks that two walls are compatible; `other` names the second. Image sources give the right reflections only for walls that
/// are parallel or at right angles.
pub(crate) fn compatible((k, wall): (usize, &Mirror), (other, before): (&str, &Mirror)) -> Result<()> {
    let cosine = wall.normal.dot(before.normal);
    if cosine.abs() > SQUARE && cosine.abs() < 1.0 - SQUARE {
        let angle = math::acos(cosine).to_degrees();
        let cure = format!("walls are parallel or at right angles, images are right for no others: turn it to {other}");
        return Err(Error::invalid(format!("obstacles[{k}].normal"), format!("turned by {angle:.3} degrees"), cure));
    }
    if cosine > 0.5 {
        let cure = format!("{other} is parallel to it, one hides the other: leave one out");
        return Err(Error::invalid(format!("obstacles[{k}]"), "a wall on the same side", cure));
    }
    Ok(())
}
