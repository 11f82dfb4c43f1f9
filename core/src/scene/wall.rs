//! Walls: infinite planes as obstacles, each with a mirror that faces the array.

use crate::error::ErrorCode;
use crate::prelude::*;
use crate::scene::geometry::vector;
use crate::scene::surface::{ON, Surface};
use crate::scene::{Array, Medium};

/// Two normals are at a right angle if the modulus of their cosine is below this, which allows for rounding.
const SQUARE: f64 = 1e-6;

/// A reflecting plane with a unit normal on the array's side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mirror {
    point: Vec3,
    normal: Vec3,
    pub(crate) kind: Surface,
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
) -> Result<Mirror, Error> {
    vector(&format!("{item}.point"), &point)?;
    vector(&format!("{item}.normal"), &normal)?;
    let largest = normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if largest == 0.0 {
        let cure = "give the direction the wall faces";
        return Err(Error::invalid(format!("{item}.normal"), format!("{normal:?}"), cure));
    }
    let mut mirror = Mirror { point: Vec3(point), normal: (Vec3(normal) / largest).unit(), kind };
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

/// Checks that two walls are compatible. Image sources give the right reflections only for walls that are parallel or at right
/// angles.
pub(crate) fn compatible((k, wall): (usize, &Mirror), (other, before): (usize, &Mirror)) -> Result<(), Error> {
    let cosine = wall.normal.dot(before.normal);
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
